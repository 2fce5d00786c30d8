#include "index/voxel_index.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "index/sphere_tree.h"
#include "index/triangle_distance.h"
#include "index/voxel_cache.h"
#include "lumbrical/mesh.h"
#include "model/corners.h"

namespace lumbrical {
namespace {

using Clock = std::chrono::steady_clock;

// What the mesh report says of the whole scene.
bool is_watertight(const Triangles& triangles) {
  Mesh mesh;
  mesh.vertices.reserve(triangles.x.size());
  mesh.triangles.reserve(triangles.size());
  for (std::uint32_t i = 0; i < triangles.x.size(); ++i) mesh.vertices.push_back(triangles.vertex(i));
  for (std::size_t i = 0; i < triangles.size(); ++i)
    mesh.triangles.push_back({triangles.a[i], triangles.b[i], triangles.c[i]});
  return inspect_mesh(mesh).watertight;
}

void add_note(VoxelReport& report, const std::string& note) {
  report.note += (report.note.empty() ? "" : "; ") + note;
}

// The band of a field is in three times as many leaves as its surface.
constexpr double kTreesWithField = 4;
Status trees_fit(double bytes, const VoxelLists& lists, const Execution& execution) {
  bytes += static_cast<double>(byte_count(lists));
  return bytes > execution.voxel_memory ? voxels_too_large(bytes, execution) : Status();
}

// Lists and, where the surface has an inside that voxels can tell, the field.
Status build(const Triangles& triangles, const Execution& execution, VoxelLists& lists,
             DistanceField& field) {
  if (Status status = build_voxel_lists(triangles, execution, lists); !status.ok()) return status;
  field = {};
  if (!lists.wide.empty() || !is_watertight(triangles)) return {};
  if (Status status = trees_fit(kTreesWithField * tree_bytes(lists.key, 0), lists, execution); !status.ok())
    return status;
  return make_distance_field(triangles, lists, field);
}

// The trees of what a file holds may be very much larger than the file.
Status read_within_memory(const std::string& path, std::uint64_t source, std::size_t triangles,
                          const Execution& execution, VoxelLists& lists, DistanceField& field) {
  if (Status status = read_voxel_cache(path, source, triangles, lists, field); !status.ok()) return status;
  const double bytes = tree_bytes(lists.key, 0) + tree_bytes(field.key, DistanceField::kShift);
  if (Status status = trees_fit(bytes, lists, execution); !status.ok())
    return Status::error(path + ": is not used, because " + status.message());
  return {};
}

// From the cache if there is a good one, otherwise from scratch.
Status read_or_build(const Triangles& triangles, const Execution& execution, VoxelIndex& index,
                     DistanceField& field) {
  if (execution.voxel_cache.empty()) return build(triangles, execution, index.lists, field);
  const std::uint64_t source = hash_of_source(triangles, execution);
  const std::string path = cache_path(execution.voxel_cache, source);
  std::error_code ignored;
  const bool exists = std::filesystem::exists(path, ignored);
  const Status reading =
      exists ? read_within_memory(path, source, triangles.size(), execution, index.lists, field) : Status();
  index.report.from_cache = exists && reading.ok();
  if (index.report.from_cache) return {};
  if (!reading.ok()) add_note(index.report, reading.message() + "; it is built anew");
  if (Status status = build(triangles, execution, index.lists, field); !status.ok()) return status;
  if (Status status = write_voxel_cache(path, source, index.lists, field); !status.ok())
    add_note(index.report, status.message());
  return {};
}

void fill_report(VoxelIndex& index, Clock::time_point start) {
  VoxelReport& report = index.report;
  const VoxelLists& lists = index.lists;
  report.voxel_size = lists.voxel_size;
  report.voxels = lists.voxel.size() - 1;
  report.entries = lists.triangle.size();
  report.wide = lists.wide.size();
  report.bytes = byte_count(lists) + index.grid->byte_count() + byte_count(index.wide);
  report.has_distance = index.grid->has_field();
  if (!report.has_distance) {
    add_note(report, report.wide > 0
                         ? "there is no signed distance, because some triangles are too wide for voxels"
                         : "there is no signed distance, because the scene is not watertight");
  }
  report.build_seconds = std::chrono::duration<double>(Clock::now() - start).count();
}

// A coordinate's voxel; far outside, one that is empty as well.
std::int32_t voxel_at(double x) { return static_cast<std::int32_t>(std::floor(clamp(x, -100, 1e7))); }

struct Nearest {
  double square = 1e300, side = 0;  // see side_of; of all that share the point
};

// A triangle counts in the voxel of its nearest point only, so that it counts once.
void add_voxel(const Model& model, Vec3 p, VoxelPlace place, Nearest& nearest) {
  constexpr double kTie = 1 + 1e-9;  // triangles about as near share an edge or a corner
  const VoxelLists& lists = model.voxels->lists;
  const std::int32_t number = model.voxels->grid->number_at(place);
  if (number < 0) return;
  for (const std::uint32_t triangle : touching(*model.voxels, static_cast<std::uint32_t>(number))) {
    const auto corner = [&](const SharedArray<std::uint32_t>& corners) {
      return (model.triangles.vertex(corners[triangle]) - lists.origin) / lists.voxel_size;
    };
    const Vec3 a = corner(model.triangles.a), b = corner(model.triangles.b), c = corner(model.triangles.c);
    const NearestPoint point = nearest_point(p, a, b, c);
    const Vec3 at = p - point.gap;
    const bool here = voxel_at(max(at.x, 0)) == place.x && voxel_at(max(at.y, 0)) == place.y &&
                      voxel_at(max(at.z, 0)) == place.z;
    if (!here) continue;
    if (point.square * kTie < nearest.square) nearest.side = 0;
    if (point.square <= nearest.square * kTie) nearest.side += side_of(point, a, b, c);
    nearest.square = min(nearest.square, point.square);
  }
}

// [voxels] to the nearest triangle, negative behind it; far away if none is within a voxel.
double distance_nearby(const Model& model, Vec3 p) {
  Nearest nearest;
  for (std::int32_t x = voxel_at(p.x) - 1, i = 0; i < 3; ++i) {
    for (std::int32_t y = voxel_at(p.y) - 1, j = 0; j < 3; ++j) {
      for (std::int32_t z = voxel_at(p.z) - 1, k = 0; k < 3; ++k)
        add_voxel(model, p, {x + i, y + j, z + k}, nearest);
    }
  }
  const double distance = std::sqrt(nearest.square);
  return (nearest.side < 0) != model.voxels->inside_out ? -distance : distance;
}

// Do the triangles of a closed surface turn their backs to the outside?
bool is_inside_out(const Triangles& triangles, Vec3 origin) {
  double volume = 0;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const auto [a, b, c] = corners_of(triangles, i);
    volume += dot(a - origin, cross(b - origin, c - origin));
  }
  return volume < 0;
}

}  // namespace

