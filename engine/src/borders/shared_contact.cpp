// The part of the triangle's plane that may be the tile's is split until each part either belongs wholly to
// one tile or is run through once by one border. Of such a part the chord of the border cuts off what is the
// kin's, the rest goes the way of any polygon, and the bulge between chord and border is added.
#include "borders/shared_contact.h"

#include <array>
#include <cmath>

#include "base/fixed_list.h"
#include "borders/border_bulge.h"
#include "borders/joint_border.h"
#include "borders/tile_share.h"
#include "section/pressure.h"
#include "section/stated_errors.h"

namespace lumbrical {
namespace {

// Parts smaller than this share of the joint's radius are split no further where what is at stake is less
// than this share of its cube: there borders are their chords. Only where three tiles meet, where a border is
// singular, or where two tiles are all but in one place does it come to that.
constexpr double kLeast = 5e-3, kLeastStake = 1e-13;

// A border is split at its joint where that is not next to one of its ends, as a share of the chord.
constexpr double kBeside = 1e-3;

// Newton's steps towards the place where three tiles meet; the length of their differences, as a share of the
// part's reach; the cross product of two slopes below which they are parallel; and how close by that place a
// part is split, as a share of its own length.
constexpr int kMeetingSteps = 2;
constexpr double kSlopeStep = 1e-4, kParallel = 1e-3, kCloseBy = 3e-3;

// Parts a pair may take, the largest first. Where they don't suffice, as where two tiles are all but in one
// place, the volume of those that are left is in the contact's error.
constexpr std::size_t kMostParts = 128;

struct Work {
  Section& section;  // its polygon is the part at hand
  const ExactKernels& kernels;
  std::uint32_t kin_count = 0;
  std::array<Kin, 2> kin{};
  Kin others{};  // of two kin, the first against the second
  Bulge sum{};   // of all that is the tile's
};

// The innermost and the outermost phalanx; round a middle one of no length they have a joint in common.
Kin folded_kin(const Section& section, const Primitives& hand, std::size_t finger, bool is_first) {
  const Primitive &inner = hand.capsule[3 * finger], &outer = hand.capsule[3 * finger + 2];
  const bool same_joint =
      norm(inner.end2 - outer.end1) < 1e-8 * inner.radius2 && inner.radius2 == outer.radius1;
  return {cone_from(section, inner.end2, inner.end1, inner.radius2, inner.radius1),
          cone_from(section, outer.end1, outer.end2, outer.radius1, outer.radius2),
          same_joint,
          false,
          is_first,
          {}};
}

Point2 middle_of(const Polygon2& polygon) {
  Point2 sum{0, 0};
  for (std::size_t i = 0; i < polygon.count; ++i) sum = sum + polygon.corner[i];
  return (1.0 / polygon.count) * sum;
}

double reach_of(const Polygon2& polygon, Point2 middle) {
  double square = 0;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Point2 d = polygon.corner[i] - middle;
    square = max(square, dot(d, d));
  }
  return std::sqrt(square);
}

// The whole of the part at hand is the tile's, as far as it lies in the section; with kin only if its
// centroid there is the tile's.
void add_all(Work& work, const Kin* kin = nullptr) {
  Section& section = work.section;
  if (section.polygon.count < 3) return;
  const Overlap overlap = classify(section);
  if (overlap == Overlap::none) return;
  Boundary boundary;
  trace_boundary(section, boundary);
  const AreaMoments area = common_area(section, overlap, boundary);
  if (!(area.area > 0) || (kin != nullptr && !(precedence(*kin, area.centroid) > 0))) return;
  const PressureMoments field = field_moments(work.kernels, section, area, boundary);
  work.sum += {area.area, field.volume, area.area * area.centroid, field.first};
}

// How much volume it makes, about, whose the part is.
double stake_of(const Work& work, const Polygon2& polygon, Point2 middle, double reach) {
  double most = 0;
  for (std::size_t i = 0; i < work.kin_count; ++i) {
    const Kin& kin = work.kin[i];
    const auto include = [&](Point2 p) {
      const double gap =
          cone_field(kin.first, sight_of(kin.first, p)) - cone_field(kin.second, sight_of(kin.second, p));
      most = max(most, std::fabs(gap));
    };
    include(middle);
    for (std::size_t k = 0; k < polygon.count; ++k) include(polygon.corner[k]);
  }
  return most * reach * reach;
}

Chord chord_of(const Crossings& crossings) {
  // Once round counter-clockwise its kin's part lies to the right of the way from where the edge leaves the
  // tile to where it comes back.
  return crossings.leaving_first ? chord_between(crossings.at[0], crossings.at[1])
                                 : chord_between(crossings.at[1], crossings.at[0]);
}

// One border runs through the part at hand. False where the part has to be split to follow it.
bool add_crossed(const Kin& kin, const Crossings& crossings, Work& work) {
  Section& section = work.section;
  Chord chord = chord_of(crossings);
  const Course course = follow_border(section, kin, chord);
  if (course == Course::unclear) return false;
  if (course == Course::outside) {
    add_all(work, &kin);
    return true;
  }
  Bulge bulge;
  if (!integrate_bulge(work.kernels, section, kin, chord, bulge)) return false;
  cut_polygon(chord.across, dot(chord.across, chord.from), section.polygon);
  add_all(work);
  work.sum += bulge;
  return true;
}

// A part too small to be split: borders are their chords, and all else goes to whoever has its middle.
void add_least(Point2 middle, double reach, Work& work) {
  const Polygon2 whole = work.section.polygon;
  for (std::size_t i = 0; i < work.kin_count; ++i) {
    const Kin& kin = work.kin[i];
    Crossings crossings;
    const PartShare share = share_with(kin, whole, middle, reach, crossings);
    if (share == PartShare::crossed) {
      const Chord chord = chord_of(crossings);
      cut_polygon(chord.across, dot(chord.across, chord.from), work.section.polygon);
    } else if (share == PartShare::none || (share == PartShare::unclear && !(precedence(kin, middle) > 0))) {
      return;
    }
  }
  add_all(work);
}

// A straight line to split a part along: the points where dot(normal, p - point) = 0.
struct Split {
  Point2 point, normal;
};

// Across the longest diagonal.
Split split_across(const Polygon2& polygon, Point2 middle) {
  Split split{middle, {1, 0}};
  double square = 0;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const Point2 d = polygon.corner[i] - polygon.corner[k];
      if (dot(d, d) > square) {
        square = dot(d, d);
        split.normal = d;
      }
    }
  }
  return split;
}

