// Proportions come from a tracked adult hand: they place what a tracker leaves out to within about a
// centimetre, which is enough for the palm, the only part that is felt there.
#include "model/hand_from_positions.h"

#include "base/set_bits.h"
#include "model/convex_hull.h"

namespace lumbrical {
namespace {

constexpr double kCarpalDepth = 0.37;   // of the way from the wrist to the knuckles, where metacarpals begin
constexpr double kCarpalSpread = 0.85;  // of the knuckles' distance from the hand's midline
constexpr double kWristBehindCarpals = 0.56;  // in lengths of the middle metacarpal
constexpr double kHair = 1e-9;                // [m^2] corners of a palm that stand out by less (convex_hull)
constexpr double kFlatCorner = 0.02;  // of the palm's thickness: corners of its core that stand out by less
constexpr double kWristBehindKnuckle = 2.2;  // in lengths of the middle finger's proximal phalanx

struct Axes {
  Vec3 x, y, z;
};

constexpr int metacarpal(int finger) { return finger == 0 ? kThumbMetacarpal : 1 + 5 * finger; }
constexpr int proximal(int finger) { return metacarpal(finger) + 1; }
static_assert(metacarpal(1) == kIndexMetacarpal && metacarpal(4) == kLittleMetacarpal);

bool knows(const HandPoints& points, int joint) { return has_bit(points.known, joint); }

// Some unit vector at right angles to the unit vector v.
Vec3 any_normal(Vec3 v) {
  const Vec3 other = std::fabs(v.y) < 0.9 ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  return unit_or(other - dot(other, v) * v, {1, 0, 0});
}

// Part of `v` at right angles to the unit vector `normal`, of unit length; where there is none, the same of
// `fallback`.
Vec3 perpendicular(Vec3 v, Vec3 normal, Vec3 fallback) {
  const Vec3 part = v - dot(v, normal) * normal;
  if (dot(part, part) > 1e-12 * dot(v, v)) return unit_or(part, any_normal(normal));
  const Vec3 other = fallback - dot(fallback, normal) * normal;
  return dot(other, other) > 1e-12 * dot(fallback, fallback) ? unit_or(other, any_normal(normal))
                                                             : any_normal(normal);
}

Vec3 knuckle_mean(const HandPoints& points) {
  Vec3 sum;
  for (int f = 1; f < kFingerCount; ++f) sum += points.position[proximal(f)];
  return 0.25 * sum;
}

Axes palm_axes(const HandPoints& points) {
  const Vec3 index = points.position[kIndexProximal], little = points.position[kLittleProximal];
  const Vec3 heel = knows(points, kWrist) ? points.position[kWrist] : points.position[kMiddleMetacarpal];
  const bool heel_known = knows(points, kWrist) || knows(points, kMiddleMetacarpal);
  Vec3 forward = points.forward;
  if (dot(forward, forward) == 0 && heel_known) forward = knuckle_mean(points) - heel;
  Vec3 dorsal = points.dorsal;
  if (dot(dorsal, dorsal) == 0) {
    // Seen from the back of a right hand the knuckles run from index to little finger clockwise round the
    // wrist.
    const Vec3 across = points.side == Side::right ? little - index : index - little;
    dorsal = cross(across, forward);
  }
  Axes axes;
  axes.z = -unit_or(forward, {0, 0, -1});
  axes.y = perpendicular(dorsal, axes.z, {0, 1, 0});
  axes.x = cross(axes.y, axes.z);
  return axes;
}

void derive_wrist(const Axes& palm, HandPoints& points) {
  const Vec3 knuckle = points.position[kMiddleProximal];
  Vec3& wrist = points.position[kWrist];
  if (knows(points, kMiddleMetacarpal)) {
    const Vec3 carpal = points.position[kMiddleMetacarpal];
    wrist = carpal + kWristBehindCarpals * (carpal - knuckle);
  } else {
    wrist = knuckle + kWristBehindKnuckle * norm(points.position[kMiddleIntermediate] - knuckle) * palm.z;
  }
}

void derive_metacarpals(const Axes& palm, HandPoints& points) {
  const Vec3 wrist = points.position[kWrist];
  for (int f = 1; f < kFingerCount; ++f) {
    if (knows(points, metacarpal(f))) continue;
    const Vec3 knuckle = points.position[proximal(f)] - wrist;
    points.position[metacarpal(f)] = wrist + kCarpalDepth * dot(knuckle, palm.z) * palm.z +
                                     kCarpalSpread * dot(knuckle, palm.x) * palm.x +
                                     dot(knuckle, palm.y) * palm.y;
  }
}

// The axis about which a finger flexes: the normal of the plane in which it is bent, the more so the more it
// is bent, else the axis `rest` of a straight finger. Even in the bend, so hyperextension does not turn it
// round.
Vec3 flexion_axis(const std::array<Vec3, 3>& bone, Vec3 rest) {
  const Vec3 bend = cross(bone[1], bone[0]) + cross(bone[2], bone[1]);
  constexpr double kTrustInBend = 30;  // both weigh the same at a bend of some 10 degrees
  return unit_or(rest + kTrustInBend * dot(bend, rest) * bend, rest);
}

// Frames of a finger's three phalanges (first joint `first`) and its tip.
void orient_phalanges(int first, Vec3 rest_axis, const Axes& palm, const HandPoints& points,
                      std::array<Pose, kJointCount>& poses) {
  std::array<Vec3, 3> bone;
  Vec3 previous = -palm.z;
  for (int i = 0; i < 3; ++i) {
    bone[i] = previous = unit_or(points.position[first + i + 1] - points.position[first + i], previous);
  }
  const Vec3 axis = flexion_axis(bone, rest_axis);
  for (int i = 0; i < 3; ++i) {
    const Vec3 z = -bone[i];
    const Vec3 x = perpendicular(axis, z, palm.x);
    poses[first + i] = {points.position[first + i], quat_from_axes(x, cross(z, x), z)};
  }
  poses[first + 3] = {points.position[first + 3], poses[first + 2].orientation};
}

// What of a convex polygon (counter-clockwise in the sense of `turn`) is farther than `inset` [m] from every
// edge.
std::vector<Vec3> moved_in(const std::vector<Vec3>& polygon, double inset) {
  std::vector<Vec3> left = polygon;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const auto inside = [&](Vec3 p) { return turn(a, b, p) - inset * norm(b - a); };
    std::vector<Vec3> kept;
    for (std::size_t k = 0; k < left.size(); ++k) {
      const Vec3 p = left[k], q = left[(k + 1) % left.size()];
      const double fp = inside(p), fq = inside(q);
      if (fp >= 0) kept.push_back(p);
      if ((fp >= 0) != (fq >= 0)) kept.push_back(p + (fp / (fp - fq)) * (q - p));
    }
    left = std::move(kept);
  }
  return left;
}

// Leaves out the corners that stand out by less than `height` [m], the lowest first: every edge of a palm
// costs time.
void leave_out_flat_corners(double height, std::vector<Vec3>& polygon) {
  while (polygon.size() > 3) {
    const std::size_t count = polygon.size();
    std::size_t flattest = count;
    double least = height;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 before = polygon[(i + count - 1) % count], after = polygon[(i + 1) % count];
      const double here = turn(before, polygon[i], after) / norm(after - before);
      if (here < least) {
        least = here;
        flattest = i;
      }
    }
    if (flattest == count) return;
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(flattest));
  }
}

}  // namespace

