#include "search/near_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/swept_polygon.h"

namespace lumbrical {
namespace {

// Skins as shares of the hand's smallest radius. In between the square of the skin is kGrowth times that
// radius times the way of a tick, about where the price of doubt equals that of searching (measured).
constexpr double kLeastSkin = 1.0 / 32, kMostSkin = 1.0 / 4, kGrowth = 4;

// Ticks that a list must last to be worth making: it costs twice as much as a search (measured).
constexpr double kLeastLife = 4;

// Coordinates and hulls beyond these multiples of the skin leave rounding too large a part of it.
constexpr double kFarthest = 0x1p46, kLongest = 1e4;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

static_assert(MissTerms::kPlaneCapacity >= Slab::kMostFaces &&
              MissTerms::kPlaneCapacity >= Primitive::kMostCuts);
void add_plane(const HalfSpace& space, double overhang, Hull& hull) {
  hull.plane[static_cast<std::size_t>(hull.plane_count++)] = {
      space.normal, dot(space.normal, space.point - hull.end1) + overhang};
}

}  // namespace

void set_hull(const Primitive& primitive, const SweptPolygon& palm, Hull& hull) {
  hull.end1 = primitive.end1;
  hull.end2 = primitive.end2;
  hull.radius1 = primitive.radius1;
  hull.radius2 = primitive.radius2;
  hull.plane_count = 0;
  if (primitive.shape == Shape::slab) {
    const Slab slab = slab_of(palm, primitive);
    for (std::size_t i = 0; i < slab.face_count; ++i) add_plane(slab.face[i], 0, hull);
    return;
  }
  for (std::size_t i = 0; i < primitive.cut_count; ++i)
    add_plane(primitive.cut[i], primitive.overhang[i], hull);
}

void set_terms(const Hull& hull, double skin, MissTerms& terms) {
  const Vec3 span = hull.end2 - hull.end1;
  terms.length = norm(span);
  terms.end1 = hull.end1;
  terms.axis = terms.length > 0 ? span / terms.length : Vec3{};
  terms.radius1 = hull.radius1 + skin;
  terms.radius2 = hull.radius2 + skin;
  terms.most = max(terms.radius1, terms.radius2);
  terms.plane_count = hull.plane_count;
  for (std::size_t i = 0; i < static_cast<std::size_t>(hull.plane_count); ++i)
    terms.plane[i] = {hull.plane[i].normal, hull.plane[i].height + skin};
}

double reach_of(const Hull& hull) {
  return 2 * (norm(hull.end2 - hull.end1) + 2 * max(hull.radius1, hull.radius2));
}

double distance_moved(const Hull& from, const Hull& to) {
  if (from.plane_count != to.plane_count || from.radius1 != to.radius1 || from.radius2 != to.radius2)
    return kInfinite;
  const Vec3 shift = to.end1 - from.end1;
  double moved = max(norm(shift), norm(to.end2 - from.end2));
  const double reach = reach_of(from);
  for (std::size_t i = 0; i < static_cast<std::size_t>(from.plane_count); ++i) {
    // How far the plane has moved at the first end, and how much more where its turning shows most.
    const MissTerms::Plane &a = from.plane[i], &b = to.plane[i];
    const double there = std::fabs(dot(b.normal, shift) + b.height - a.height);
    moved = max(moved, there + reach * norm(b.normal - a.normal));
  }
  return moved;
}

SkinLimits skin_limits(const Primitives& hand) {
  double least = kInfinite, coordinate = 0, longest = 0;
  for (std::size_t i = 0; i < hand.count; ++i) {
    const Primitive& primitive = hand.primitive[i];
    least = min(least, min(primitive.radius1, primitive.radius2));
    coordinate = max(coordinate, max(largest_of(primitive.end1), largest_of(primitive.end2)));
    longest = max(longest, norm(primitive.end2 - primitive.end1) + max(primitive.radius1, primitive.radius2));
  }
  const double skin = kLeastSkin * least;
  const bool fine = skin * kFarthest > coordinate && skin * kLongest > longest && skin < kInfinite;
  return fine ? SkinLimits{skin, kMostSkin * least} : SkinLimits{};
}

double skin_for(double moved, const SkinLimits& limits) {
  if (!(kLeastLife * moved <= kUse * limits.most)) return 0;
  const double radius = limits.most / kMostSkin;
  return clamp(std::sqrt(kGrowth * radius * moved), limits.least, limits.most);
}

void keep_lists(const std::array<bool, Primitives::kMaxCount>& keep, NearPairs& near) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    NearPairs::List& list = near.list[i];
    if (!keep[i]) {
      list.skin = 0;
      list.count = 0;
      continue;
    }
    std::copy_n(near.pairs.data() + list.first, list.count, near.other.data() + size);
    list.first = size;
    size += list.count;
  }
  near.pairs.swap(near.other);
  near.size = size;
}

}  // namespace lumbrical
