#include "stages/exact_overlaps.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/set_bits.h"
#include "borders/tile_kin.h"
#include "model/corners.h"
#include "section/palm_polygon.h"
#include "section/quadratic_part.h"

namespace lumbrical {
namespace {

// Parts are halved both ways, needles along their length, until that changes the integral by less than this
// share of R^3, which leaves it off by an eighth of that, or a tenth of a segment's precision; and until
// their edges are below a share of R, another one where nothing was found yet; or until they are below the
// last share, whatever is still missing.
struct Until {
  double change, size, size_empty;
};
constexpr Until kUntil{1e-7, 0.25, 0.2};
constexpr double kLeast = 1e-3;

// A needle is more than so many times as long as it is wide.
constexpr double kNeedle = 8;

// Long needles are the sides of rods, which nearly cancel: what is left goes with the square of their width,
// so the share of R^3 does too, and is this for those as wide as R. Below a share of R nobody feels what is
// left. Needles shorter than another share are in all fine meshes, whose sides don't cancel so: time for
// nothing.
constexpr Until kUntilOfRod{1e-10, 0.1, 0.05};
constexpr double kThinnest = 1e-3, kRod = 0.5;

// [m] A lead that is more than rounding: where two bodies have a field in common, the first one has it.
constexpr double kTie = 1e-14;

// The number of a segment's finger, or, the last, the palm's.
std::size_t finger_or_palm_of(std::size_t segment) { return segment / 3; }

/// A triangle, and the bodies that touch it.
struct Touched {
  const Primitives& hand;
  const PalmPolygon& palm;
  std::uint32_t segments;  // that touch it, a bit each
  Corners corner;
  Section plane{};  // of which only origin and axes are there
  std::array<Cone, kPhalanxCount> cone{};

  [[nodiscard]] bool set_plane() {
    if (!normal_of(corner, plane.n)) return false;
    plane.origin = corner.a;
    const Vec3 edge = corner.b - corner.a;
    plane.u = (1 / norm(edge)) * edge;
    plane.v = cross(plane.n, plane.u);
    for (std::size_t i = 0; i < kPhalanxCount; ++i) {
      if (!has_bit(segments, i)) continue;
      const Primitive& phalanx = hand.capsule[i];
      cone[i] = cone_from(plane, phalanx.end1, phalanx.end2, phalanx.radius1, phalanx.radius2);
    }
    return true;
  }
  [[nodiscard]] Point2 in_plane(Vec3 p) const {
    const Vec3 at = to_plane(plane, p);
    return {at.x, at.y};
  }

  [[nodiscard]] double field(std::size_t segment, Point2 p) const {
    if (segment != kPalmSegment) return cone_field(cone[segment], sight_of(cone[segment], p));
    return palm.field(to_world(plane, p));
  }
  /// By how much the deepest of the other bodies that touch it is deeper than a segment's, which has the
  /// field `own` there.
  [[nodiscard]] double lack(std::size_t segment, double own, Point2 p) const {
    const std::size_t body = finger_or_palm_of(segment);
    double others = -1e300;
    for_numbers(segments & ~(1u << segment), [&](std::size_t other) {
      const double its = field(other, p);
      if (finger_or_palm_of(other) == body)
        own = max(own, its);
      else
        others = max(others, its + (other < segment ? kTie : -kTie));
    });
    return others - own;
  }
};

/// [m] Of a needle thinner and longer than that, or 0.
double rod_width(const Corners& corner, double most, double least_length) {
  const auto& [a, b, c] = corner;
  const double length = max(norm(b - a), max(norm(c - b), norm(a - c)));
  const double width = norm(cross(b - a, c - a)) / length;
  return width < most && length > max(kNeedle * width, least_length) ? width : 0;
}

/// What a point is told by: the segment's field, and by how much other bodies are deeper than its own.
struct Told {
  Point2 at;
  double own, lack;
};

class OverlapLoss {
 public:
  OverlapLoss(const Touched& touched, std::size_t segment, double precision)
      : touched_(touched), segment_(segment) {
    const Primitives& hand = touched.hand;
    radius_ = segment == kPalmSegment ? hand.palm.radius
                                      : max(hand.capsule[segment].radius1, hand.capsule[segment].radius2);
    tolerance_ = max(kUntil.change, 0.1 * precision) * radius_ * radius_ * radius_;
    if (const double width = rod_width(touched.corner, radius_, kRod * radius_); width > 0)
      take_for_rod(width);
    if (segment == kPalmSegment) return;
    const auto add = [&](std::size_t inner, bool is_first) {
      if (hand.present[inner] && hand.present[inner + 1])
        kin_[count_++] = joint_kin(touched.plane, hand, inner, is_first);
    };
    if (segment % 3 > 0) add(segment - 1, false);
    if (segment % 3 < 2) add(segment, true);
    if (segment % 3 == 1 || !hand.folded[segment / 3]) return;
    const std::size_t across = segment % 3 == 0 ? segment + 2 : segment - 2;
    if (has_bit(touched.segments, across)) across_ = across;
  }
  /// What others are deeper in; adds to `error` [m^3] by how much that still changed.
  PlaneMoments lost(double& error) const {
    const auto& [a, b, c] = touched_.corner;
    const Told of_a = tell(touched_.in_plane(a)), of_b = tell(touched_.in_plane(b)),
               of_c = tell(touched_.in_plane(c));
    const double area = 0.5 * norm(cross(b - a, c - a));
    const SixPoints<Told> told{
        of_a, of_b, of_c, between(of_b, of_c), between(of_c, of_a), between(of_a, of_b)};
    return halved(told, area, integral(told, area), error);
  }

