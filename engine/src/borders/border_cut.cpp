// One pair at a time; many are for the lanes (border_pairs.h).
#include "borders/border_cut.h"

#include <cmath>

#include "borders/border_bulge.h"
#include "exact/border_terms.h"
#include "section/pressure.h"

namespace lumbrical {
namespace {

// How high the border rises over the chord in the plane with normal n at most, for K cuts the plane in a
// convex curve, which stays below its tangents at both ends. Negative: too steep to tell.
double height_bound(const JointBorder& border, Vec3 from, Vec3 to, Vec3 n) {
  const Vec3 d = to - from;
  const double length = norm(d);
  if (!(length > 0)) return -1;
  const Vec3 along = d / length, across = cross(along, n);
  double slope[2];
  for (int i = 0; i < 2; ++i) {
    const Vec3 p = i == 0 ? from : to;
    const double x = dot(border.x, p), y = dot(border.y, p), rho = std::sqrt(x * x + y * y);
    if (!(rho > 0)) return -1;
    const Vec3 steepest = (x / rho) * border.x + (y / rho) * border.y - border.side * border.normal;
    const double rise = dot(steepest, along), fall = dot(steepest, across);
    if (!(std::fabs(rise) < kSteepestChord * std::fabs(fall))) return -1;
    slope[i] = std::fabs(rise / fall);
  }
  const double sum = slope[0] + slope[1];
  return sum > 0 ? kReachMargin * length * slope[0] * slope[1] / sum : 0;
}

// Does the tile keep clear of a chord and of all that may lie between it and its border?
bool keeps_clear(const Primitive& tile, Vec3 joint, Vec3 from, Vec3 to, double height) {
  const Segment axis{tile.end1 - joint, tile.end2 - joint}, chord{from, to};
  return segment_distance(axis, chord) > kReachMargin * (max(tile.radius1, tile.radius2) + height);
}

// Where the border misses the section: does cutting along the chord give the same? Not if the chord runs
// through the section, nor if all of that lies between chord and border.
bool chord_will_do(const Section& section, const Chord& chord, double height) {
  const Interval inside = inside_interval(section, chord.from, chord.along, 0, chord.length);
  if (inside.first < inside.second) return false;
  const Interval extent = real_extent(section);
  const Point2 within{0.5 * (extent.first + extent.second), 0};
  return std::fabs(dot(chord.across, within - chord.from)) > height;
}

Vec3 from_joint(const Section& section, Vec3 joint, Point2 p) {
  return (section.origin - joint) + (p.x * section.u + p.y * section.v - section.h1 * section.n);
}

Chord chord_of(const Section& section, Vec3 joint, const BorderCut& cut) {
  const auto in_plane = [&](Vec3 p) {
    const Vec3 d = (joint - section.origin) + p;
    return Point2{dot(d, section.u), dot(d, section.v)};
  };
  return chord_between(in_plane(cut.from), in_plane(cut.to));
}

BulgeMoments in_space(const Section& section, const Bulge& bulge) {
  const auto turned = [&](Point2 p) { return p.x * section.u + p.y * section.v; };
  return {to_world(section, {0, 0}), bulge.area,          bulge.volume,
          turned(bulge.area_first),  turned(bulge.first), bulge.error};
}

// The cut along the part of a border inside the section; false where it is not as simple as that.
bool cut_along_border(const ExactKernels& kernels, const Primitives& hand, const Primitive& tile,
                      const BorderCrossing& crossing, const Corners& at, HalfSpace& half_space,
                      BorderCut& cut) {
  Vec3 n;
  if (!normal_of(at, n)) {
    cut.kind = CutKind::gone;
    return true;
  }
  const std::size_t phalanx = joint_of(tile, cut.outer);
  cut.height = height_bound(hand.border[phalanx], crossing.from, crossing.to, n);
  if (cut.height < 0) return false;
  cut.from = crossing.from;
  cut.to = crossing.to;
  const Vec3 joint = hand.border[phalanx].centre, upright = unit_or(cross(cut.to - cut.from, n), {});
  half_space = {upright, joint, dot(upright, cut.from)};
  if (keeps_clear(tile, joint, cut.from, cut.to, cut.height)) return true;
  Section section;
  if (!look_along(tile, at.a, n, at.b - at.a, section)) {
    cut.kind = CutKind::gone;
    return true;
  }
  const Kin kin = joint_kin(section, hand, phalanx, cut.outer);
  Chord chord = chord_of(section, joint, cut);
  const Course course = follow_border(section, kin, chord);
  if (course == Course::unclear) return false;
  if (course == Course::outside) return chord_will_do(section, chord, cut.height);
  cut.from = from_joint(section, joint, chord.from);
  cut.to = from_joint(section, joint, chord.at(chord.length, 0));
  const Vec3 across = chord.across.x * section.u + chord.across.y * section.v;
  half_space = {across, joint, dot(across, cut.from)};
  cut.crosses = true;
  Bulge bulge;
  if (!integrate_bulge(kernels, section, kin, chord, bulge)) return false;
  cut.bulge = in_space(section, bulge);
  return true;
}

}  // namespace

bool keeps_to(const HalfSpace& space, Vec3 joint, Vec3 from, Vec3 to, double height) {
  if (!(dot(space.normal, space.normal) > 0)) return true;
  const Vec3 base = joint - space.point;
  const double most = max(dot(space.normal, base + from), dot(space.normal, base + to));
  return most - space.offset <= -height;
}

BorderCut cut_at_borders(const ExactKernels& kernels, const Primitives& hand, const Primitive& tile,
                         const TileBorders& near, const Corners& at) {
  const TriangleCuts cuts = cross_borders(hand, tile, near, at);
  const auto& [inner, outer] = cuts.crossing;
  BorderCut cut;
  cut.kind = cuts.kind;
  cut.cut = cuts.cut;
  if (cut.kind != CutKind::other || (!inner.exists && !outer.exists)) return cut;
  if (inner.exists && outer.exists) {
    cut.kind = CutKind::unclear;
    return cut;
  }
  cut.outer = outer.exists;
  const std::size_t own = own_cut(tile, cut.outer);
  if (!cut_along_border(kernels, hand, tile, cut.outer ? outer : inner, at, cut.cut[own], cut))
    cut.kind = CutKind::unclear;
  // The bulge keeps to the tile's side of the other cut.
  const Vec3 joint = hand.border[joint_of(tile, cut.outer)].centre;
  if (tile.cut_count == 2 && cut.crosses && !keeps_to(cut.cut[1 - own], joint, cut.from, cut.to, cut.height))
    cut.kind = CutKind::unclear;
  return cut;
}

Primitive tile_cut_so(const Primitive& tile, const std::array<HalfSpace, 2>& cut) {
  Primitive result = tile;
  result.cut = {cut[0], cut[1]};
  return result;
}

void add_bulge(const BulgeMoments& bulge, Contact& contact) {
  const double area = contact.area + bulge.area, volume = contact.volume + bulge.volume;
  if (!(area > 0)) {
    contact.area = 0;
    return;
  }
  const Vec3 base = bulge.base;
  contact.centroid = base + (1 / area) * (contact.area * (contact.centroid - base) + bulge.area_first);
  contact.centre = volume > 0 ? base + (1 / volume) * (contact.volume * (contact.centre - base) + bulge.first)
                              : contact.centroid;
  contact.area = area;
  contact.volume = max(0, volume);
  contact.error += bulge.error;
}

bool bulge_slope(const Primitives& hand, const Primitive& tile, const BorderCut& cut, const Corners& at,
                 SlopeMoments& slope) {
  if (!cut.crosses) return true;
  Section section;
  Vec3 n;
  if (!normal_of(at, n) || !look_along(tile, at.a, n, at.b - at.a, section)) return false;
  const std::size_t phalanx = joint_of(tile, cut.outer);
  const Kin kin = joint_kin(section, hand, phalanx, cut.outer);
  const Chord chord = chord_of(section, hand.border[phalanx].centre, cut);
  return integrate_bulge_slope(section, kin, hand.border[phalanx], chord, slope);
}

}  // namespace lumbrical
