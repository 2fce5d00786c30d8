// A tile's share of a part: the edges are searched for borders; where they show none, the shape of the border
// or that of the fields tells that there is none inside either.
#include "borders/tile_share.h"

#include <cmath>

#include "borders/root.h"

namespace lumbrical {
namespace {

// Edges are searched for borders in steps of this share of the joint's radius.
constexpr double kShareStep = 0.25;

// Roots along an edge, as shares of it: what a chord's end misses the border by counts squared.
constexpr double kEdgeRoot = 1e-12;

// So near its joint, as a share of its radius, a border may be crossed by rounding alone.
constexpr double kTouch = 1e-8;

// A part through which a border runs that is more than a cone's (JointBorder::near) is no larger than this.
constexpr double kSmall = 0.6;

// An edge p + t d and what is found along it.
struct Edge {
  const Kin& kin;
  Point2 p, d;
  double length;
  Crossings& crossings;
  [[nodiscard]] double at(double t) const { return precedence(kin, p + t * d); }
};

void add_root(const Edge& edge, double t0, double f0, double t1, double f1) {
  Crossings& crossings = edge.crossings;
  if (crossings.count == Crossings::kMaxCount) return;
  const double t = find_root([&](double at) { return edge.at(at); }, t0, f0, t1, f1, kEdgeRoot);
  if (crossings.count == 0) crossings.leaving_first = f0 > 0;
  crossings.at[crossings.count++] = edge.p + t * edge.d;
}

// Both ends of t0..t1 belong to the same tile. May the other one have something in between? Then precedence
// has a dip there; as long as it is convex it lies above its tangents at both ends, and where these meet
// either is in the dip or parts it into smaller ones.
void find_dip(const Edge& edge, double t0, double f0, double t1, double f1, int level) {
  const double width = t1 - t0, sign = f0 > 0 ? 1 : -1;
  if (level > 30 || sign * (f0 + f1) > kPrecedenceSlope * edge.length * width) return;
  const double step = 1e-4 * width;
  const double slope0 = sign * (edge.at(t0 + step) - f0) / step,
               slope1 = sign * (f1 - edge.at(t1 - step)) / step;
  if (!(slope0 < 0 && slope1 > 0)) return;
  const double offset = (sign * (f1 - f0) - slope1 * width) / (slope0 - slope1);
  if (!(offset > 1e-3 * width && offset < 0.999 * width) || sign * f0 + slope0 * offset > 0) return;
  const double t = t0 + offset, f = edge.at(t);
  if ((f > 0) == (f0 > 0)) {
    find_dip(edge, t0, f0, t, f, level + 1);
    find_dip(edge, t, f, t1, f1, level + 1);
  } else {
    add_root(edge, t0, f0, t, f);
    add_root(edge, t, f, t1, f1);
  }
}

// A line crosses a cone at the roots of a quadratic a t^2 + 2 b t + c: half way between them.
double middle_of_crossings(const BorderCone& cone, Point2 p, Point2 d) {
  const auto product = [&](const Linear& linear, double& a, double& b, double sign) {
    const double slope = dot(linear.slope, d);
    a += sign * slope * slope;
    b += sign * slope * linear.at(p);
  };
  double a = 0, b = 0;
  product(cone.x, a, b, 1);
  product(cone.y, a, b, 1);
  product(cone.height, a, b, -1);
  return a != 0 ? -b / a : -1;
}

void cross_edge(const Kin& kin, Point2 p, Point2 q, double at_p, double at_q, Crossings& crossings) {
  const Point2 d = q - p;
  const Edge edge{kin, p, d, std::sqrt(dot(d, d)), crossings};
  const bool same = (at_p > 0) == (at_q > 0);
  if (same && std::fabs(at_p) + std::fabs(at_q) > kPrecedenceSlope * edge.length) return;
  if (kin.near) {
    // Looked at even where only one crossing shows: if both ends lie on the border, rounding tells which.
    const double t = middle_of_crossings(kin.border, p, d);
    if (!(t > 0 && t < 1)) {
      if (!same) add_root(edge, 0, at_p, 1, at_q);
      return;
    }
    const double f = edge.at(t);
    if ((f > 0) != (at_p > 0)) add_root(edge, 0, at_p, t, f);
    if ((f > 0) != (at_q > 0)) add_root(edge, t, f, 1, at_q);
    return;
  }
  const double wanted = edge.length / (kShareStep * kin.first.radius);
  const int steps = wanted < 1 ? 2 : wanted < 31 ? static_cast<int>(wanted) + 1 : 32;
  double t0 = 0, f0 = at_p;
  for (int i = 1; i <= steps; ++i) {
    const double t1 = 1.0 * i / steps, f1 = i == steps ? at_q : edge.at(t1);
    if ((f0 > 0) == (f1 > 0)) {
      find_dip(edge, t0, f0, t1, f1, 0);
    } else {
      add_root(edge, t0, f0, t1, f1);
    }
    t0 = t1;
    f0 = f1;
  }
}

// Can the far end of neither tile have a part in their border over this part of the plane?
bool is_near(const Kin& kin, Point2 middle, double reach) {
  if (kin.near) return true;
  if (!kin.joined || kin.first.kind != Cone::hull || kin.second.kind != Cone::hull) return false;
  for (const Cone* cone : {&kin.first, &kin.second}) {
    if (sight_of(*cone, middle).along + reach > cone->cosine * cone->length) return false;
  }
  return true;
}

// The plane cuts the border's cone in one curve, which may close; then the axis of one of the tiles pierces
// the plane inside it.
bool has_island(const Kin& kin, const Polygon2& polygon, bool mine) {
  for (const Cone* cone : {&kin.first, &kin.second}) {
    if (!(cone->axis.z * cone->joint.z < 0)) continue;
    const double t = -cone->joint.z / cone->axis.z;
    const Point2 p{cone->joint.x + t * cone->axis.x, cone->joint.y + t * cone->axis.y};
    if (holds(polygon, cone->radius, p) && (precedence(kin, p) > 0) != mine) return true;
  }
  return false;
}

// Both fields are concave: the lower one lies below its tangent plane, the higher one over what its values at
// the corners span. So one look at each corner can tell that a part is wholly one tile's.
bool is_higher(const Cone& higher, const Cone& lower, const Polygon2& polygon, Point2 middle) {
  const Sight sight = sight_of(lower, middle);
  const double value = cone_field(lower, sight);
  const Point2 slope = cone_slope(lower, sight);
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Point2 p = polygon.corner[i];
    if (!(cone_field(higher, sight_of(higher, p)) > value + dot(slope, p - middle))) return false;
  }
  return true;
}

// Takes out crossings at the joint, two by two: an edge through a joint in the plane only touches the border
// there, and rounding makes two crossings of that, whose chord has no direction.
void remove_touches(const Kin& kin, Crossings& crossings) {
  const auto at_joint = [&](std::size_t i) {
    const Point2 d = crossings.at[i] - Point2{kin.first.joint.x, kin.first.joint.y};
    return dot(d, d) < kTouch * kTouch * kin.first.radius * kin.first.radius;
  };
  for (std::size_t i = 0; i + 1 < crossings.count; ++i) {
    if (!at_joint(i) || !at_joint(i + 1)) continue;
    for (std::size_t k = i + 2; k < crossings.count; ++k) crossings.at[k - 2] = crossings.at[k];
    crossings.count -= 2;
    return;
  }
  if (crossings.count < 2 || !at_joint(0) || !at_joint(crossings.count - 1)) return;
  for (std::size_t k = 1; k + 1 < crossings.count; ++k) crossings.at[k - 1] = crossings.at[k];
  crossings.count -= 2;
  crossings.leaving_first = !crossings.leaving_first;
}

// The value of the largest magnitude.
double farthest(const std::array<double, Polygon2::kMaxCorners>& value, std::size_t count) {
  double most = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double here = value[i];
    if (std::fabs(here) > std::fabs(most)) most = here;
  }
  return most;
}

}  // namespace

