#include "index/voxel_lists.h"

#include <algorithm>
#include <utility>

#include "index/triangle_bound.h"
#include "index/triangle_box.h"
#include "model/corners.h"

namespace lumbrical {
namespace {

constexpr double kWide = 2;         // [voxels] bounding radius above which a triangle is wide
constexpr double kRounding = 1e-6;  // [voxels] far more than rounding moves a corner among 2^20 voxels

struct Entry {
  std::uint64_t key;
  std::uint64_t order;  // triangle, behind all others if it is centred elsewhere
  friend bool operator<(const Entry& a, const Entry& b) {
    return a.key != b.key ? a.key < b.key : a.order < b.order;
  }
};
constexpr std::uint64_t kElsewhere = std::uint64_t{1} << 32;

double size_of_voxels(const Execution& execution, const Box& box, std::vector<double> radii) {
  const Vec3 extent = box.upper - box.lower;
  const double least = max(extent.x, max(extent.y, extent.z)) / static_cast<double>(kMostVoxels - 1);
  double wanted = execution.voxel_size;
  if (wanted == 0) {
    const auto quarter = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() - 1) * 3 / 4;
    std::nth_element(radii.begin(), quarter, radii.end());
    wanted = 2 * *quarter;
  }
  const double size = max(wanted, least);
  return size > 0 ? size : 1;  // all triangles are one and the same point
}

// The voxel of a coordinate, which is at least -kRounding and at most 2^20 - 1.
std::uint64_t voxel_of(double x) { return static_cast<std::uint64_t>(max(x, 0)); }

// Adds the triangle, corners in voxels from the origin, to every voxel it touches.
void add_entries(Vec3 a, Vec3 b, Vec3 c, std::uint32_t triangle, std::vector<Entry>& entries) {
  const Vec3 centre = a + ((b - a) + (c - a)) / 3.0;
  const std::uint64_t home = voxel_key(voxel_of(centre.x), voxel_of(centre.y), voxel_of(centre.z));
  Box box;
  for (const Vec3 p : {a, b, c, centre}) box.add(p, kRounding);
  const Vec3 low = box.lower, high = box.upper;
  for (std::uint64_t x = voxel_of(low.x); x <= voxel_of(high.x); ++x) {
    for (std::uint64_t y = voxel_of(low.y); y <= voxel_of(high.y); ++y) {
      for (std::uint64_t z = voxel_of(low.z); z <= voxel_of(high.z); ++z) {
        const std::uint64_t key = voxel_key(x, y, z);
        const Vec3 middle{static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5,
                          static_cast<double>(z) + 0.5};
        if (key == home) {
          entries.push_back({key, triangle});
        } else if (touches_cube(a - middle, b - middle, c - middle, 0.5 + kRounding)) {
          entries.push_back({key, kElsewhere | triangle});
        }
      }
    }
  }
}

// Makes lists of sorted entries; `radii` [m] by triangle.
void put_lists(const std::vector<Entry>& entries, const std::vector<double>& radii, VoxelLists& lists) {
  lists.triangle.reserve(entries.size());
  for (std::size_t i = 0; i < entries.size();) {
    const std::uint64_t key = entries[i].key;
    Voxel voxel;
    voxel.first = voxel.others = static_cast<std::uint32_t>(i);
    double reach = -1;
    for (; i < entries.size() && entries[i].key == key; ++i) {
      const auto triangle = static_cast<std::uint32_t>(entries[i].order);
      lists.triangle.push_back(triangle);
      if ((entries[i].order & kElsewhere) != 0) continue;
      voxel.others = static_cast<std::uint32_t>(i) + 1;
      reach = max(reach, radii[triangle] / lists.voxel_size * (1 + 1e-6));
    }
    voxel.reach = static_cast<float>(reach);
    lists.reach = voxel.reach > lists.reach ? voxel.reach : lists.reach;
    lists.key.push_back(key);
    lists.voxel.push_back(voxel);
  }
  const auto end = static_cast<std::uint32_t>(lists.triangle.size());
  lists.voxel.push_back({end, end, -1});
}

// [bytes] Of OpenVDB's nodes: a leaf, and those that have places for 16^3 and for 32^3 others.
constexpr double kLeafBytes = 2.3e3, kMiddleBytes = 34e3, kLargeBytes = 271e3;

// What tree_bytes says, of keys wherever they stand.
template <class KeyOf>
double bytes_of_nodes(std::size_t count, std::int32_t shift, const KeyOf& key_of) {
  // Leaves have numbers of 18 bits along each axis.
  constexpr std::uint64_t kAlongEach = std::uint64_t{1} << 36 | 1 << 18 | 1;
  const std::uint64_t moved = (512 - static_cast<std::uint64_t>(shift) / 8) * kAlongEach;
  std::vector<std::uint64_t> nodes;  // each by its first leaf
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t leaf = (key_of(i) >> 9) + moved;
    if (nodes.empty() || leaf != nodes.back()) nodes.push_back(leaf);
  }
  double bytes = kLeafBytes * static_cast<double>(nodes.size());
  for (const auto& [leaves, node_bytes] :
       {std::pair<std::uint64_t, double>{16, kMiddleBytes}, {512, kLargeBytes}}) {
    for (std::uint64_t& node : nodes) node &= ~((leaves - 1) * kAlongEach);
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    bytes += node_bytes * static_cast<double>(nodes.size());
  }
  return bytes;
}

}  // namespace