Status build_voxels(const Triangles& triangles, const Execution& execution,
                    std::shared_ptr<const VoxelIndex>& result) {
  const auto start = Clock::now();
  const auto index = std::make_shared<VoxelIndex>();
  DistanceField field;
  if (!has_openvdb()) return make_voxel_grid({}, {}, index->grid);
  if (triangles.size() == 0) return {};
  if (Status status = read_or_build(triangles, execution, *index, field); !status.ok()) return status;
  if (Status status = make_voxel_grid(index->lists, field, index->grid); !status.ok()) return status;
  index->lists.key = {};
  std::vector<std::uint32_t> wide = index->lists.wide;
  index->wide = build_tree(triangles, wide, execution);
  index->inside_out = index->grid->has_field() && is_inside_out(triangles, index->lists.origin);
  fill_report(*index, start);
  if (static_cast<double>(index->report.bytes) > execution.voxel_memory)
    return voxels_too_large(static_cast<double>(index->report.bytes), execution);
  result = index;
  return {};
}

std::size_t find_voxels(const VoxelIndex& index, const Primitive& primitive,
                        std::vector<std::uint32_t>& found) {
  const double per_voxel = 1 / index.lists.voxel_size;
  VoxelQuery query;
  query.end = per_voxel * (primitive.end1 - index.lists.origin);
  query.axis = per_voxel * (primitive.end2 - primitive.end1);
  const double square = dot(query.axis, query.axis);
  query.per_square =
      square > 1e-20 ? 1 / square : 0;  // a shorter axis is taken for a point, and 1e-10 for rounding
  const double radius = per_voxel * max(primitive.radius1, primitive.radius2);
  query.reach = (1 + 1e-6) * radius + 1e-6 + 1e-12 * std::sqrt(square);
  return index.grid->find(index.lists, query, found);
}

std::optional<VoxelReport> voxel_report(const Model& model) {
  if (!model.voxels) return std::nullopt;
  return model.voxels->report;
}

std::optional<double> signed_distance(const Model& model, Vec3 p) {
  if (!model.voxels || !model.voxels->report.has_distance) return std::nullopt;
  const VoxelLists& lists = model.voxels->lists;
  const Vec3 place = (p - lists.origin) / lists.voxel_size;
  const double near = distance_nearby(model, place);
  if (std::fabs(near) <= 1) return lists.voxel_size * near;
  // Between here and the middle of this very voxel there is no surface: it has the point's sign.
  const Vec3 inside{clamp(place.x, -100, 1e7), clamp(place.y, -100, 1e7), clamp(place.z, -100, 1e7)};
  const Vec3 middle{std::floor(inside.x) + 0.5, std::floor(inside.y) + 0.5, std::floor(inside.z) + 0.5};
  const bool outside = model.voxels->grid->sample_field(middle) > 0;
  const double far = max(std::fabs(model.voxels->grid->sample_field(inside)), 1);
  return lists.voxel_size * (outside ? far : -far);
}

}  // namespace lumbrical
