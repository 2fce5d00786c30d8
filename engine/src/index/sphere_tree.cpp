#include "index/sphere_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "index/triangle_bound.h"

namespace lumbrical {
namespace {

constexpr std::uint32_t kWidth = SphereBlock::kWidth;

// Single precision moves centres and radii by less than this share of their size; bounds are widened by it.
constexpr double kFloatSlack = 4e-7;

struct Sphere {
  Vec3 centre;  // relative to the tree's origin
  double radius = 0;
};

// Bits of a 21-bit number spread three apart.
std::uint64_t spread(std::uint64_t bits) {
  bits &= 0x1fffff;
  bits = (bits | bits << 32) & 0x1f00000000ffffu;
  bits = (bits | bits << 16) & 0x1f0000ff0000ffu;
  bits = (bits | bits << 8) & 0x100f00f00f00f00fu;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3u;
  bits = (bits | bits << 2) & 0x1249249249249249u;
  return bits;
}

struct Key {
  std::uint64_t morton;
  std::uint32_t triangle;
  friend bool operator<(const Key& a, const Key& b) {
    return a.morton != b.morton ? a.morton < b.morton : a.triangle < b.triangle;
  }
};

std::uint64_t morton_of(Vec3 p, const Box& box) {
  const Vec3 size = box.upper - box.lower;
  const double longest = max(size.x, max(size.y, size.z));
  const double scale = longest > 0 ? 2097151.0 / longest : 0;
  const auto cell = [&](double x, double low) {
    return static_cast<std::uint64_t>(clamp((x - low) * scale, 0, 2097151));
  };
  return spread(cell(p.x, box.lower.x)) | spread(cell(p.y, box.lower.y)) << 1 |
         spread(cell(p.z, box.lower.z)) << 2;
}

Sphere bound(std::span<const Sphere> spheres) {
  Box box;
  for (const Sphere& sphere : spheres) box.add(sphere.centre, sphere.radius);
  Sphere result{box.middle(), 0};
  for (const Sphere& sphere : spheres) {
    result.radius = max(result.radius, norm(sphere.centre - result.centre) + sphere.radius);
  }
  return result;
}

std::vector<Sphere> bound_groups(const std::vector<Sphere>& spheres, std::size_t size) {
  std::vector<Sphere> groups;
  groups.reserve(spheres.size() / size + 1);
  for (std::size_t i = 0; i < spheres.size(); i += size) {
    groups.push_back(bound(std::span(spheres).subspan(i, std::min(size, spheres.size() - i))));
  }
  return groups;
}

SphereBlock empty_block() {
  SphereBlock block;
  block.r.fill(-std::numeric_limits<float>::infinity());
  return block;
}

void put_sphere(const Sphere& sphere, std::size_t place, SphereTree::Level& level) {
  SphereBlock& block = level[place / kWidth];
  const std::size_t lane = place % kWidth;
  const Vec3 c = sphere.centre;
  block.x[lane] = static_cast<float>(c.x);
  block.y[lane] = static_cast<float>(c.y);
  block.z[lane] = static_cast<float>(c.z);
  const double size = max(std::fabs(c.x), max(std::fabs(c.y), std::fabs(c.z))) + sphere.radius;
  block.r[lane] = static_cast<float>(sphere.radius + kFloatSlack * size);
}

SphereTree::Level to_level(const std::vector<Sphere>& spheres) {
  SphereTree::Level level((spheres.size() + kWidth - 1) / kWidth, empty_block());
  for (std::size_t i = 0; i < spheres.size(); ++i) put_sphere(spheres[i], i, level);
  return level;
}

void put_leaves(const std::vector<Sphere>& spheres, std::span<const std::uint32_t> members,
                std::size_t leaf_size, SphereTree& tree) {
  const std::size_t leaf_count = (spheres.size() + leaf_size - 1) / leaf_size;
  tree.sphere.assign(leaf_count * tree.blocks_per_leaf, empty_block());
  tree.triangle.assign(tree.sphere.size() * kWidth, 0);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const std::size_t place = i / leaf_size * tree.blocks_per_leaf * kWidth + i % leaf_size;
    put_sphere(spheres[i], place, tree.sphere);
    tree.triangle[place] = members[i];
  }
}

// Puts the members in spatial order; a tie goes by the triangle's number.
void sort_in_space(const Triangles& triangles, Vec3 origin, std::span<std::uint32_t> members) {
  std::vector<Vec3> centres;
  centres.reserve(members.size());
  Box box;
  for (const std::uint32_t triangle : members) {
    centres.push_back(bound_triangle(triangles, triangle, origin).centre);
    box.add(centres.back());
  }
  std::vector<Key> keys(members.size());
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = {morton_of(centres[i], box), members[i]};
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 0; i < keys.size(); ++i) members[i] = keys[i].triangle;
}

}  // namespace

SphereTree build_tree(const Triangles& triangles, std::span<std::uint32_t> members,
                      const Execution& execution) {
  SphereTree tree;
  const std::size_t leaf_size = execution.leaf_size;
  tree.blocks_per_leaf = (execution.leaf_size + kWidth - 1) / kWidth;
  if (members.empty()) return tree;
  Box corners;
  for (const std::uint32_t triangle : members) corners.add(triangles.vertex(triangles.a[triangle]));
  tree.origin = corners.middle();
  sort_in_space(triangles, tree.origin, members);

  std::vector<Sphere> spheres(members.size());
  for (std::size_t i = 0; i < members.size(); ++i) {
    const TriangleBound around = bound_triangle(triangles, members[i], tree.origin);
    spheres[i] = {around.centre, around.radius};
  }
  put_leaves(spheres, members, leaf_size, tree);
  spheres = bound_groups(spheres, leaf_size);
  tree.levels.push_back(to_level(spheres));
  while (spheres.size() > kWidth &&
         (execution.tree_levels == 0 || tree.levels.size() < execution.tree_levels)) {
    spheres = bound_groups(spheres, kWidth);
    tree.levels.push_back(to_level(spheres));
  }
  const Sphere all = bound(spheres);
  tree.centre = all.centre;
  tree.radius = all.radius;
  return tree;
}

SphereTree build_tree(const Triangles& triangles, const Execution& execution) {
  std::vector<std::uint32_t> all(triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  return build_tree(triangles, all, execution);
}

std::size_t frontier_capacity(const SphereTree& tree) {
  if (tree.levels.empty()) return 0;
  return std::max(tree.levels.front().size() * kWidth, tree.sphere.size());
}

std::size_t byte_count(const SphereTree& tree) {
  std::size_t bytes = sizeof(tree) + tree.triangle.size() * sizeof(std::uint32_t);
  bytes += tree.sphere.size() * sizeof(SphereBlock);
  for (const SphereTree::Level& level : tree.levels)
    bytes += sizeof(level) + level.size() * sizeof(SphereBlock);
  return bytes;
}

}  // namespace lumbrical
