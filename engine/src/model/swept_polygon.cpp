#include "model/swept_polygon.h"

#include <cassert>
#include <cmath>

namespace lumbrical {
namespace {

// Twice the area of the polygon, in the xz-plane: positive where it runs counterclockwise seen from -y, the
// palmar side.
double twice_area(const std::vector<Vec3>& polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    sum += p.x * q.z - p.z * q.x;
  }
  return sum;
}

void add(const Primitive& part, Primitives& hand) {
  assert(hand.count < Primitives::kMaxCount);
  hand.primitive[hand.count++] = part;
}

// The slab on the side to which `up` points, a normal of the core.
void add_slab(const SweptPolygon& palm, Vec3 up, Primitive part, Primitives& hand) {
  const std::size_t count = palm.corner_count;
  Vec3 from_first;  // far from the origin no digit of a mean of corners is to be lost
  for (std::size_t i = 0; i < count; ++i)
    from_first += (palm.corner[i] - palm.corner[0]) / static_cast<double>(count);
  const Vec3 middle = palm.corner[0] + from_first;
  double square = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 off = palm.corner[i] - middle;
    square = max(square, dot(off, off));
  }
  part.shape = Shape::slab;
  part.end1 = part.end2 = middle + 0.5 * palm.radius * up;
  part.radius1 = part.radius2 = std::sqrt(square + 0.25 * palm.radius * palm.radius);
  part.cut[part.cut_count++] = {-up, palm.corner[0]};
  add(part, hand);
}

}  // namespace

SweptPolygon place_palm(const Palm& palm, const Pose& X_WP) {
  SweptPolygon core;
  const std::size_t count = palm.polygon.size();
  if (count < 3 || count > SweptPolygon::kMostCorners) return core;
  core.corner_count = static_cast<std::uint32_t>(count);
  core.radius = 0.5 * palm.thickness;
  core.normal = rotate(X_WP.orientation, {0, -1, 0});
  const bool in_order = twice_area(palm.polygon) > 0;
  const auto corner = [&](std::size_t i) {
    return palm.polygon[in_order ? i % count : count - 1 - i % count];
  };
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 p = corner(i), q = corner(i + 1);
    core.corner[i] = transform(X_WP, {p.x, core.radius - palm.height, p.z});
    core.outward[i] = rotate(X_WP.orientation, unit_or({q.z - p.z, 0, p.x - q.x}, {1, 0, 0}));
  }
  return core;
}

void add_palm_parts(const SweptPolygon& palm, Law law, Primitives& hand) {
  if (palm.corner_count == 0) return;
  Primitive part;
  part.segment = kPalmSegment;
  part.law = law;
  add_slab(palm, palm.normal, part, hand);
  add_slab(palm, -palm.normal, part, hand);

  const std::size_t count = palm.corner_count;
  // Through a corner, halving what lies beyond it: its normal leads from the edge before it to the one after.
  const auto halving = [&](std::size_t i) {
    const Vec3 before = palm.outward[(i + count - 1) % count], after = palm.outward[i];
    const Vec3 along = cross(palm.normal, after);
    return unit_or(cross(palm.normal, before + after), along);
  };
  part.radius1 = part.radius2 = palm.radius;
  part.cut_count = 3;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    part.end1 = palm.corner[i];
    part.end2 = palm.corner[next];
    part.cut = {{{-palm.outward[i], part.end1}, {-halving(i), part.end1}, {halving(next), part.end2}}};
    add(part, hand);
  }
}

Slab slab_of(const SweptPolygon& palm, const Primitive& slab) {
  Slab faces;
  faces.thickness = palm.radius;
  const auto add_face = [&](const HalfSpace& face) { faces.face[faces.face_count++] = face; };
  const HalfSpace core = slab.cut[0];
  add_face({-core.normal, core.point - palm.radius * core.normal});
  add_face(core);
  for (std::size_t i = 0; i < palm.corner_count; ++i) add_face({palm.outward[i], palm.corner[i]});
  return faces;
}

}  // namespace lumbrical
