#include "stages/exact_overlaps.h"

#include <algorithm>
#include <cmath>

#define LUMBRICAL_ISA in_doubles
#include "borders/tile_rival.h"
#include "model/corners.h"
#include "samples/lattice.h"

namespace lumbrical {
namespace {

using in_doubles::Cell;

// Parts are halved both ways until that changes the integral by less than this share of R^3 and they are
// smaller than a share of R, another one where nothing was found yet; or until they are the last share of R.
constexpr double kTolerance = 1e-8, kLargest = 0.25, kLargestEmpty = 0.06, kLeast = 1e-3;

// [m] A lead that is more than rounding: where two bodies have a field in common, the first one has it.
constexpr double kTie = 1e-14;

// The palm's is the last.
std::size_t body_of(std::size_t segment) { return segment / 3; }

double palm_field(const SweptPolygon& palm, Vec3 p) {
  const double height = dot(palm.normal, p - palm.corner[0]);
  const Vec3 foot = p - height * palm.normal;
  double outside = -1e300, square = 1e300;
  for (std::size_t k = 0; k < static_cast<std::size_t>(palm.corner_count); ++k) {
    const Vec3 from = palm.corner[k],
               edge = palm.corner[(k + 1) % static_cast<std::size_t>(palm.corner_count)] - from;
    const double along = clamp(dot(foot - from, edge) / dot(edge, edge), 0, 1);
    const Vec3 beside = foot - (from + along * edge);
    outside = max(outside, dot(palm.outward[k], foot - from));
    square = min(square, dot(beside, beside));
  }
  return palm.radius - std::sqrt(height * height + (outside > 0 ? square : 0));
}

/// A triangle's plane, and the bodies that touch it.
struct Touched {
  const Primitives& hand;
  Section plane;  // of which only the axes are there
  std::array<Cone, kPhalanxCount> cone;
  std::uint32_t segments = 0;  // that touch it, a bit each

  [[nodiscard]] double field(std::size_t segment, Point2 p) const {
    if (segment != kPalmSegment) return cone_field(cone[segment], sight_of(cone[segment], p));
    return palm_field(hand.palm, plane.origin + p.x * plane.u + p.y * plane.v);
  }
  /// By how much the deepest of the other bodies that touch it is deeper than this one.
  [[nodiscard]] double lack(std::size_t body, Point2 p) const {
    double own = -1e300, others = -1e300;
    for (std::uint32_t left = segments; left != 0; left &= left - 1) {
      const auto segment = static_cast<std::size_t>(__builtin_ctz(left));
      const std::size_t its = body_of(segment);
      double& most = its == body ? own : others;
      most = max(most, field(segment, p) + (its < body ? kTie : its > body ? -kTie : 0));
    }
    return others - own;
  }
};

/// What a point is told by: the segment's field, by how much it is more the segment's than its neighbours' in
/// the finger, and by how much other bodies are deeper than its own.
struct Told {
  Point2 at;
  double own, lead, lack;
};

struct Sum {
  double volume = 0, error = 0;  // [m^3] integral of the field, and how much it still changed
  Point2 first{0, 0};            // [m^4]
};

class Overlap {
 public:
  Overlap(const Touched& touched, std::size_t segment) : touched_(touched), segment_(segment) {
    if (segment == kPalmSegment) return;
    const Primitives& hand = touched.hand;
    const auto add = [&](std::size_t inner, bool is_first) {
      if (hand.present[inner] && hand.present[inner + 1])
        rival_[count_++] = joint_rival(touched.plane, hand, inner, is_first);
    };
    if (segment % 3 > 0) add(segment - 1, false);
    if (segment % 3 < 2) add(segment, true);
  }
  [[nodiscard]] Told tell(Point2 p) const {
    const double own = touched_.field(segment_, p);
    double lead = 1e300;
    for (std::size_t k = 0; k < count_; ++k) lead = min(lead, precedence(rival_[k], p));
    if (segment_ != kPalmSegment && touched_.hand.folded[segment_ / 3] && segment_ % 3 != 1) {
      const std::size_t other = segment_ % 3 == 0 ? segment_ + 2 : segment_ - 2;
      if (touched_.hand.present[other]) lead = min(lead, own - touched_.field(other, p));
    }
    return {p, own, lead, touched_.lack(body_of(segment_), p)};
  }
  /// What others are deeper in, over a part of that area [m^2].
  void add(const Told& a, const Told& b, const Told& c, double area, double radius, Sum& sum) const {
    const Point2 middle = (1.0 / 3) * (a.at + b.at + c.at);
    const Told centre = tell(middle);
    const auto square = [&](const Told& corner) { return dot(corner.at - middle, corner.at - middle); };
    const double size = std::sqrt(max(square(a), max(square(b), square(c))));
    if (centre.own + size <= 0 || centre.lack + 2 * size <= 0) return;
    const Told ab = tell(0.5 * (a.at + b.at)), bc = tell(0.5 * (b.at + c.at)), ca = tell(0.5 * (c.at + a.at));
    Sum whole, parts;
    add_cell(a, b, c, centre.own, area, whole);
    add_cell(a, ab, ca, area / 4, parts);
    add_cell(b, bc, ab, area / 4, parts);
    add_cell(c, ca, bc, area / 4, parts);
    add_cell(ab, bc, ca, centre.own, area / 4, parts);
    const double change = std::fabs(parts.volume - whole.volume);
    if ((size < (parts.volume > 0 ? kLargest : kLargestEmpty) * radius &&
         change <= kTolerance * radius * radius * radius) ||
        size < kLeast * radius) {
      sum.volume += parts.volume;
      sum.first = sum.first + parts.first;
      sum.error += change;
      return;
    }
    add(a, ab, ca, area / 4, radius, sum);
    add(b, bc, ab, area / 4, radius, sum);
    add(c, ca, bc, area / 4, radius, sum);
    add(ab, bc, ca, area / 4, radius, sum);
  }

