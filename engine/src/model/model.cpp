// From a scene to an immutable model, and back.
#include "lumbrical/model.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "index/cluster_tree.h"
#include "index/sphere_grid.h"
#include "index/sphere_tree.h"
#include "index/voxel_index.h"
#include "lumbrical/contact.h"

namespace lumbrical {
namespace {

constexpr std::array<std::pair<std::string_view, Law>, 5> kLawNames = {{
    {"field", Law::field},
    {"column", Law::column},
    {"max-depth", Law::max_depth},
    {"centroid", Law::centroid},
    {"point", Law::point},
}};
constexpr std::array<std::pair<std::string_view, Broadphase>, 5> kBroadphaseNames = {{
    {"auto", Broadphase::automatic},
    {"tree", Broadphase::tree},
    {"grid", Broadphase::grid},
    {"voxel", Broadphase::voxel},
    {"brute", Broadphase::brute},
}};
constexpr std::array<std::pair<std::string_view, Isa>, 6> kIsaNames = {{
    {"auto", Isa::automatic},
    {"scalar", Isa::scalar},
    {"sse2", Isa::sse2},
    {"avx2", Isa::avx2},
    {"avx512", Isa::avx512},
    {"neon", Isa::neon},
}};

template <class Names, class T = typename Names::value_type::second_type>
std::optional<T> value_named(const Names& names, std::string_view text) {
  for (const auto& [name, value] : names) {
    if (name == text) return value;
  }
  return std::nullopt;
}

template <class Names, class T>
std::string_view name_valued(const Names& names, T wanted) {
  for (const auto& [name, value] : names) {
    if (value == wanted) return name;
  }
  return "unknown";
}

Status out_of_range(const std::string& field, const std::string& range) {
  return Status::error(field + " is out of range: give " + range);
}

// NaN fails every comparison, so it is refused as well.
bool within(double value, double lower, double upper) { return value >= lower && value <= upper; }

Status check_settings(const Settings& settings) {
  if (!within(settings.stiffness, 1e-3, 1e15))
    return out_of_range("settings.stiffness", "0.001 to 1e15 N/m^3");
  if (!within(settings.rate, 1, 100000)) return out_of_range("settings.rate", "1 to 100000 Hz");
  if (!within(settings.point_area, 1e-12, 1)) return out_of_range("settings.point_area", "1e-12 to 1 m^2");
  if (!within(settings.tolerance, 0, 0.1)) return out_of_range("settings.tolerance", "0 to 0.1");
  if (!within(settings.max_force, 0, 1e6)) return out_of_range("settings.max_force", "0 to 1e6 N");
  if (!within(settings.fade_time, 0, 60)) return out_of_range("settings.fade_time", "0 to 60 s");
  if (settings.max_candidates < 1 || settings.max_candidates > (1u << 24)) {
    return out_of_range("settings.max_candidates", "1 to 16777216");
  }
  for (const Law law : settings.law) {
    if (name_valued(kLawNames, law) == "unknown") return out_of_range("settings.law", "one of the five laws");
  }
  return {};
}

Status check_execution(const Execution& execution) {
  if (execution.leaf_size < 1 || execution.leaf_size > 64)
    return out_of_range("execution.leaf_size", "1 to 64");
  if (execution.threads < 1 || execution.threads > 64) return out_of_range("execution.threads", "1 to 64");
  if (!within(execution.cell_size, 1e-3, 1e6)) return out_of_range("execution.cell_size", "0.001 to 1e6 m");
  if (execution.tree_levels > 32) return out_of_range("execution.tree_levels", "0 to 32");
  if (name_valued(kBroadphaseNames, execution.broadphase) == "unknown") {
    return out_of_range("execution.broadphase", "auto, tree, grid, voxel or brute");
  }
  if (execution.voxel_size != 0 && !within(execution.voxel_size, 1e-9, 1e6))
    return out_of_range("execution.voxel_size", "0 or 1e-9 to 1e6 m");
  if (!within(execution.voxel_memory, 1e6, 1e12))
    return out_of_range("execution.voxel_memory", "1e6 to 1e12 bytes");
  if (!available(execution.isa)) {
    return Status::error("execution.isa " + std::string(isa_name(execution.isa)) +
                         " is not available on this machine or in this build; use auto");
  }
  return {};
}

// Larger coordinates square to infinity or leave no digits for a finger.
constexpr double kWorldReach = 1e8;

constexpr std::size_t kPiece = 65536;  // numbers, the least that is worth another thread

// The first of `count` for which `bad` holds; `count` if there is none.
template <class Bad>
std::size_t first_bad(std::size_t count, std::size_t threads, const Bad& bad) {
  std::vector<std::size_t> found(piece_count(count, kPiece), count);
  parallel_pieces(count, kPiece, threads, [&](std::size_t piece, std::size_t first, std::size_t last) {
    std::size_t i = first;
    while (i < last && !bad(i)) ++i;
    if (i < last) found[piece] = i;
  });
  return found.empty() ? count : *std::min_element(found.begin(), found.end());
}

Status check_object(const SceneObject& object, std::size_t threads) {
  const std::vector<Vec3>& vertices = object.mesh.vertices;
  const std::vector<Triangle>& triangles = object.mesh.triangles;
  const std::size_t vertex = first_bad(vertices.size(), threads, [&](std::size_t i) {
    const Vec3 p = vertices[i];
    return !(std::fabs(p.x) <= kWorldReach && std::fabs(p.y) <= kWorldReach && std::fabs(p.z) <= kWorldReach);
  });
  if (vertex < vertices.size()) {
    return Status::error(
        "object \"" + object.name + "\": vertex " + std::to_string(vertex) +
        " is not finite or farther than 1e8 m from the origin; check the unit and the placement");
  }
  const auto corner = [&](std::size_t i) {
    return std::max({triangles[i][0], triangles[i][1], triangles[i][2]});
  };
  const std::size_t triangle =
      first_bad(triangles.size(), threads, [&](std::size_t i) { return corner(i) >= vertices.size(); });
  if (triangle < triangles.size()) {
    return Status::error("object \"" + object.name + "\": triangle " + std::to_string(triangle) +
                         " names vertex " + std::to_string(corner(triangle)) + " of " +
                         std::to_string(vertices.size()) + "; repair the mesh");
  }
  return {};
}

// Each of the world's six arrays is written from end to end by one thread, whose memory it then is.
Triangles gather_triangles(const Scene& scene, std::size_t vertex_count, std::size_t triangle_count,
                           std::size_t threads) {
  constexpr std::array<double Vec3::*, 3> kAxis = {&Vec3::x, &Vec3::y, &Vec3::z};
  std::array<std::vector<double>, 3> numbers;
  std::array<std::vector<std::uint32_t>, 3> corners;
  parallel_chunks(6, 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      if (k % 2 == 0) {
        numbers[k / 2].reserve(vertex_count);
        for (const SceneObject& object : scene.objects) {
          for (const Vec3& p : object.mesh.vertices) numbers[k / 2].push_back(p.*kAxis[k / 2]);
        }
        continue;
      }
      std::uint32_t first_vertex = 0;
      corners[k / 2].reserve(triangle_count);
      for (const SceneObject& object : scene.objects) {
        for (const Triangle& triangle : object.mesh.triangles)
          corners[k / 2].push_back(first_vertex + triangle[k / 2]);
        first_vertex += static_cast<std::uint32_t>(object.mesh.vertices.size());
      }
    }
  });
  return {std::move(numbers[0]), std::move(numbers[1]), std::move(numbers[2]),
          std::move(corners[0]), std::move(corners[1]), std::move(corners[2])};
}

