#include "model/scene_check.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/parallel.h"

namespace lumbrical {
namespace {

Status out_of_range(const std::string& field, const std::string& range) {
  return Status::error(field + " is out of range: give " + range);
}

constexpr std::size_t kNumberPiece = 65536;  // numbers, the least that is worth another thread

// The first of `count` for which `bad` holds; `count` if there is none.
template <class Bad>
std::size_t first_bad(std::size_t count, std::size_t threads, const Bad& bad) {
  std::vector<std::size_t> found(piece_count(count, kNumberPiece), count);
  parallel_pieces(count, kNumberPiece, threads, [&](std::size_t piece, std::size_t first, std::size_t last) {
    std::size_t i = first;
    while (i < last && !bad(i)) ++i;
    if (i < last) found[piece] = i;
  });
  return found.empty() ? count : *std::min_element(found.begin(), found.end());
}

}  // namespace

Status check_pad(const Pad& pad) {
  double slope = 1, above = 0;
  for (std::size_t i = 0; i < kPadLayers; ++i) {
    const PadLayer& layer = pad.layer[i];
    const std::string name = "settings.pad.layers[" + std::to_string(i) + "]";
    if (layer.stiffness == 0) continue;
    if (!within(layer.from, 0.01, 0.99) || layer.from <= above)
      return out_of_range(name + ".from", "0.01 to 0.99, the shallower layer first");
    above = layer.from;
    slope += layer.stiffness;
    if (!within(layer.stiffness, -1000, 1000)) return out_of_range(name + ".stiffness", "-1000 to 1000");
    if (slope < 0)
      return Status::error(name +
                           ".stiffness: a pad that is pressed deeper must not push less; it and those "
                           "before it must come to -1 at least");
  }
  if (!within(pad.damping, 0, 1000)) return out_of_range("settings.pad.damping", "0 to 1000 s/m");
  return {};
}

Status check_settings(const Settings& settings) {
  if (!within(settings.stiffness, 1e-3, 1e15))
    return out_of_range("settings.stiffness", "0.001 to 1e15 N/m^3");
  if (!within(settings.rate, 1, 100000)) return out_of_range("settings.rate", "1 to 100000 Hz");
  if (!within(settings.point_area, 1e-12, 1)) return out_of_range("settings.point_area", "1e-12 to 1 m^2");
  for (const double precision : settings.precision) {
    if (precision != 0 && !within(precision, 1e-6, 0.1))
      return out_of_range("settings.precision", "0 (exact) or 1e-6 to 0.1");
  }
  if (!within(settings.max_force, 0, 1e6)) return out_of_range("settings.max_force", "0 to 1e6 N");
  if (!within(settings.fade_time, 0, 60)) return out_of_range("settings.fade_time", "0 to 60 s");
  if (settings.proxy_stiffness != 0 && !within(settings.proxy_stiffness, 10, 1e5))
    return out_of_range("settings.proxy_stiffness", "0 or 10 to 1e5 N/m");
  if (Status status = check_pad(settings.pad); !status.ok()) return status;
  if (settings.effort > 1000000000) return out_of_range("settings.effort", "0 to 1000000000");
  if (settings.max_candidates < 1 || settings.max_candidates > (1u << 24)) {
    return out_of_range("settings.max_candidates", "1 to 16777216");
  }
  if (felt_once_name(settings.felt_once) == "unknown")
    return out_of_range("settings.felt_once", "never, by-samples or always");
  for (const Law law : settings.law) {
    if (law_name(law) == "unknown") return out_of_range("settings.law", "one of the five laws");
    if (settings.felt_once == FeltOnce::always && law != Law::field)
      return Status::error("settings.felt_once: \"always\" needs law \"field\" on every segment");
  }
  for (const double precision : settings.precision) {
    if (settings.felt_once == FeltOnce::always && (precision > 0) != (settings.precision[0] > 0))
      return Status::error(
          "settings.felt_once: \"always\" needs every segment by samples, or every one exact (precision 0)");
  }
  return {};
}

Status check_execution(const Execution& execution) {
  if (execution.leaf_size < 1 || execution.leaf_size > 64)
    return out_of_range("execution.leaf_size", "1 to 64");
  if (execution.threads < 1 || execution.threads > 64) return out_of_range("execution.threads", "1 to 64");
  if (!within(execution.cell_size, 1e-3, 1e6)) return out_of_range("execution.cell_size", "0.001 to 1e6 m");
  if (execution.tree_levels > 32) return out_of_range("execution.tree_levels", "0 to 32");
  if (broadphase_name(execution.broadphase) == "unknown") {
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

Status check_object(const std::string& name, const Mesh& mesh, std::size_t threads) {
  const std::vector<Vec3>& vertices = mesh.vertices;
  const std::vector<Triangle>& triangles = mesh.triangles;
  const std::size_t vertex = first_bad(vertices.size(), threads, [&](std::size_t i) {
    const Vec3 p = vertices[i];
    return !(std::fabs(p.x) <= kWorldReach && std::fabs(p.y) <= kWorldReach && std::fabs(p.z) <= kWorldReach);
  });
  if (vertex < vertices.size()) {
    return Status::error(
        "object \"" + name + "\": vertex " + std::to_string(vertex) +
        " is not finite or farther than 1e8 m from the origin; check the unit and the placement");
  }
  const auto corner = [&](std::size_t i) {
    return std::max({triangles[i][0], triangles[i][1], triangles[i][2]});
  };
  const std::size_t triangle =
      first_bad(triangles.size(), threads, [&](std::size_t i) { return corner(i) >= vertices.size(); });
  if (triangle < triangles.size()) {
    return Status::error("object \"" + name + "\": triangle " + std::to_string(triangle) + " names vertex " +
                         std::to_string(corner(triangle)) + " of " + std::to_string(vertices.size()) +
                         "; repair the mesh");
  }
  return {};
}

Status check_counts(std::size_t vertices, std::size_t triangles) {
  if (vertices <= kVertexLimit && triangles < kTriangleLimit) return {};
  return Status::error("the scene has 2^32 vertices, or 2^31 triangles, or more; split it");
}

}  // namespace lumbrical
