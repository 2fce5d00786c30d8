// lumbrical world: the objects of a scene file as a world file, for scenes too large for memory.
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "commands.h"
#include "fail_to_write.h"
#include "lumbrical/scene_file.h"
#include "lumbrical/world.h"
#include "output.h"
#include "switches.h"
#include "winding_text.h"

namespace lumbrical::tool {
namespace {

struct WorldOptions {
  std::string scene, output;
  std::optional<std::uint32_t> threads;
  std::optional<double> cell_size;
  bool json = false;
};

// `objects` is told the names and what was turned.
Status build_world(const WorldOptions& options, std::vector<World::Object>& objects) {
  WorldWriter writer;
  const auto begin = [&](const Execution& execution) {
    Execution chosen = execution;
    if (options.threads) chosen.threads = *options.threads;
    if (options.cell_size) chosen.cell_size = *options.cell_size;
    return writer.open(options.output, chosen, stop_requested);
  };
  Status not_written;
  Status status = load_scene_objects(options.scene, begin, [&](SceneObject&& object) {
    World::Object& added = objects.emplace_back();
    added.name = object.name;
    Status wrong = writer.add_object(object, &added.winding);
    if (wrong.message().starts_with(options.output)) not_written = wrong;
    return wrong;
  });
  // A full disk is no fault of the object at whose line it was noticed.
  if (!not_written.ok()) return not_written;
  return status.ok() ? writer.finish() : status;
}

int make_world(const WorldOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  std::error_code ignored;
  if (std::filesystem::equivalent(options.scene, options.output, ignored))
    return fail(options.output + ": is the scene; name another file");
  const StopSignals stop_signals;
  std::vector<World::Object> objects;
  if (Status status = build_world(options, objects); !status.ok())
    return fail_to_write(options.output, status);
  // What was written is read once more, as whoever uses it will.
  std::shared_ptr<const World> world;
  if (Status status = open_world(options.output, world); !status.ok()) return fail(status);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (options.json) {
    Json json;
    json["world"] = options.output;
    json["objects"] = world->objects.size();
    json["triangles"] = world->triangles.size();
    json["vertices"] = world->triangles.x.size();
    json["cells"] = world->grid.cell.size();
    json["cell_size"] = world->grid.cell_size;
    json["bytes"] = world->byte_count;
    json["seconds"] = seconds;
    json["windings"] = windings_json(objects);
    return print_json(json);
  }
  Table table;
  table.add("world file", options.output + ", " + grouped(world->byte_count) + " bytes");
  table.add("objects", grouped(world->objects.size()));
  table.add("triangles", grouped(world->triangles.size()));
  table.add("cells", grouped(world->grid.cell.size()) + " of " + brief(world->grid.cell_size) + " m");
  add_windings(objects, table);
  table.add("time", brief(seconds) + " s");
  return print_text(table.text());
}

}  // namespace

void add_world(Command& app, int& exit_code) {
  const auto options = std::make_shared<WorldOptions>();
  Command* const command =
      app.add_subcommand("world", "Make a world file of a scene's objects, for scenes too large for memory");
  command->add_option("scene", options->scene, "Scene file; only its objects and execution count")
      ->required();
  command
      ->add_option("--output,-o", options->output,
                   "World file to write, which a scene names as its \"world\"")
      ->required()
      ->check(is_file())
      ->type_name("CITY.world");
  command->add_option("--cell-size", options->cell_size, "Of the grid [m]; the scene's, or 0.1")
      ->check(number_in(1e-3, 1e6));
  command->add_option("--threads", options->threads, "1 .. 64; never changes the file")
      ->check(whole_number_in(1, 64));
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options, &exit_code] { exit_code = make_world(*options); });
}

}  // namespace lumbrical::tool
