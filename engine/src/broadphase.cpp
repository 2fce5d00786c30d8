#include "broadphase.h"

#include <algorithm>

#include "sphere_tree.h"

namespace lumbrical {
namespace {

// Keeps the pair if its bounds meet; false where there is no room.
bool offer(const Model& model, const Primitive& primitive, std::uint64_t index, std::uint32_t triangle,
           Scratch& scratch) {
  if (!may_touch(primitive, bound_triangle(model.triangles, triangle))) return true;
  if (scratch.candidate_count == scratch.candidates.size()) return false;
  scratch.candidates[scratch.candidate_count++] = index << 32 | triangle;
  return true;
}

bool try_all(const Model& model, const Primitive& primitive, std::uint64_t index, Scratch& scratch) {
  for (std::uint32_t triangle = 0; triangle < model.triangles.size(); ++triangle) {
    if (!offer(model, primitive, index, triangle, scratch)) return false;
  }
  return true;
}

bool try_tree(const Model& model, const Primitive& primitive, std::uint64_t index, Scratch& scratch) {
  const std::span<const std::uint32_t> leaves = query_tree(model.tree, primitive, scratch.frontier);
  const std::size_t leaf_size = model.tree.leaf_size;
  for (const std::uint32_t leaf : leaves) {
    const std::size_t first = leaf * leaf_size,
                      last = std::min(first + leaf_size, model.tree.triangle.size());
    for (std::size_t i = first; i < last; ++i) {
      if (!offer(model, primitive, index, model.tree.triangle[i], scratch)) return false;
    }
  }
  return true;
}

}  // namespace

bool may_touch(const Primitive& primitive, const TriangleBound& bound) {
  const Vec3 axis = primitive.end2 - primitive.end1, from = bound.centre - primitive.end1;
  const double square = dot(axis, axis);
  const double t = square > 0 ? clamp(dot(from, axis) / square, 0, 1) : 0;
  const Vec3 gap = from - t * axis;
  // A little more than the sum of the radii: rounding must not lose a contact.
  const double reach = 1.000001 * (max(primitive.radius1, primitive.radius2) + bound.radius);
  return dot(gap, gap) <= reach * reach;
}

bool find_candidates(const Model& model, const Primitives& hand, Scratch& scratch) {
  scratch.candidate_count = 0;
  for (int i = 0; i < hand.count; ++i) {
    const Primitive& primitive = hand.primitive[static_cast<std::size_t>(i)];
    const std::uint32_t first = scratch.candidate_count;
    const auto search = model.execution.broadphase == Broadphase::tree ? try_tree : try_all;
    if (!search(model, primitive, static_cast<std::uint64_t>(i), scratch)) {
      scratch.candidate_count = 0;
      return false;
    }
    std::sort(scratch.candidates.begin() + first, scratch.candidates.begin() + scratch.candidate_count);
  }
  return true;
}

}  // namespace lumbrical