Pose pose_along(Vec3 position, Vec3 forward, Vec3 dorsal) {
  const Vec3 z = -unit_or(forward, {0, 0, -1});
  const Vec3 y = perpendicular(dorsal, z, {0, 1, 0});
  return {position, quat_from_axes(cross(y, z), y, z)};
}

Pose palm_between(const Pose& middle_metacarpal, const Pose& middle_proximal) {
  return {0.5 * (middle_metacarpal.position + middle_proximal.position), middle_metacarpal.orientation};
}

std::array<Pose, kJointCount> hand_from_positions(const HandPoints& given) {
  HandPoints points = given;
  const Axes palm = palm_axes(points);
  if (!knows(points, kWrist)) derive_wrist(palm, points);
  derive_metacarpals(palm, points);

  std::array<Pose, kJointCount> poses;
  poses[kWrist] = {points.position[kWrist], quat_from_axes(palm.x, palm.y, palm.z)};
  // At rest the thumb flexes about an axis across its nail, which looks sideways: mostly the palm's normal.
  const double side_sign = points.side == Side::right ? 1.0 : -1.0;
  const Vec3 thumb_axis = unit_or(0.1 * palm.x + side_sign * (0.88 * palm.y - 0.46 * palm.z), palm.y);
  orient_phalanges(kThumbMetacarpal, thumb_axis, palm, points, poses);
  for (int f = 1; f < kFingerCount; ++f) {
    const Vec3 base = points.position[metacarpal(f)];
    const Vec3 bone = points.position[proximal(f)] - base;
    poses[metacarpal(f)] = pose_along(base, unit_or(bone, -palm.z), palm.y);
    orient_phalanges(proximal(f), palm.x, palm, points, poses);
  }
  poses[kPalm] = knows(points, kPalm)
                     ? Pose{points.position[kPalm], poses[kWrist].orientation}
                     : Pose{0.5 * (points.position[kMiddleMetacarpal] + points.position[kMiddleProximal]),
                            poses[kWrist].orientation};
  return poses;
}

std::vector<Vec3> fit_palm_polygon(const std::array<Pose, kJointCount>& X_BJ,
                                   std::span<const double, kJointCount> radius, double thickness) {
  const Pose X_PB = inverse(X_BJ[kPalm]);
  std::vector<Vec3> corners;
  for (int f = 1; f < kFingerCount; ++f) {
    const Vec3 half_width{radius[proximal(f)], 0, 0};
    for (const int joint : {metacarpal(f), proximal(f)}) {
      Vec3 p = transform(X_PB, X_BJ[joint].position);
      p.y = 0;
      corners.push_back(p - half_width);
      corners.push_back(p + half_width);
    }
  }
  const std::vector<Vec3> outline = convex_hull(std::move(corners), kHair);
  if (outline.size() < 3) return {};
  for (double inset = 0.5 * thickness; inset > 1e-3 * thickness; inset *= 0.5) {
    std::vector<Vec3> core = moved_in(outline, inset);
    if (core.size() >= 3) core = convex_hull(std::move(core), kHair);
    leave_out_flat_corners(kFlatCorner * thickness, core);
    if (core.size() >= 3) return core;
  }
  return outline;
}

}  // namespace lumbrical