 private:
  void take_for_rod(double width) {
    const double share = max(width / radius_, kThinnest);
    tolerance_ *= share * share * (kUntilOfRod.change / kUntil.change);
    until_ = kUntilOfRod;
  }
  [[nodiscard]] bool has_kin() const { return count_ > 0 || across_ < kPhalanxCount; }
  [[nodiscard]] Told tell(Point2 p) const {
    const double own = touched_.field(segment_, p);
    return {p, own, touched_.lack(segment_, own, p)};
  }
  /// By how much a point is more the segment's than its neighbours' in the finger.
  [[nodiscard]] double lead(const Told& told) const {
    double lead = 1e300;
    for (std::size_t k = 0; k < count_; ++k) lead = min(lead, precedence(kin_[k], told.at));
    if (across_ < kPhalanxCount) lead = min(lead, told.own - touched_.field(across_, told.at));
    return lead;
  }
  [[nodiscard]] Told between(const Told& a, const Told& b) const { return tell(0.5 * (a.at + b.at)); }

  [[nodiscard]] PlaneMoments integral(const SixPoints<Told>& told, double area) const {
    SixPoints<Point2> place;
    std::array<SixPoints<double>, 2> field;
    bool is_felt = false, is_lost = false;
    for (std::size_t k = 0; k < told.size(); ++k) {
      place[k] = told[k].at;
      field[0][k] = told[k].own;
      field[1][k] = told[k].lack;
      is_felt = is_felt || told[k].own > 0;
      is_lost = is_lost || told[k].lack > 0;
    }
    if (!is_felt || !is_lost) return {};
    if (!has_kin()) return integral_where_positive(place, area, field);
    SixPoints<double> leads;
    for (std::size_t k = 0; k < told.size(); ++k) leads[k] = lead(told[k]);
    return integral_where_positive(place, area, std::array{field[0], field[1], leads});
  }
  /// `reach` [m] from the nearest of its points, the triangle has nowhere anything to lose: fields change by
  /// no more than the distance, and what they differ by twice as fast.
  [[nodiscard]] static bool has_nothing(const SixPoints<Told>& told, double reach) {
    double own = -1e300, lack = -1e300;
    for (const Told& point : told) {
      own = max(own, point.own);
      lack = max(lack, point.lack);
    }
    return own + reach <= 0 || lack + 2 * reach <= 0;
  }
  PlaneMoments halved(const SixPoints<Told>& told, double area, const PlaneMoments& whole,
                      double& error) const {
    double square = 0;  // of the longest edge
    std::size_t longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point2 edge = told[(k + 1) % 3].at - told[k].at;
      if (dot(edge, edge) > square) longest = k;
      square = max(square, dot(edge, edge));
    }
    const double size = std::sqrt(square);
    // No point of a triangle is farther from its nearest corner than the longest edge over the root of 3.
    if (has_nothing(told, 0.289 * size)) return {};
    if (2 * kNeedle * area < square) return sum_of(halves_of(told, longest), area, whole, size, error);
    return sum_of(parts_of(told), area, whole, size, error);
  }
  template <std::size_t kCount>
  PlaneMoments sum_of(const std::array<SixPoints<Told>, kCount>& part, double area, const PlaneMoments& whole,
                      double size, double& error) const {
    std::array<PlaneMoments, kCount> of_part;
    PlaneMoments sum;
    for (std::size_t k = 0; k < kCount; ++k) add(of_part[k] = integral(part[k], area / kCount), sum);
    const double change = std::fabs(sum.volume - whole.volume);
    if ((size < (sum.volume > 0 ? until_.size : until_.size_empty) * radius_ && change <= tolerance_) ||
        size < kLeast * radius_) {
      error += change;
      return sum;
    }
    sum = {};
    for (std::size_t k = 0; k < kCount; ++k) add(halved(part[k], area / kCount, of_part[k], error), sum);
    return sum;
  }
  /// To either side of the middle of the edge from corner k.
  [[nodiscard]] std::array<SixPoints<Told>, 2> halves_of(const SixPoints<Told>& told, std::size_t k) const {
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    const Told& middle = told[3 + last];
    const Told across = between(middle, told[last]);
    return {{{told[k], middle, told[last], across, told[3 + next], between(told[k], middle)},
             {middle, told[next], told[last], told[3 + k], across, between(middle, told[next])}}};
  }
  /// At its corners, and between the middles of its edges.
  [[nodiscard]] std::array<SixPoints<Told>, 4> parts_of(const SixPoints<Told>& told) const {
    std::array<SixPoints<Told>, 4> part;
    for (std::size_t k = 0; k < 3; ++k) {
      const Told &corner = told[k], &to_next = told[3 + (k + 2) % 3], &to_last = told[3 + (k + 1) % 3];
      const Told inner = between(to_next, to_last);
      part[k] = {corner, to_next, to_last, inner, between(to_last, corner), between(corner, to_next)};
      part[3][k] = told[3 + k];
      part[3][3 + k] = inner;
    }
    return part;
  }
  static void add(const PlaneMoments& part, PlaneMoments& sum) {
    sum.volume += part.volume;
    sum.first = sum.first + part.first;
  }

