#include "index/sphere_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>

#include "base/parallel.h"
#include "index/spatial_order.h"
#include "index/triangle_bound.h"
#include "model/corners.h"

namespace lumbrical {
namespace {

constexpr std::uint32_t kWidth = SphereBlock::kWidth;
constexpr std::size_t kLargestLeaf = 64;  // triangles; Execution::leaf_size
constexpr std::size_t kTreePiece = 1024;  // blocks, the least that is worth another thread

// By this share the box round the spheres is wider: rounding must not lose a contact.
constexpr double kBoxSlack = 1e-6;

// Single precision moves centres and radii by less than this share of their size; bounds are widened by it.
constexpr double kSphereSlack = 4e-7;

SphereBlock empty_block() {
  SphereBlock block;
  block.r.fill(-std::numeric_limits<float>::infinity());
  return block;
}

// Bounds every block of a level by one sphere, which become the next level.
std::vector<Sphere> bound_blocks(const std::vector<Sphere>& spheres, std::size_t threads) {
  std::vector<Sphere> bounds(piece_count(spheres.size(), kWidth));
  parallel_pieces(bounds.size(), kTreePiece, threads, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t begin = i * kWidth, size = std::min<std::size_t>(kWidth, spheres.size() - begin);
      bounds[i] = bound(std::span(spheres).subspan(begin, size));
    }
  });
  return bounds;
}

void put_level(const std::vector<Sphere>& spheres, SphereBlock* level, std::size_t threads) {
  parallel_pieces(spheres.size(), kTreePiece * kWidth, threads,
                  [&](std::size_t, std::size_t first, std::size_t last) {
                    std::fill(level + first / kWidth, level + piece_count(last, kWidth), empty_block());
                    for (std::size_t i = first; i < last; ++i) put_sphere(spheres[i], i, level);
                  });
}

Box box_round(const std::vector<Box>& boxes) {
  Box all;
  for (const Box& box : boxes) all.add(box);
  return all;
}

struct Leaves {
  std::vector<Sphere> bound;  // of each
  Box box;                    // round the spheres of all triangles
};

// Fills blocks and numbers of the triangles, leaf by leaf.
Leaves put_leaves(const Triangles& triangles, std::span<const std::uint32_t> members,
                  const Execution& execution, const TreeHead& head, SphereBlock* blocks,
                  std::uint32_t* numbers) {
  const std::size_t leaf_size = execution.leaf_size, leaf_blocks = head.blocks_per_leaf;
  std::vector<Sphere> leaves(head.leaf_count);
  std::vector<Box> boxes(piece_count(leaves.size(), kTreePiece));
  parallel_pieces(leaves.size(), kTreePiece, execution.threads,
                  [&](std::size_t piece, std::size_t first, std::size_t last) {
                    Box box;
                    std::fill(blocks + first * leaf_blocks, blocks + last * leaf_blocks, empty_block());
                    std::fill(numbers + first * leaf_blocks * kWidth, numbers + last * leaf_blocks * kWidth,
                              0u);
                    std::array<Sphere, kLargestLeaf> within;
                    for (std::size_t leaf = first; leaf < last; ++leaf) {
                      const std::size_t begin = leaf * leaf_size;
                      const std::size_t size = std::min(leaf_size, members.size() - begin);
                      const std::size_t place = leaf * leaf_blocks * kWidth;
                      for (std::size_t i = 0; i < size; ++i) {
                        const std::uint32_t triangle = members[begin + i];
                        within[i] = bound_triangle(triangles, triangle, head.origin);
                        box.add(within[i].centre, (1 + kBoxSlack) * within[i].radius);
                        put_sphere(within[i], place + i, blocks);
                        numbers[place + i] = triangle;
                      }
                      leaves[leaf] = bound({within.data(), size});
                    }
                    boxes[piece] = box;
                  });
  return {std::move(leaves), box_round(boxes)};
}

// Round all corners of the members, in W.
Box box_round_members(const Triangles& triangles, std::span<const std::uint32_t> members,
                      std::size_t threads) {
  std::vector<Box> boxes(piece_count(members.size(), kTreePiece * kWidth));
  parallel_pieces(members.size(), kTreePiece * kWidth, threads,
                  [&](std::size_t piece, std::size_t first, std::size_t last) {
                    Box box;
                    for (std::size_t i = first; i < last; ++i) {
                      const Corners at = corners_of(triangles, members[i]);
                      for (const Vec3 corner : {at.a, at.b, at.c}) box.add(corner);
                    }
                    boxes[piece] = box;
                  });
  return box_round(boxes);
}

// Writes the leaves' spheres and all levels above them, the last one first and all of them before
// `level_end`.
void put_levels(std::vector<Sphere> spheres, std::span<const std::vector<Sphere>> held,
                const TreeLayout& layout, std::size_t threads, TreeHead& head, SphereBlock* level_end) {
  for (std::size_t level = 0; level < head.level_count; ++level) {
    if (level > 0) spheres = bound_blocks(spheres, threads);
    if (level < held.size()) {
      for (std::size_t i = 0; i < spheres.size(); ++i) hold(held[level][i], spheres[i]);
    }
    level_end -= layout.blocks[level];
    put_level(spheres, level_end, threads);
  }
  const Sphere all = bound(spheres);
  head.centre = all.centre;
  head.radius = all.radius;
}

}  // namespace

