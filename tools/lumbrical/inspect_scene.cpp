// See inspect_scene.h.
#include "inspect_scene.h"

#include <vector>

#include "approach_text.h"
#include "commands.h"
#include "lumbrical/clearance.h"
#include "lumbrical/scene_file.h"
#include "output.h"
#include "winding_text.h"

namespace lumbrical::tool {
namespace {

// What a model would list of them.
std::vector<World::Object> objects_of(SceneFile& scene_file) {
  std::vector<World::Object> objects;
  for (SceneObject& object : scene_file.scene.objects) {
    World::Object& listed = objects.emplace_back();
    listed.name = object.name;
    listed.triangle_count = static_cast<std::uint32_t>(object.mesh.triangles.size());
    listed.winding = wind_outwards(object.mesh, object.winding);
  }
  return objects;
}

}  // namespace

bool is_scene(const std::string& path) { return path.size() > 5 && path.ends_with(".json"); }

int inspect_scene(const std::string& path, bool json) {
  SceneFile scene_file;
  if (Status status = load_scene_file(path, scene_file); !status.ok()) return fail(status);
  const std::vector<World::Object> objects = objects_of(scene_file);
  const Clearance clearance = find_clearance(scene_file.scene, scene_file.motion, scene_file.seconds);
  if (json) {
    Json printed = to_json(clearance, scene_file.scene);
    for (std::size_t i = 0; i < objects.size(); ++i) {
      printed["objects"][i]["triangles"] = objects[i].triangle_count;
      printed["objects"][i]["winding"] = to_json(objects[i].winding);
    }
    if (scene_file.aligned) printed["aligned"] = pose_json(scene_file.placement.pose);
    return print_json(printed);
  }
  Table table;
  table.add("hand", hand_text(scene_file.motion));
  table.add("objects", grouped(clearance.object.size()));
  add_windings(objects, table);
  if (scene_file.aligned) table.add("aligned", pose_text(scene_file.placement.pose));
  bool first = true;
  for (const std::string& sentence : approach_sentences(clearance, scene_file.scene)) {
    table.add(first ? "where things are" : "", sentence);
    first = false;
  }
  return print_text(table.text());
}

}  // namespace lumbrical::tool