void list_objects(const Scene& scene, std::vector<Model::Object>& objects) {
  std::uint32_t triangle = 0, vertex = 0;
  for (const SceneObject& object : scene.objects) {
    const auto triangles = static_cast<std::uint32_t>(object.mesh.triangles.size());
    const auto vertices = static_cast<std::uint32_t>(object.mesh.vertices.size());
    objects.push_back({object.name, triangle, triangles, vertex, vertices});
    triangle += triangles;
    vertex += vertices;
  }
}

Box extent_of(const Triangles& world, std::size_t threads) {
  if (world.x.empty()) return {};
  constexpr std::array<double Vec3::*, 3> kAxis = {&Vec3::x, &Vec3::y, &Vec3::z};
  const std::array<const SharedArray<double>*, 3> numbers = {&world.x, &world.y, &world.z};
  Box box;
  parallel_chunks(3, 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const auto [low, high] = std::minmax_element(numbers[k]->begin(), numbers[k]->end());
      box.lower.*kAxis[k] = *low;
      box.upper.*kAxis[k] = *high;
    }
  });
  return box;
}

Broadphase suited_broadphase(const Box& extent) {
  const Vec3 size = extent.upper - extent.lower;
  return max(size.x, max(size.y, size.z)) > kGridExtent ? Broadphase::grid : Broadphase::tree;
}