// About where the borders with both kin meet; it may lie anywhere.
Point2 meeting_of(const std::array<Kin, 2>& kin, Point2 middle, double reach) {
  const double step = kSlopeStep * reach;
  Point2 p = middle;
  for (int i = 0; i < kMeetingSteps; ++i) {
    double value[2];
    Point2 slope[2];
    for (std::size_t k = 0; k < 2; ++k) {
      value[k] = precedence(kin[k], p);
      slope[k] = {(precedence(kin[k], {p.x + step, p.y}) - value[k]) / step,
                  (precedence(kin[k], {p.x, p.y + step}) - value[k]) / step};
    }
    const double area = cross(slope[0], slope[1]);
    if (!(std::fabs(area) > kParallel)) return middle;
    p.x -= (value[0] * slope[1].y - value[1] * slope[0].y) / area;
    p.y -= (value[1] * slope[0].x - value[0] * slope[1].x) / area;
  }
  return p;
}

// Where two kin compete only the surroundings of the place where all three meet have to become small:
// split close by it, on the side where there is more of the part.
Split split_by_meeting(const std::array<Kin, 2>& kin, const Polygon2& polygon, Point2 middle, double reach) {
  Split split = split_across(polygon, middle);
  const double length = std::sqrt(dot(split.normal, split.normal));
  const Point2 along = (1 / length) * split.normal, meeting = meeting_of(kin, middle, reach);
  double low = 1e300, high = -1e300;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const double at = dot(along, polygon.corner[i] - meeting);
    low = min(low, at);
    high = max(high, at);
  }
  if (low < 0 && high > 0) split.point = meeting + (high > -low ? 1 : -1) * kCloseBy * length * along;
  return split;
}