  const Touched& touched_;
  std::size_t segment_, count_ = 0;
  std::size_t across_ = kPhalanxCount;  // the tile that a folded finger's first or last meets here
  double radius_, tolerance_;           // [m], [m^3]
  Until until_ = kUntil;
  std::array<Kin, 2> kin_;
};

bool touches_two_bodies(std::uint32_t segments) {
  const auto first = static_cast<std::size_t>(std::countr_zero(segments)),
             last = static_cast<std::size_t>(std::bit_width(segments)) - 1;
  return finger_or_palm_of(first) != finger_or_palm_of(last);
}

/// The contacts of a hand, and of some the indices, ascending, with their triangles: triangle << 32 | index.
struct Contacts {
  const Primitives& hand;
  std::span<Contact> all;

  [[nodiscard]] Contact& of(std::uint64_t index) const { return all[static_cast<std::uint32_t>(index)]; }
  [[nodiscard]] std::size_t segment(std::uint64_t index) const {
    return hand.primitive[of(index).primitive].segment;
  }
};
using Indices = std::span<const std::uint64_t>;

// Of one segment: the palm has several parts on a triangle, which share the loss by what they feel, and act
// in one place. Where next to nothing is left, rounding would put that anywhere.
void take_off(const Touched& touched, const PlaneMoments& lost, Indices own, const Contacts& contacts) {
  const Vec3 place = to_world(touched.plane, (1 / lost.volume) * lost.first);
  double volume = 0;
  Vec3 first;  // from where what is lost acts
  for (const std::uint64_t index : own) {
    volume += contacts.of(index).volume;
    first += contacts.of(index).volume * (contacts.of(index).centre - place);
  }
  const double left = max(0, volume - lost.volume);
  if (!(left > 0)) {
    for (const std::uint64_t index : own) contacts.of(index).volume = 0;
    return;
  }
  const Vec3 centre = last_within(touched.corner, place + (1 / volume) * first, place + (1 / left) * first);
  for (const std::uint64_t index : own) {
    contacts.of(index).centre = centre;
    contacts.of(index).volume *= left / volume;
  }
}

// Of all contacts with a triangle. Returns the segments that lose something.
std::uint32_t take_off(const Model& model, const Touched& touched, Indices indices,
                       const Contacts& contacts) {
  std::uint32_t leaving = 0;
  for (auto own = indices.begin(); own != indices.end();) {
    const std::size_t segment = contacts.segment(*own);
    const auto next = std::find_if(own, indices.end(),
                                   [&](std::uint64_t other) { return contacts.segment(other) != segment; });
    const OverlapLoss overlap(touched, segment, model.settings.precision[segment]);
    const PlaneMoments lost = overlap.lost(contacts.of(*own).error);
    if (lost.volume > 0) {
      take_off(touched, lost, {own, next}, contacts);
      leaving |= 1u << segment;
    }
    own = next;
  }
  return leaving;
}

}  // namespace

std::uint32_t take_off_overlaps(const Model& model, const Primitives& hand, std::uint32_t segments,
                                std::span<Contact> found, std::span<std::uint64_t> room) {
  const Contacts contacts{hand, found};
  std::size_t count = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (has_bit(segments, contacts.segment(i))) room[count++] = std::uint64_t{found[i].triangle} << 32 | i;
  }
  if (count == 0) return 0;
  const auto touching = room.first(count);
  std::sort(touching.begin(), touching.end());
  const PalmPolygon palm(hand.palm);
  std::uint32_t leaving = 0;
  for (auto begin = touching.begin(); begin != touching.end();) {
    const auto triangle = static_cast<std::uint32_t>(*begin >> 32);
    const auto end =
        std::find_if(begin, touching.end(), [&](std::uint64_t other) { return other >> 32 != triangle; });
    std::uint32_t by = 0;
    for (auto one = begin; one != end; ++one) by |= 1u << contacts.segment(*one);
    if (touches_two_bodies(by)) {
      Touched touched{hand, palm, by, corners_of(model.triangles, triangle)};
      if (touched.set_plane()) leaving |= take_off(model, touched, {begin, end}, contacts);
    }
    begin = end;
  }
  return leaving;
}

}  // namespace lumbrical
