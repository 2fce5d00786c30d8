#include "section/finger_depth.h"

namespace lumbrical {
namespace {

// How far beyond `from` the line along -n runs on through other phalanges of the finger.
double onward(const Primitives& hand, int first, int own, Vec3 from, Vec3 n, Vec3 along) {
  bool passed[3] = {own == first, own == first + 1, own == first + 2};
  double depth = 0;
  bool moved = true;  // else all others have been asked from here
  for (int step = 0; step < 2 && moved; ++step) {
    moved = false;
    for (int i = 0; i < 3; ++i) {
      const std::size_t phalanx = static_cast<std::size_t>(first + i);
      if (passed[i] || !hand.present[phalanx]) continue;
      Section section;
      const Vec3 point = from - depth * n;
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
  for (int i = 0; i < from.polygon.count; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const Vec3 corner = to_world(from, from.polygon.corner[k]) - section.origin;
    section.polygon.corner[k] = {dot(corner, section.u), dot(corner, section.v)};
  }
  return true;
}

}  // namespace

Deepest finger_depth(const Primitives& hand, const Primitive& primitive, const Section& section) {
  Deepest best = largest_depth(section);
  for (const int phalanx : primitive.phalanx) {
    if (phalanx < 0) continue;
    Section whole;
    if (!look_through(hand.capsule[static_cast<std::size_t>(phalanx)], section, whole)) continue;
    Deepest deepest = largest_depth(whole);
    const Vec3 start = to_world(whole, deepest.point);
    deepest.depth +=
        onward(hand, phalanx - phalanx % 3, phalanx, start - deepest.depth * section.n, section.n, section.u);
    deepest.point = {dot(start - section.origin, section.u), dot(start - section.origin, section.v)};
    if (deepest.depth > best.depth) best = deepest;
  }
  return best;
}

double finger_depth_at(const Primitives& hand, const Primitive& primitive, const Section& section, Point2 p) {
  double best = depth_at(section, p);
  const Vec3 start = to_world(section, p);
  for (const int phalanx : primitive.phalanx) {
    if (phalanx < 0) continue;
    Section whole;
    if (!look_along(hand.capsule[static_cast<std::size_t>(phalanx)], start, section.n, section.u, whole))
      continue;
    const Point2 q{dot(start - whole.origin, whole.u), dot(start - whole.origin, whole.v)};
    if (!inside_section(whole, q)) continue;
    double depth = depth_at(whole, q);
    depth += onward(hand, phalanx - phalanx % 3, phalanx, start - depth * section.n, section.n, section.u);
    best = max(best, depth);
  }
  return best;
}

}  // namespace lumbrical