// A border too curved for its chord is split in its middle, or where the joint is next to it, for there it
// bends most; two of them at once along the strip between.
Split split_for(const Kin& kin, const Crossings& crossings, const Polygon2& polygon, Point2 middle) {
  const auto half = [&](std::size_t i, std::size_t k) { return 0.5 * (crossings.at[i] + crossings.at[k]); };
  const auto square = [&](std::size_t i, std::size_t k) {
    const Point2 d = crossings.at[i] - crossings.at[k];
    return dot(d, d);
  };
  Split split = split_across(polygon, middle);
  if (crossings.count == 2) {
    const Point2 chord = crossings.at[1] - crossings.at[0], joint{kin.first.joint.x, kin.first.joint.y};
    const double along = dot(joint - crossings.at[0], chord), length2 = dot(chord, chord);
    const bool beside = along > kBeside * length2 && along < (1 - kBeside) * length2;
    if (length2 > 0) split = {beside ? joint : half(0, 1), chord};
  } else if (crossings.count == 4) {
    // One side of a near border is convex, so its parts at the edges hang together and the strip is theirs.
    const bool mine_is_convex = (kin.border.side > 0) != kin.is_first;
    const bool ends = kin.near ? mine_is_convex != crossings.leaving_first
                               : square(0, 1) + square(2, 3) < square(1, 2) + square(3, 0);
    const Point2 from = ends ? half(0, 1) : half(1, 2), along = (ends ? half(2, 3) : half(3, 0)) - from;
    if (dot(along, along) > 0) split = {from, {along.y, -along.x}};
  }
  return split;
}

// A part of the triangle's plane that is still to be shared out.
struct Part {
  Polygon2 polygon;
  Point2 middle{0, 0};
  double reach = 0, stake = 0;  // [m]; [m^3]
  double volume = 0;            // [m^3] no more than this is lost where two tiles leave it to each other
  int level = 0;                // how often it was split
};
using Parts = FixedList<Part, kMostParts + 1>;

void open_part(const Polygon2& polygon, int level, const Work& work, Parts& open) {
  if (polygon.count < 3) return;
  const Point2 middle = middle_of(polygon);
  const double reach = reach_of(polygon, middle);
  const Cone& own = work.kin[0].own();
  const double most = max(0, cone_field(own, sight_of(own, middle)) + reach);
  open.push_back(
      {polygon, middle, reach, stake_of(work, polygon, middle, reach), most * reach * reach, level});
}

Part take_largest(Parts& open) {
  Part* largest = open.begin();
  for (Part& part : open) {
    if (part.volume > largest->volume) largest = &part;
  }
  const Part part = *largest;
  *largest = open.back();
  open.pop_back();
  return part;
}

// Adds what of a part is the tile's, or splits it.
void share_out(const Part& part, Work& work, Parts& open) {
  const auto& [polygon, middle, reach, stake, volume, level] = part;
  work.section.polygon = polygon;
  if (classify(work.section) == Overlap::none) return;
  std::array<PartShare, 2> share{PartShare::all, PartShare::all};
  std::array<Crossings, 2> crossings;
  for (std::size_t k = 0; k < work.kin_count; ++k) {
    share[k] = share_with(work.kin[k], polygon, middle, reach, crossings[k]);
    if (share[k] == PartShare::none) return;
  }
  if (share[0] != PartShare::all && share[1] != PartShare::all) {
    // Where one of two kin is ahead of the other everywhere, the other one doesn't count. Two kin with a
    // sphere in common may have the same border with this tile, so this must not be left to splitting.
    Crossings ignored;
    const PartShare ahead = share_with(work.others, polygon, middle, reach, ignored);
    if (ahead == PartShare::all) share[1] = PartShare::all;
    if (ahead == PartShare::none) share[0] = PartShare::all;
  }
  if (share[0] == PartShare::all && share[1] == PartShare::all) return add_all(work);
  const std::size_t k = share[0] == PartShare::all ? 1 : 0;
  const bool one_border = share[k] == PartShare::crossed && share[1 - k] == PartShare::all;
  if (one_border && add_crossed(work.kin[k], crossings[k], work)) return;
  const double radius = work.kin[0].first.radius;
  if (reach < kLeast * radius && stake < kLeastStake * radius * radius * radius) {
    work.section.polygon = polygon;
    return add_least(middle, reach, work);
  }
  // Parts too large to be understood, or with two kin, become smaller; those with one border flatter, but
  // every other time smaller as well.
  const bool flatter = one_border || (share[1 - k] == PartShare::all && crossings[k].count == 4 &&
                                      (work.kin[k].near || level % 2 == 0));
  const bool compete = share[0] != PartShare::all && share[1] != PartShare::all;
  const Split split = flatter   ? split_for(work.kin[k], crossings[k], polygon, middle)
                      : compete ? split_by_meeting(work.kin, polygon, middle, reach)
                                : split_across(polygon, middle);
  const double offset = dot(split.normal, split.point);
  Polygon2 one = polygon, other = polygon;
  cut_polygon(split.normal, offset, one);
  cut_polygon(-1.0 * split.normal, -offset, other);
  open_part(one, level + 1, work, open);
  open_part(other, level + 1, work, open);
}