 private:
  void add_cell(const Told& a, const Told& b, const Told& c, double area, Sum& sum) const {
    const Point2 middle = (1.0 / 3) * (a.at + b.at + c.at);
    add_cell(a, b, c, touched_.field(segment_, middle), area, sum);
  }
  static void add_cell(const Told& a, const Told& b, const Told& c, double centre, double area, Sum& sum) {
    const double of_a = max(a.own, 0), of_b = max(b.own, 0), of_c = max(c.own, 0), all = of_a + of_b + of_c;
    const double lost = in_doubles::share_where_positive(a.lead, b.lead, c.lead, of_a, of_b, of_c, all) *
                        in_doubles::share_where_positive(a.lack, b.lack, c.lack, of_a, of_b, of_c, all) *
                        area;
    const Cell<double> cell = lost * in_doubles::cell_of(a.own, b.own, c.own, centre);
    const Point2 middle = (1.0 / 3) * (a.at + b.at + c.at);
    sum.volume += cell.mean;
    sum.first =
        sum.first + cell.mean * middle + (1.0 / 12) * (cell.to_b * (b.at - a.at) + cell.to_c * (c.at - a.at));
  }
  const Touched& touched_;
  std::size_t segment_, count_ = 0;
  std::array<Rival, 2> rival_;
};

bool touches_two_bodies(std::uint32_t segments) {
  const auto first = static_cast<std::size_t>(__builtin_ctz(segments));
  for (; segments != 0; segments &= segments - 1) {
    if (body_of(static_cast<std::size_t>(__builtin_ctz(segments))) != body_of(first)) return true;
  }
  return false;
}

void take_off(const Model& model, const Primitives& hand, std::uint32_t triangle, std::uint32_t segments,
              ExactOverlaps& overlaps) {
  const auto [a, b, c] = corners_of(model.triangles, triangle);
  Touched touched{hand, {}, {}, segments};
  Section& plane = touched.plane;
  if (!normal_of(a, b, c, plane.n)) return;
  plane.origin = a;
  plane.u = (1 / norm(b - a)) * (b - a);
  plane.v = cross(plane.n, plane.u);
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    if ((segments >> i & 1u) == 0) continue;
    const Primitive& phalanx = hand.capsule[i];
    touched.cone[i] = cone_from(plane, phalanx.end1, phalanx.end2, phalanx.radius1, phalanx.radius2);
  }
  const auto in_plane = [&](Vec3 p) {
    return Point2{dot(p - plane.origin, plane.u), dot(p - plane.origin, plane.v)};
  };
  const double area = 0.5 * norm(cross(b - a, c - a));
  for (std::uint32_t left = segments; left != 0; left &= left - 1) {
    const auto segment = static_cast<std::size_t>(__builtin_ctz(left));
    const double radius = segment == kPalmSegment ? hand.palm.radius : hand.capsule[segment].radius1;
    const Overlap overlap(touched, segment);
    Sum sum;
    overlap.add(overlap.tell(in_plane(a)), overlap.tell(in_plane(b)), overlap.tell(in_plane(c)), area, radius,
                sum);
    if (!(sum.volume > 0)) continue;
    const Point2 centre = (1 / sum.volume) * sum.first;
    const Vec3 at = a + centre.x * plane.u + centre.y * plane.v, force = -sum.volume * plane.n;
    overlaps.segment[segment].force += force;
    overlaps.segment[segment].torque += cross(at - hand.base_joint[segment], force);
    overlaps.error += sum.error;
  }
}

}  // namespace

void find_overlaps(const Model& model, const Primitives& hand, std::span<const Contact> contacts,
                   ExactOverlaps& overlaps) {
  overlaps.segment = {};
  overlaps.error = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i)
    overlaps.touched[i] =
        std::uint64_t{contacts[i].triangle} << 32 | hand.primitive[contacts[i].primitive].segment;
  const auto begin = overlaps.touched.begin(), end = begin + static_cast<std::ptrdiff_t>(contacts.size());
  std::sort(begin, end);
  for (auto next = begin; next != end;) {
    const auto triangle = static_cast<std::uint32_t>(*next >> 32);
    std::uint32_t segments = 0;
    for (; next != end && *next >> 32 == triangle; ++next) segments |= 1u << (*next & 31u);
    if (touches_two_bodies(segments)) take_off(model, hand, triangle, segments, overlaps);
  }
}

}  // namespace lumbrical