void put_sphere(const Sphere& sphere, std::size_t place, SphereBlock* blocks) {
  SphereBlock& block = blocks[place / kWidth];
  const std::size_t lane = place % kWidth;
  const Vec3 c = sphere.centre;
  block.x[lane] = static_cast<float>(c.x);
  block.y[lane] = static_cast<float>(c.y);
  block.z[lane] = static_cast<float>(c.z);
  const double size = largest_of(c) + sphere.radius;
  block.r[lane] = static_cast<float>(sphere.radius + kSphereSlack * size);
}

Sphere bound(std::span<const Sphere> spheres) {
  Box box;
  for (const Sphere& sphere : spheres) box.add(sphere.centre, sphere.radius);
  Sphere result{box.middle(), 0};
  for (const Sphere& sphere : spheres) hold(sphere, result);
  return result;
}

void hold(const Sphere& other, Sphere& sphere) {
  sphere.radius = max(sphere.radius, norm(other.centre - sphere.centre) + other.radius);
}

TreeHead plan_tree(std::size_t triangle_count, const Execution& execution) {
  TreeHead head;
  head.blocks_per_leaf = static_cast<std::uint16_t>(piece_count(execution.leaf_size, kWidth));
  head.leaf_count = static_cast<std::uint32_t>(piece_count(triangle_count, execution.leaf_size));
  if (head.leaf_count == 0) return head;
  head.level_count = 1;
  for (std::size_t spheres = head.leaf_count;
       spheres > kWidth && (execution.tree_levels == 0 || head.level_count < execution.tree_levels);
       spheres = piece_count(spheres, kWidth))
    ++head.level_count;
  return head;
}

std::shared_ptr<TreeLine[]> make_lines(std::size_t count) {
  return std::shared_ptr<TreeLine[]>(new TreeLine[count]);  // a TreeLine has no initial value
}

Box build_tree(const Triangles& triangles, std::vector<std::uint32_t>& members, const Execution& execution,
               TreeHead& head, TreeLine* lines) {
  if (members.empty()) return {};
  const std::size_t threads = execution.threads;
  const Box box = box_round_members(triangles, members, threads);
  head.origin = box.middle();
  order_in_space(
      members, {box.lower - head.origin, box.upper - head.origin}, execution.leaf_size, threads,
      [&](std::uint32_t triangle) { return bound_triangle(triangles, triangle, head.origin).centre; });

  const TreeLayout layout = layout_of(head);
  auto* const blocks = reinterpret_cast<SphereBlock*>(lines);
  auto* const numbers =
      reinterpret_cast<std::uint32_t*>(lines + kLinesPerBlock * (layout.upper + layout.lowest));
  Leaves leaves = put_leaves(triangles, members, execution, head, blocks + layout.upper, numbers);
  put_levels(std::move(leaves.bound), {}, layout, threads, head, blocks + layout.upper);
  return leaves.box;
}

SphereTree build_levels(std::vector<Sphere> leaves, std::span<const std::vector<Sphere>> held, Vec3 origin,
                        const Execution& execution) {
  Execution sized = execution;
  sized.leaf_size = 1;
  SphereTree tree;
  tree.head = plan_tree(leaves.size(), sized);
  tree.head.blocks_per_leaf = 0;
  tree.head.origin = origin;
  const TreeLayout layout = layout_of(tree.head);
  const auto lines = make_lines(layout.lines);
  for (const Sphere& leaf : leaves) tree.box.add(leaf.centre, (1 + kBoxSlack) * leaf.radius);
  if (!leaves.empty()) {
    put_levels(std::move(leaves), held, layout, execution.threads, tree.head,
               reinterpret_cast<SphereBlock*>(lines.get()) + layout.upper);
  }
  tree.lines = {lines.get(), layout.lines, lines};
  return tree;
}

SphereTree build_tree(const Triangles& triangles, std::vector<std::uint32_t>& members,
                      const Execution& execution) {
  SphereTree tree;
  tree.head = plan_tree(members.size(), execution);
  const std::size_t count = layout_of(tree.head).lines;
  const auto lines = make_lines(count);
  tree.box = build_tree(triangles, members, execution, tree.head, lines.get());
  tree.lines = {lines.get(), count, lines};
  return tree;
}

SphereTree build_tree(const Triangles& triangles, const Execution& execution) {
  std::vector<std::uint32_t> all(triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  return build_tree(triangles, all, execution);
}

std::size_t frontier_capacity(const TreeHead& head) {
  const TreeLayout layout = layout_of(head);
  return std::max(layout.blocks[0] * kWidth, layout.lowest);
}

std::size_t byte_count(const SphereTree& tree) { return sizeof(tree) + tree.lines.size() * sizeof(TreeLine); }

}  // namespace lumbrical
