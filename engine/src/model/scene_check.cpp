#include "model/scene_check.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "base/parallel.h"

namespace lumbrical {
namespace {

Status out_of_range(const std::string& field, const std::string& range) {
  return Status::error(field + " is out of range: give " + range);
}

std::string of_segment(const char* field, std::size_t segment) {
  return std::string("settings.") + field + "[" + std::to_string(segment) + "]";
}

struct Number {
  double value;
  const char* field;
  const Range& range;
};
Status check_number(double value, const std::string& field, const Range& range) {
  return range.holds(value) ? Status() : out_of_range(field, text_of(range));
}
Status check_numbers(std::span<const Number> numbers) {
  for (const Number& number : numbers)
    if (Status status = check_number(number.value, number.field, number.range); !status.ok()) return status;
  return {};
}

Status check_words(const Settings& settings) {
  if (felt_once_name(settings.felt_once) == "unknown")
    return out_of_range("settings.felt_once", "never, by-samples or always");
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    const Law law = settings.law[s];
    if (law_name(law) == "unknown") return out_of_range(of_segment("law", s), "one of the five laws");
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
    if (!range::layer_from.holds(layer.from) || layer.from <= above)
      return out_of_range(name + ".from", text_of(range::layer_from) + ", the shallower layer first");
    above = layer.from;
    slope += layer.stiffness;
    if (Status status = check_number(layer.stiffness, name + ".stiffness", range::layer_stiffness);
        !status.ok())
      return status;
    if (slope < 0)
      return Status::error(name +
                           ".stiffness: a pad that is pressed deeper must not push less; it and those "
                           "before it must come to -1 at least");
  }
  return check_number(pad.damping, "settings.pad.damping", range::pad_damping);
}

Status check_settings(const Settings& settings) {
  const Number numbers[] = {
      {settings.stiffness, "settings.stiffness", range::stiffness},
      {settings.rate, "settings.rate", range::rate},
      {settings.point_area, "settings.point_area", range::point_area},
      {settings.max_force, "settings.max_force", range::max_force},
      {settings.fade_time, "settings.fade_time", range::fade_time},
      {double(settings.effort), "settings.effort", range::effort},
      {double(settings.max_candidates), "settings.max_candidates", range::max_candidates}};
  if (Status status = check_numbers(numbers); !status.ok()) return status;
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    if (settings.precision[s] != 0 && !range::precision.holds(settings.precision[s]))
      return out_of_range(of_segment("precision", s), "0 (exact) or " + text_of(range::precision));
  }
  if (settings.proxy_stiffness != 0 && !range::proxy_stiffness.holds(settings.proxy_stiffness))
    return out_of_range("settings.proxy_stiffness", "0 or " + text_of(range::proxy_stiffness));
  if (Status status = check_pad(settings.pad); !status.ok()) return status;
  return check_words(settings);
}

Status check_execution(const Execution& execution) {
  const Number numbers[] = {{double(execution.leaf_size), "execution.leaf_size", range::leaf_size},
                            {double(execution.threads), "execution.threads", range::threads},
                            {execution.cell_size, "execution.cell_size", range::cell_size},
                            {double(execution.tree_levels), "execution.tree_levels", range::tree_levels},
                            {execution.voxel_memory, "execution.voxel_memory", range::voxel_memory}};
  if (Status status = check_numbers(numbers); !status.ok()) return status;
  if (execution.voxel_size != 0 && !range::voxel_size.holds(execution.voxel_size))
    return out_of_range("execution.voxel_size", "0 or " + text_of(range::voxel_size));
  if (broadphase_name(execution.broadphase) == "unknown")
    return out_of_range("execution.broadphase", "auto, tree, grid, voxel or brute");
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
