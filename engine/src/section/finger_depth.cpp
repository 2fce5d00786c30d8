#include "section/finger_depth.h"

#include "base/share_along.h"

namespace lumbrical {
namespace {

// Is a point certainly outside a phalanx? Most are, and then no section of it is needed.
bool is_clear_of(const Primitive& capsule, Vec3 point) {
  const Vec3 axis = capsule.end2 - capsule.end1, from = point - capsule.end1;
  const double reach = kReachMargin * max(capsule.radius1, capsule.radius2);
  const Vec3 off = from - share_along(axis, from) * axis;
  return dot(off, off) > reach * reach;
}

// How far beyond `from` the line along -n runs on through other phalanges of the finger than `own`.
double onward(const Primitives& hand, int own, Vec3 from, Vec3 n, Vec3 along) {
  const int first = own - own % 3;
  bool passed[3] = {own == first, own == first + 1, own == first + 2};
  double depth = 0;
  bool moved = true;  // else all others have been asked from here
  for (int step = 0; step < 2 && moved; ++step) {
    moved = false;
    for (int i = 0; i < 3; ++i) {
      const std::size_t phalanx = static_cast<std::size_t>(first + i);
      if (passed[i] || !hand.present[phalanx]) continue;
      const Vec3 point = from - depth * n;
      if (is_clear_of(hand.capsule[phalanx], point)) continue;
      Section section;
      if (!look_along(hand.capsule[phalanx], point, n, along, section)) continue;
      const Point2 p{dot(point - section.origin, section.u), dot(point - section.origin, section.v)};
      if (!inside_section(section, p)) continue;
      depth += max(0, depth_at(section, p));
      passed[i] = moved = true;
    }
  }
  return depth;
}

// The same polygon, seen in the plane coordinates of another primitive.
bool look_through(const Primitive& capsule, const Section& from, Section& section) {
  const Vec3 point = to_world(from, from.polygon.corner[0]);
  if (!look_along(capsule, point, from.n, from.u, section)) return false;
  section.polygon.count = from.polygon.count;
  for (std::size_t i = 0; i < from.polygon.count; ++i) {
    const Vec3 corner = to_world(from, from.polygon.corner[i]) - section.origin;
    section.polygon.corner[i] = {dot(corner, section.u), dot(corner, section.v)};
  }
  return true;
}

// A body is its phalanx but for the cuts, and those are in the polygon.
bool is_body_of(const Primitive& primitive, const Primitive& capsule) {
  return primitive.end1 == capsule.end1 && primitive.end2 == capsule.end2 &&
         primitive.radius1 == capsule.radius1 && primitive.radius2 == capsule.radius2;
}

// Does the way out of the sphere at an end of a phalanx lead out of the phalanx? So it does where the hull of
// both end spheres has this one's surface: beyond the circle in which the cone touches it.
bool leaves_both(const Primitive& sphere, const Primitive& capsule, Vec3 exit) {
  const bool first = sphere.end1 == capsule.end1;
  const Vec3 axis = (first ? capsule.end2 : capsule.end1) - sphere.end1;
  const double growth = (first ? capsule.radius2 : capsule.radius1) - sphere.radius1;
  return dot(exit - sphere.end1, axis) < -sphere.radius1 * growth;
}

// Is the depth in `primitive`, where it is left at `exit`, that in the phalanx?
bool is_depth_in(const Primitive& capsule, const Primitive& primitive, Vec3 exit) {
  return is_body_of(primitive, capsule) || leaves_both(primitive, capsule, exit);
}

Vec3 exit_from(const Section& section, Point2 p, double depth) {
  return to_world(section, p) - depth * section.n;
}

}  // namespace

// Depth is concave in a phalanx and in its end spheres. Where the two agree about a point and all near it,
// the deepest point of the sphere is that of the phalanx, too.
Deepest finger_depth(const Primitives& hand, const Primitive& primitive, const Section& section) {
  const Deepest own = largest_depth(section);
  const Vec3 n = section.n, exit = exit_from(section, own.point, own.depth);
  Deepest best = own;
  for (const int phalanx : primitive.phalanx) {
    if (phalanx < 0) continue;
    const Primitive& capsule = hand.capsule[static_cast<std::size_t>(phalanx)];
    Deepest deepest = own;
    if (own.depth > 0 && is_depth_in(capsule, primitive, exit)) {
      deepest.depth += onward(hand, phalanx, exit, n, section.u);
    } else {
      Section whole;
      if (!look_through(capsule, section, whole)) continue;
      deepest = largest_depth(whole);
      const Vec3 start = to_world(whole, deepest.point) - section.origin;
      deepest.depth += onward(hand, phalanx, exit_from(whole, deepest.point, deepest.depth), n, section.u);
      deepest.point = {dot(start, section.u), dot(start, section.v)};
    }
    if (deepest.depth > best.depth) best = deepest;
  }
  return best;
}

bool go_through_finger(const Primitives& hand, const Primitive& primitive, Vec3 from, Vec3 n, Vec3 along,
                       double& depth) {
  if (!(depth > 0)) return false;
  const Vec3 exit = from - depth * n;
  double more = 0;
  for (const int phalanx : primitive.phalanx) {
    if (phalanx < 0) continue;
    if (!is_depth_in(hand.capsule[static_cast<std::size_t>(phalanx)], primitive, exit)) return false;
    more = max(more, onward(hand, phalanx, exit, n, along));
  }
  depth += more;
  return true;
}

double finger_depth_at(const Primitives& hand, const Primitive& primitive, const Section& section, Point2 p) {
  const double own = depth_at(section, p);
  const Vec3 n = section.n, start = to_world(section, p);
  double best = own;
  for (const int phalanx : primitive.phalanx) {
    if (phalanx < 0) continue;
    const Primitive& capsule = hand.capsule[static_cast<std::size_t>(phalanx)];
    double depth = own;
    if (!is_depth_in(capsule, primitive, start - own * n)) {
      Section whole;
      if (!look_along(capsule, start, n, section.u, whole)) continue;
      const Point2 q{dot(start - whole.origin, whole.u), dot(start - whole.origin, whole.v)};
      if (!inside_section(whole, q)) continue;
      depth = depth_at(whole, q);
    }
    best = max(best, depth + onward(hand, phalanx, start - depth * n, n, section.u));
  }
  return best;
}

}  // namespace lumbrical