void share_out_all(const Polygon2& polygon, Work& work) {
  Parts open;
  open_part(polygon, 0, work, open);
  for (std::size_t count = 0; !open.empty() && count < kMostParts; ++count)
    share_out(take_largest(open), work, open);
  for (const Part& part : open) {
    work.section.polygon = part.polygon;
    if (classify(work.section) == Overlap::none) continue;
    add_least(part.middle, part.reach, work);
    work.sum.error += part.volume;
  }
}

// What of the plane the tile can reach: far corners of a large triangle would only make borders long.
void cut_to_section(const Section& section, Polygon2& polygon) {
  const Interval extent = real_extent(section);
  cut_polygon({1, 0}, extent.second, polygon);
  cut_polygon({-1, 0}, -extent.first, polygon);
  cut_polygon({0, 1}, section.radius1, polygon);
  cut_polygon({0, -1}, section.radius1, polygon);
}

}  // namespace

bool collide_shared(const Primitives& hand, const Primitive& tile, const TileBorders& borders,
                    const ExactKernels& kernels, const Corners& at, Contact& contact) {
  const std::size_t phalanx = tile.segment, place = phalanx % 3;
  // Where a border is not its plane it still has to lie near it; the others' planes are exact.
  Primitive cut = tile;
  const auto widen = [&](std::size_t i) { cut.cut[i].offset += cut.overhang[i]; };
  if (borders.inner) widen(0);
  if (borders.outer) widen(tile.cut_count - 1u);
  Section section;
  if (!look_from_plane(cut, at, section)) return false;
  Work work{section, kernels};
  const auto add_kin = [&](const Kin& kin) { work.kin[work.kin_count++] = kin; };
  if (borders.inner) add_kin(joint_kin(section, hand, phalanx - 1, false));
  if (borders.outer) add_kin(joint_kin(section, hand, phalanx, true));
  if (borders.folded) add_kin(folded_kin(section, hand, phalanx / 3, place == 0));
  if (work.kin_count == 2) {
    // First the neighbour, then the one beyond it; of the middle phalanx the inner one, then the outer one.
    work.others = place == 0   ? joint_kin(section, hand, phalanx + 1, true)
                  : place == 1 ? folded_kin(section, hand, phalanx / 3, true)
                               : joint_kin(section, hand, phalanx - 2, false);
  }
  Polygon2 polygon = section.polygon;
  cut_to_section(section, polygon);
  const double extent = reach_of(polygon, middle_of(polygon));
  share_out_all(polygon, work);
  // Smaller than this an area is what rounding leaves of nothing.
  const Bulge& sum = work.sum;
  if (!(sum.area > 1e-14 * extent * min(extent, section.radius1))) return false;

  contact.area = sum.area;
  contact.volume = max(0, sum.volume);
  contact.centroid = to_world(section, (1 / sum.area) * sum.area_first);
  contact.centre = sum.volume > 0 ? to_world(section, (1 / sum.volume) * sum.first) : contact.centroid;
  contact.normal = section.n;
  contact.error = sum.error + kBoundaryError * section.radius1 * section.radius1 * section.radius1 +
                  plane_rounding(section.origin, at) * sum.area;
  return true;
}

}  // namespace lumbrical