Status voxels_too_large(double bytes, const Execution& execution) {
  return Status::error("the voxel index would take over " +
                       std::to_string(static_cast<std::uint64_t>(bytes / 1e6)) +
                       " MB, more than execution.voxel_memory (" +
                       std::to_string(static_cast<std::uint64_t>(execution.voxel_memory / 1e6)) +
                       " MB); use broadphase tree or grid, larger voxels, or allow more memory");
}

Status build_voxel_lists(const Triangles& triangles, const Execution& execution, VoxelLists& result) {
  VoxelLists lists;
  const auto count = static_cast<std::uint32_t>(triangles.size());
  const Box box = box_round(triangles, execution.threads);
  lists.origin = box.lower;
  std::vector<double> radii(count);
  for (std::uint32_t i = 0; i < count; ++i) radii[i] = bound_triangle(triangles, i, lists.origin).radius;
  lists.voxel_size = size_of_voxels(execution, box, radii);
  std::vector<Entry> entries;
  const double room = execution.voxel_memory / sizeof(Entry);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (radii[i] > kWide * lists.voxel_size) {
      lists.wide.push_back(i);
      continue;
    }
    const auto place = [&](std::uint32_t corner) {
      return (triangles.vertex(corner) - lists.origin) / lists.voxel_size;
    };
    add_entries(place(triangles.a[i]), place(triangles.b[i]), place(triangles.c[i]), i, entries);
    const double size = static_cast<double>(entries.size());
    if (size > room || size >= 4294967295.0) return voxels_too_large(size * sizeof(Entry), execution);
  }
  std::sort(entries.begin(), entries.end());
  const double bytes = static_cast<double>(entries.size()) * sizeof(Entry) +
                       bytes_of_nodes(entries.size(), 0, [&](std::size_t i) { return entries[i].key; });
  if (bytes > execution.voxel_memory) return voxels_too_large(bytes, execution);
  put_lists(entries, radii, lists);
  result = std::move(lists);
  return {};
}

double tree_bytes(const std::vector<std::uint64_t>& keys, std::int32_t shift) {
  return bytes_of_nodes(keys.size(), shift, [&](std::size_t i) { return keys[i]; });
}

std::size_t byte_count(const VoxelLists& lists) {
  return lists.key.size() * sizeof(std::uint64_t) + lists.voxel.size() * sizeof(Voxel) +
         (lists.triangle.size() + lists.wide.size()) * sizeof(std::uint32_t);
}

}  // namespace lumbrical