// The ladder of precision knows clusters under the field law only.
bool wants_clusters(const Model& model) {
  const auto& laws = model.settings.law;
  return model.settings.tolerance > 0 && std::count(laws.begin(), laws.end(), Law::field) > 0 &&
         model.triangles.size() > 0;
}

}  // namespace

std::optional<Law> parse_law(std::string_view text) { return value_named(kLawNames, text); }
std::optional<Broadphase> parse_broadphase(std::string_view text) {
  return value_named(kBroadphaseNames, text);
}
std::optional<Isa> parse_isa(std::string_view text) { return value_named(kIsaNames, text); }
bool available(Broadphase broadphase) { return broadphase != Broadphase::voxel || has_openvdb(); }
std::string_view isa_name(Isa isa) { return name_valued(kIsaNames, isa); }
std::string_view law_name(Law law) { return name_valued(kLawNames, law); }
std::string_view broadphase_name(Broadphase broadphase) { return name_valued(kBroadphaseNames, broadphase); }

Status build_model(const Scene& scene, const Execution& execution, Model& model) {
  if (Status status = check_settings(scene.settings); !status.ok()) return status;
  if (Status status = check_execution(execution); !status.ok()) return status;
  if (Status status = check_hand(scene.hand); !status.ok()) return status;
  std::size_t vertices = 0, triangles = 0;
  for (const SceneObject& object : scene.objects) {
    if (Status status = check_object(object, execution.threads); !status.ok()) return status;
    vertices += object.mesh.vertices.size();
    triangles += object.mesh.triangles.size();
  }
  if (vertices >= 0xffffffffu || triangles >= kClusterBit) {
    return Status::error("the scene has 2^32 vertices, or 2^31 triangles, or more; split it");
  }
  static std::atomic<std::uint64_t> builds{0};
  Model built;
  built.build = ++builds;
  built.hand = scene.hand;
  built.settings = scene.settings;
  built.execution = execution;
  if (execution.isa == Isa::automatic) built.execution.isa = widest_isa();
  built.triangles = gather_triangles(scene, vertices, triangles, execution.threads);
  list_objects(scene, built.objects);
  built.extent = extent_of(built.triangles, execution.threads);
  Broadphase& broadphase = built.execution.broadphase;
  if (broadphase == Broadphase::automatic) broadphase = suited_broadphase(built.extent);
  if (broadphase == Broadphase::tree) {
    built.tree = build_tree(built.triangles, execution);
  } else if (broadphase == Broadphase::grid) {
    built.grid = build_grid(built.triangles, execution);
  } else if (broadphase == Broadphase::voxel) {
    if (Status status = build_voxels(built.triangles, execution, built.voxels); !status.ok()) return status;
  }
  if (wants_clusters(built)) built.clusters = build_clusters(built.triangles, execution);
  model = std::move(built);
  return {};
}

Scene scene_of(const Model& model) {
  Scene scene;
  scene.hand = model.hand;
  scene.settings = model.settings;
  for (const Model::Object& part : model.objects) {
    SceneObject object;
    object.name = part.name;
    for (std::uint32_t i = 0; i < part.vertex_count; ++i) {
      object.mesh.vertices.push_back(model.triangles.vertex(part.first_vertex + i));
    }
    for (std::uint32_t i = part.first_triangle; i < part.first_triangle + part.triangle_count; ++i) {
      object.mesh.triangles.push_back({model.triangles.a[i] - part.first_vertex,
                                       model.triangles.b[i] - part.first_vertex,
                                       model.triangles.c[i] - part.first_vertex});
    }
    scene.objects.push_back(std::move(object));
  }
  return scene;
}

}  // namespace lumbrical
