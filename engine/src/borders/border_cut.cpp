// A near border is a convex cone (JointBorder), and g = sqrt(x^2 + y^2) - side z is a convex function,
// negative inside. So a triangle with all corners inside is inside, one whose corners are above zero on a
// tangent plane of g is outside, and an edge from one to the other crosses the border once, at the root of a
// quadratic. Whatever is not as plain as that is left to `collide_shared`.
#include "borders/border_cut.h"

#include <cmath>

#include "borders/border_bulge.h"
#include "borders/joint_border.h"
#include "section/pressure.h"

namespace lumbrical {
namespace {

// Bulges below this share of R^3 are rounding.
constexpr double kNoBulge = 1e-16;

// Rounding must not lose one.
constexpr double kMargin = 1.000001;

constexpr double kFar = 1e300;

// A point in the border's coordinates. All points here are relative to the joint: far from the origin nothing
// is lost.
struct ConePoint {
  double x, y, z;  // z along the cone
};

ConePoint seen(const JointBorder& border, Vec3 d) {
  return {dot(border.x, d), dot(border.y, d), border.side * dot(border.normal, d)};
}
double gap_of(const ConePoint& p) { return std::sqrt(p.x * p.x + p.y * p.y) - p.z; }

// Is g positive on the whole straight or triangle round `middle` because its tangent plane there is?
bool is_above(const ConePoint& middle, const ConePoint* corner, int count) {
  const double length = std::sqrt(middle.x * middle.x + middle.y * middle.y);
  if (!(length > 0)) return false;
  const double gx = middle.x / length, gy = middle.y / length;
  for (int i = 0; i < count; ++i) {
    if (!(gx * corner[i].x + gy * corner[i].y - corner[i].z > 0)) return false;
  }
  return true;
}

// Where the way from a point inside the cone to one outside leaves it, as a share of the way.
double way_out(const ConePoint& inside, const ConePoint& outside) {
  const ConePoint d{outside.x - inside.x, outside.y - inside.y, outside.z - inside.z};
  const double a = d.x * d.x + d.y * d.y - d.z * d.z;
  const double b = inside.x * d.x + inside.y * d.y - inside.z * d.z;
  const double c = inside.x * inside.x + inside.y * inside.y - inside.z * inside.z;
  const double root = std::sqrt(max(0, b * b - a * c));
  const double t = b >= 0 ? (b + root > 0 ? -c / (b + root) : 0) : (a != 0 ? (root - b) / a : 1);
  return clamp(t, 0, 1);
}

enum class Verdict : std::uint8_t { mine, rivals, crossed, unclear };

struct Crossed {
  Verdict verdict = Verdict::unclear;
  Vec3 from, to;  // [m] W, from the joint: where the border crosses edges; the rival's part lies to the right
                  // of the way
};

Crossed cross_border(const JointBorder& border, bool is_outer_tile, const Vec3 (&corner)[3]) {
  ConePoint at[3];
  bool inside[3];
  int count = 0;
  for (int i = 0; i < 3; ++i) {
    at[i] = seen(border, corner[i]);
    inside[i] = gap_of(at[i]) < 0;
    count += inside[i] ? 1 : 0;
  }
  const bool mine_inside = (border.side > 0) == is_outer_tile;
  const auto middle = [](const ConePoint& p, const ConePoint& q) {
    return ConePoint{0.5 * (p.x + q.x), 0.5 * (p.y + q.y), 0.5 * (p.z + q.z)};
  };
  if (count == 3) return {mine_inside ? Verdict::mine : Verdict::rivals, {}, {}};
  if (count == 0) {
    const ConePoint centre{(at[0].x + at[1].x + at[2].x) / 3, (at[0].y + at[1].y + at[2].y) / 3, 0};
    if (!is_above(centre, at, 3)) return {};
    return {mine_inside ? Verdict::rivals : Verdict::mine, {}, {}};
  }
  int lone = 0;  // the corner on its own side
  while (inside[lone] != (count == 1)) ++lone;
  const int next = (lone + 1) % 3, last = (lone + 2) % 3;
  if (count == 1) {
    const ConePoint edge[2] = {at[next], at[last]};
    if (!is_above(middle(edge[0], edge[1]), edge, 2)) return {};
  }
  const auto crossing = [&](int i) {
    const int in = count == 1 ? lone : i, out = count == 1 ? i : lone;
    return corner[in] + way_out(at[in], at[out]) * (corner[out] - corner[in]);
  };
  // Counter-clockwise the lone corner lies between the crossings with its last and its next edge.
  const Vec3 before = crossing(last), after = crossing(next);
  const bool lone_is_mine = (count == 1) == mine_inside;
  return lone_is_mine ? Crossed{Verdict::crossed, after, before} : Crossed{Verdict::crossed, before, after};
}

// A border steeper than this against its chord is split elsewhere.
constexpr double kSteepChord = 0.3;

// How high the border rises over the chord in the plane with normal n at most, for K cuts the plane in a
// convex curve, which stays below its tangents at both ends. Negative: too steep to tell.
double height_bound(const JointBorder& border, Vec3 from, Vec3 to, Vec3 n) {
  const Vec3 d = to - from;
  const double length = norm(d);
  if (!(length > 0)) return 0;
  const Vec3 along = d / length, across = cross(along, n);
  double slope[2];
  for (int i = 0; i < 2; ++i) {
    const ConePoint p = seen(border, i == 0 ? from : to);
    const double rho = std::sqrt(p.x * p.x + p.y * p.y);
    if (!(rho > 0)) return -1;
    const Vec3 steepest = (p.x / rho) * border.x + (p.y / rho) * border.y - border.side * border.normal;
    const double rise = dot(steepest, along), fall = dot(steepest, across);
    if (!(std::fabs(rise) < kSteepChord * std::fabs(fall))) return -1;
    slope[i] = std::fabs(rise / fall);
  }
  const double sum = slope[0] + slope[1];
  return sum > 0 ? kMargin * length * slope[0] * slope[1] / sum : 0;
}

// Does the tile keep clear of a chord and of all that may lie between it and its border?
bool keeps_clear(const Primitive& tile, Vec3 joint, Vec3 from, Vec3 to, double height) {
  Primitive axis, chord;
  axis.end1 = tile.end1 - joint;
  axis.end2 = tile.end2 - joint;
  chord.end1 = from;
  chord.end2 = to;
  return segment_distance(axis, chord) > kMargin * (max(tile.radius1, tile.radius2) + height);
}

// Where the border misses the section: does cutting along the chord give the same? Not if the chord runs
// through the section, nor if all of that lies between chord and border.
bool chord_will_do(const Section& section, const Chord& chord, double height) {
  const Interval inside = inside_interval(section, chord.from, chord.along, 0, chord.length);
  if (inside.first < inside.second) return false;
  double lower = kFar, upper = -kFar;
  for (int i = 0; i < section.zone_count; ++i) {
    const Zone& zone = section.zone[static_cast<std::size_t>(i)];
    if (!(zone.real_lower < zone.real_upper)) continue;
    lower = min(lower, zone.real_lower);
    upper = max(upper, zone.real_upper);
  }
  const Point2 within{0.5 * (lower + upper), 0};
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

// The cut along the part of a border inside the section; false where it is not as simple as that.
bool cut_along(const Primitives& hand, const Primitive& tile, std::size_t phalanx, const Crossed& crossed,
               const Vec3 (&corner)[3], HalfSpace& half_space, BorderCut& cut) {
  Vec3 n;
  if (!normal_of(corner[0], corner[1], corner[2], n)) {
    cut.kind = BorderCut::gone;
    return true;
  }
  const double height = height_bound(hand.border[phalanx], crossed.from, crossed.to, n);
  if (height < 0) return false;
  cut.from = crossed.from;
  cut.to = crossed.to;
  const Vec3 joint = hand.border[phalanx].centre, upright = unit_or(cross(cut.to - cut.from, n), {});
  half_space = {upright, joint, dot(upright, cut.from)};
  const double radius = max(tile.radius1, tile.radius2);
  if (keeps_clear(tile, joint, cut.from, cut.to, height)) return true;
  Section section;
  if (!look_along(tile, corner[0], n, corner[1] - corner[0], section)) {
    cut.kind = BorderCut::gone;
    return true;
  }
  const Rival rival = joint_rival(section, hand, phalanx, phalanx == tile.segment);
  Chord chord = chord_of(section, joint, cut);
  const Course course = follow_border(section, rival, chord);
  if (course == Course::unclear) return false;
  if (course == Course::outside) return chord_will_do(section, chord, height);
  cut.from = from_joint(section, joint, chord.from);
  cut.to = from_joint(section, joint, chord.at(chord.length, 0));
  const Vec3 across = chord.across.x * section.u + chord.across.y * section.v;
  half_space = {across, joint, dot(across, cut.from)};
  const double depth = max(0, field_at(section, chord.at(0.5 * chord.length, 0))) + 0.5 * chord.length;
  cut.bulge = 0.5 * height * chord.length * min(radius, depth + height);
  cut.crosses = true;
  cut.curved = cut.bulge > kNoBulge * radius * radius * radius;
  return true;
}

}  // namespace

BorderCut cut_at_borders(const Primitives& hand, const Primitive& tile, const TileBorders& near, Vec3 a,
                         Vec3 b, Vec3 c) {
  const auto [inner, outer, folded] = near;
  const std::size_t i = tile.segment;
  BorderCut cut;
  if (folded || (inner && !hand.border[i - 1].near) || (outer && !hand.border[i].near)) {
    cut.kind = BorderCut::general;
    return cut;
  }
  if (!inner && !outer) return cut;
  cut.cut = tile.cut;
  Crossed crossed[2];
  for (const bool at_outer : {false, true}) {
    if (!(at_outer ? outer : inner)) continue;
    Crossed& here = crossed[at_outer ? 1 : 0];
    const JointBorder& border = hand.border[at_outer ? i : i - 1];
    here = cross_border(border, !at_outer, {a - border.centre, b - border.centre, c - border.centre});
    if (here.verdict == Verdict::unclear) cut.kind = BorderCut::general;
    if (here.verdict == Verdict::mine) cut.cut[at_outer ? tile.cut_count - 1u : 0u].normal = {};
  }
  if ((inner && crossed[0].verdict == Verdict::rivals) || (outer && crossed[1].verdict == Verdict::rivals)) {
    cut.kind = BorderCut::gone;
    return cut;
  }
  const bool crosses_inner = inner && crossed[0].verdict == Verdict::crossed,
             crosses_outer = outer && crossed[1].verdict == Verdict::crossed;
  if (cut.kind == BorderCut::general) return cut;
  cut.kind = BorderCut::other;
  if (crosses_inner && crosses_outer) {
    cut.kind = BorderCut::general;
  } else if (crosses_inner || crosses_outer) {
    cut.outer = crosses_outer;
    const std::size_t own = crosses_outer ? tile.cut_count - 1u : 0u;
    if (!cut_along(hand, tile, crosses_outer ? i : i - 1, crossed[crosses_outer ? 1 : 0], {a, b, c},
                   cut.cut[own], cut)) {
      cut.kind = BorderCut::general;
    }
    if (tile.cut_count == 2 && cut.curved) {
      // The bulge keeps to the tile's side of the other cut.
      const HalfSpace& rest = cut.cut[1 - own];
      const double size = norm(cut.to - cut.from);
      const Vec3 joint = hand.border[crosses_outer ? i : i - 1].centre - rest.point;
      const double most = max(dot(rest.normal, joint + cut.from), dot(rest.normal, joint + cut.to));
      if (most > -size && dot(rest.normal, rest.normal) > 0) cut.kind = BorderCut::general;
    }
  }
  return cut;
}

Primitive tile_cut_so(const Primitive& tile, const BorderCut& cut) {
  Primitive result = tile;
  result.cut = cut.cut;
  return result;
}

void add_bulge(const FieldKernels& kernels, const Primitives& hand, const Primitive& tile,
               const BorderCut& cut, double tolerance, Vec3 a, Vec3 b, Contact& contact) {
  const double radius = max(tile.radius1, tile.radius2);
  if (cut.bulge <= tolerance * radius * contact.area) {
    contact.error += cut.bulge;
    return;
  }
  Section section;
  if (!look_along(tile, a, contact.normal, b - a, section)) return;
  const std::size_t phalanx = cut.outer ? tile.segment : tile.segment - 1u;
  const Rival rival = joint_rival(section, hand, phalanx, cut.outer);
  Bulge bulge;
  if (!integrate_bulge(kernels, section, rival, chord_of(section, hand.border[phalanx].centre, cut), bulge))
    return;
  const double area = contact.area + bulge.area, volume = contact.volume + bulge.volume;
  if (!(area > 0)) {
    contact.area = 0;
    return;
  }
  const Vec3 foot = to_world(section, {0, 0});
  const auto in_space = [&](Point2 p) { return p.x * section.u + p.y * section.v; };
  contact.centroid =
      foot + (1 / area) * (contact.area * (contact.centroid - foot) + in_space(bulge.area_first));
  contact.centre =
      volume > 0 ? foot + (1 / volume) * (contact.volume * (contact.centre - foot) + in_space(bulge.first))
                 : contact.centroid;
  contact.area = area;
  contact.volume = max(0, volume);
}

SlopeMoments bulge_slope(const Primitives& hand, const Primitive& tile, const BorderCut& cut, Vec3 a, Vec3 b,
                         Vec3 c) {
  SlopeMoments slope;
  Section section;
  Vec3 n;
  if (!cut.crosses || !normal_of(a, b, c, n) || !look_along(tile, a, n, b - a, section)) return {};
  const std::size_t phalanx = cut.outer ? tile.segment : tile.segment - 1u;
  const Rival rival = joint_rival(section, hand, phalanx, cut.outer);
  const Chord chord = chord_of(section, hand.border[phalanx].centre, cut);
  return integrate_bulge_slope(section, rival, hand.border[phalanx], chord, slope) ? slope : SlopeMoments{};
}

}  // namespace lumbrical
