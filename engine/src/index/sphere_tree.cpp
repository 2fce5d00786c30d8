#include "index/sphere_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "index/spatial_code.h"
#include "index/triangle_bound.h"
#include "model/corners.h"

namespace lumbrical {
namespace {

constexpr std::uint32_t kWidth = SphereBlock::kWidth;
constexpr std::size_t kLargestLeaf = 64;  // triangles; Execution::leaf_size
constexpr std::size_t kPiece = 1024;      // blocks, the least that is worth another thread

// Single precision moves centres and radii by less than this share of their size; bounds are widened by it.
constexpr double kFloatSlack = 4e-7;

struct Sphere {
  Vec3 centre;  // relative to the tree's origin
  double radius = 0;
};

Sphere bound(std::span<const Sphere> spheres) {
  Box box;
  for (const Sphere& sphere : spheres) box.add(sphere.centre, sphere.radius);
  Sphere result{box.middle(), 0};
  for (const Sphere& sphere : spheres) {
    result.radius = max(result.radius, norm(sphere.centre - result.centre) + sphere.radius);
  }
  return result;
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

// Bounds every block of a level by one sphere, which become the next level.
std::vector<Sphere> bound_blocks(const std::vector<Sphere>& spheres, std::size_t threads) {
  std::vector<Sphere> bounds(piece_count(spheres.size(), kWidth));
  parallel_pieces(bounds.size(), kPiece, threads, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t begin = i * kWidth, size = std::min<std::size_t>(kWidth, spheres.size() - begin);
      bounds[i] = bound(std::span(spheres).subspan(begin, size));
    }
  });
  return bounds;
}

SphereTree::Level to_level(const std::vector<Sphere>& spheres, std::size_t threads) {
  SphereTree::Level level(piece_count(spheres.size(), kWidth), empty_block());
  parallel_pieces(spheres.size(), kPiece * kWidth, threads,
                  [&](std::size_t, std::size_t first, std::size_t last) {
                    for (std::size_t i = first; i < last; ++i) put_sphere(spheres[i], i, level);
                  });
  return level;
}

// Fills the tree's blocks of triangles, leaf by leaf; returns the leaves' bounds.
std::vector<Sphere> put_leaves(const Triangles& triangles, std::span<const std::uint32_t> members,
                               const Execution& execution, SphereTree& tree) {
  const std::size_t leaf_size = execution.leaf_size;
  std::vector<Sphere> leaves(piece_count(members.size(), leaf_size));
  tree.sphere.assign(leaves.size() * tree.blocks_per_leaf, empty_block());
  tree.triangle.assign(tree.sphere.size() * kWidth, 0);
  parallel_pieces(leaves.size(), kPiece, execution.threads,
                  [&](std::size_t, std::size_t first, std::size_t last) {
                    std::array<Sphere, kLargestLeaf> within;
                    for (std::size_t leaf = first; leaf < last; ++leaf) {
                      const std::size_t begin = leaf * leaf_size;
                      const std::size_t size = std::min(leaf_size, members.size() - begin);
                      const std::size_t place = leaf * tree.blocks_per_leaf * kWidth;
                      for (std::size_t i = 0; i < size; ++i) {
                        const std::uint32_t triangle = members[begin + i];
                        const TriangleBound around = bound_triangle(triangles, triangle, tree.origin);
                        within[i] = {around.centre, around.radius};
                        put_sphere(within[i], place + i, tree.sphere);
                        tree.triangle[place + i] = triangle;
                      }
                      leaves[leaf] = bound({within.data(), size});
                    }
                  });
  return leaves;
}

// Round all corners of the members, in W.
Box box_round_members(const Triangles& triangles, std::span<const std::uint32_t> members,
                      std::size_t threads) {
  std::vector<Box> boxes(piece_count(members.size(), kPiece * kWidth));
  parallel_pieces(members.size(), kPiece * kWidth, threads,
                  [&](std::size_t piece, std::size_t first, std::size_t last) {
                    Box box;
                    for (std::size_t i = first; i < last; ++i) {
                      const Corners at = corners_of(triangles, members[i]);
                      for (const Vec3 corner : {at.a, at.b, at.c}) box.add(corner);
                    }
                    boxes[piece] = box;
                  });
  Box all;
  for (const Box& box : boxes) {
    all.add(box.lower);
    all.add(box.upper);
  }
  return all;
}

}  // namespace

SphereTree build_tree(const Triangles& triangles, std::vector<std::uint32_t>& members,
                      const Execution& execution) {
  SphereTree tree;
  const std::size_t threads = execution.threads;
  tree.blocks_per_leaf = (execution.leaf_size + kWidth - 1) / kWidth;
  if (members.empty()) return tree;
  const Box box = box_round_members(triangles, members, threads);
  tree.origin = box.middle();
  const SpatialCode code({box.lower - tree.origin, box.upper - tree.origin});
  sort_by_code(members, code.bits(), kWidth, threads, [&](std::uint32_t triangle) {
    return code(bound_triangle(triangles, triangle, tree.origin).centre);
  });

  std::vector<Sphere> spheres = put_leaves(triangles, members, execution, tree);
  tree.levels.push_back(to_level(spheres, threads));
  while (spheres.size() > kWidth &&
         (execution.tree_levels == 0 || tree.levels.size() < execution.tree_levels)) {
    spheres = bound_blocks(spheres, threads);
    tree.levels.push_back(to_level(spheres, threads));
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