PartShare share_with(const Kin& kin, const Polygon2& polygon, Point2 middle, double reach,
                     Crossings& crossings) {
  const double here = precedence(kin, middle);
  if (std::fabs(here) > kPrecedenceSlope * reach) return here > 0 ? PartShare::all : PartShare::none;
  std::array<double, Polygon2::kMaxCorners> value;
  for (std::size_t i = 0; i < polygon.count; ++i) value[i] = precedence(kin, polygon.corner[i]);
  // What the fields alone tell spares the edges' search.
  if (!kin.near && is_higher(kin.own(), kin.other(), polygon, middle)) return PartShare::all;
  if (!kin.near && is_higher(kin.other(), kin.own(), polygon, middle)) return PartShare::none;
  for (std::size_t k = 0; k < polygon.count; ++k) {
    const std::size_t next = k + 1 == polygon.count ? 0 : k + 1;
    cross_edge(kin, polygon.corner[k], polygon.corner[next], value[k], value[next], crossings);
  }
  const bool near = is_near(kin, middle, reach);
  remove_touches(kin, crossings);
  if (crossings.count == 2) {
    return near || reach < kSmall * kin.first.radius ? PartShare::crossed : PartShare::unclear;
  }
  if (crossings.count > 0) return PartShare::unclear;
  const bool mine = farthest(value, polygon.count) > 0;
  if (!near || has_island(kin, polygon, mine)) return PartShare::unclear;
  return mine ? PartShare::all : PartShare::none;
}

}  // namespace lumbrical
