// lumbrical inspect: what is wrong with a mesh, and what its voxel index takes.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "commands.h"
#include "inspect_scene.h"
#include "lumbrical/hand.h"
#include "lumbrical/mesh.h"
#include "lumbrical/mesh_fix.h"
#include "output.h"
#include "switches.h"
#include "winding_text.h"

namespace lumbrical::tool {
namespace {

struct InspectOptions {
  std::string mesh, unit, broadphase, voxel_cache, fix;
  bool json = false;
};

Json report_json(const MeshReport& report) {
  Json json;
  json["triangles"] = report.triangles;
  json["vertices"] = report.vertices;
  json["merged_vertices"] = report.merged_vertices;
  json["unused_vertices"] = report.unused_vertices;
  json["degenerate"] = report.degenerate;
  json["sliver"] = report.sliver;
  json["duplicate"] = report.duplicate;
  json["boundary_edges"] = report.boundary_edges;
  json["non_manifold_edges"] = report.non_manifold_edges;
  json["misoriented_edges"] = report.misoriented_edges;
  json["components"] = report.components;
  json["watertight"] = report.watertight;
  json["area"] = report.area;
  json["volume"] = report.volume;
  json["shortest_edge"] = report.shortest_edge;
  json["longest_edge"] = report.longest_edge;
  json["extent"] = to_json(report.upper - report.lower);
  json["lower"] = to_json(report.lower);
  json["upper"] = to_json(report.upper);
  json["examples"] = report.examples;
  return json;
}

std::string millimetres(double metres) { return brief(1000 * metres) + " mm"; }

std::string report_text(const MeshReport& report) {
  const Vec3 extent = report.upper - report.lower;
  Table table;
  table.add("triangles", grouped(report.triangles));
  table.add("vertices", grouped(report.vertices) + " stored, " + grouped(report.merged_vertices) +
                            " distinct, " + grouped(report.unused_vertices) + " unused");
  table.add("degenerate triangles", grouped(report.degenerate));
  table.add("sliver triangles", grouped(report.sliver) + " (smallest angle below 1 degree)");
  table.add("duplicate triangles", grouped(report.duplicate));
  table.add("boundary edges", grouped(report.boundary_edges));
  table.add("non-manifold edges", grouped(report.non_manifold_edges));
  table.add("misoriented edges", grouped(report.misoriented_edges));
  table.add("components", grouped(report.components));
  table.add("watertight", report.watertight ? "yes" : "no");
  table.add("extent", millimetres(extent.x) + " x " + millimetres(extent.y) + " x " + millimetres(extent.z));
  table.add("edges", millimetres(report.shortest_edge) + " to " + millimetres(report.longest_edge));
  table.add("area", brief(1e4 * report.area) + " cm^2");
  if (report.watertight) {
    const std::string inside_out = report.volume < 0 ? " (inside out)" : "";
    table.add("volume", brief(1e6 * report.volume) + " cm^3" + inside_out);
  }
  std::string text = table.text();
  for (const std::string& example : report.examples) text += "  " + example + '\n';
  return text;
}

// What a search structure of the mesh takes; nothing but a voxel index has a report.
Status index_report(const InspectOptions& options, const Mesh& mesh, std::optional<VoxelReport>& report) {
  if (options.broadphase.empty()) return {};
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"mesh", mesh});
  Execution execution;
  execution.broadphase = *parse_broadphase(options.broadphase);
  execution.voxel_cache = options.voxel_cache;
  Model model;
  if (Status status = build_model(scene, execution, model); !status.ok()) return status;
  report = voxel_report(model);
  return {};
}

bool is_obj(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  return extension == ".obj" || extension == ".OBJ";
}

int inspect(const InspectOptions& options) {
  if (is_scene(options.mesh)) {
    if (!options.unit.empty()) refuse_option("--unit", "a scene file tells the units of its meshes");
    if (!options.broadphase.empty()) refuse_option("--broadphase", "the voxel index is one of a mesh");
    if (!options.voxel_cache.empty()) refuse_option("--voxel-cache", "the voxel index is one of a mesh");
    if (!options.fix.empty()) refuse_option("--fix", "it takes a mesh");
    return inspect_scene(options.mesh, options.json);
  }
  if (options.unit.empty()) demand_option("--unit");
  if (!options.voxel_cache.empty() && options.broadphase != "voxel")
    refuse_option("--voxel-cache", "needs --broadphase voxel");
  if (!options.fix.empty() && !is_obj(options.fix))
    refuse_option("--fix", "\"" + options.fix + "\" is written as OBJ; give it a name that ends in .obj");
  Mesh mesh;
  if (Status status = load_mesh(options.mesh, Unit::metre, mesh); !status.ok()) return fail(status);
  const bool fix = !options.fix.empty();
  FixReport fixed;
  const Mesh repaired = fix ? fixed_mesh(mesh, fixed) : Mesh();  // in the file's own unit: its numbers stay
  if (fix && repaired.triangles.empty())
    return fail(options.mesh + ": has no triangle with an area to write");
  convert_to_metres(*parse_unit(options.unit), mesh);
  const MeshReport report = inspect_mesh(mesh);
  std::optional<VoxelReport> voxels;
  if (Status status = index_report(options, mesh, voxels); !status.ok()) return fail(status);
  const WindingReport winding = fix ? fixed.winding : wind_outwards(mesh);
  if (fix)
    if (Status status = save_obj(options.fix, repaired); !status.ok()) return fail(status);
  if (options.json) {
    Json json = report_json(report);
    if (fix)
      json["fixed"] = {{"file", options.fix},
                       {"turned_triangles", fixed.winding.turned_triangles},
                       {"merged_vertices", fixed.merged_vertices},
                       {"degenerate_triangles", fixed.degenerate_triangles},
                       {"duplicate_triangles", fixed.duplicate_triangles}};
    json["winding"] = to_json(winding);
    if (voxels) json["voxel_index"] = to_json(*voxels);
    return print_json(json);
  }
  Table table;
  for (const std::string& sentence : winding_sentences(winding)) table.add("in a scene", sentence);
  if (voxels) add_voxels(*voxels, table);
  if (fix)
    table.add("written to " + options.fix, grouped(fixed.winding.turned_triangles) + " triangles turned, " +
                                               grouped(fixed.merged_vertices) + " vertices joined, " +
                                               grouped(fixed.degenerate_triangles) +
                                               " triangles without area and " +
                                               grouped(fixed.duplicate_triangles) + " second ones left out");
  return print_text(report_text(report) + table.text());
}

}  // namespace

void add_inspect(Command& app, int& exit_code) {
  const auto options = std::make_shared<InspectOptions>();
  Command* const command =
      app.add_subcommand("inspect", "Report what is wrong with a mesh, or where the things of a scene are");
  command->add_option("mesh", options->mesh, "OBJ, STL, PLY, OFF or glTF file, or a scene (.json)")
      ->required();
  command->add_option("--unit", options->unit, "Unit of the mesh file's numbers; needed for one")
      ->check(is_unit());
  command
      ->add_option("--broadphase", options->broadphase, "With voxel: also what the mesh's voxel index takes")
      ->check(is_broadphase());
  command->add_option("--voxel-cache", options->voxel_cache, kVoxelCacheHelp)->type_name("FOLDER");
  command
      ->add_option(
          "--fix", options->fix,
          "Write the mesh as OBJ: outside out as in a scene, vertices joined, without degenerate and "
          "second triangles")
      ->check(is_file())
      ->type_name("OUT.obj");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options, &exit_code] { exit_code = inspect(*options); });
}

}  // namespace lumbrical::tool
