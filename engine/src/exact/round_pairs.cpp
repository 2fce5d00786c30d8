#include "exact/round_pairs.h"

#include <cmath>
#include <utility>

namespace lumbrical {
namespace {

// The least the cosine of the axis' angle to the normal may exceed the sine of the cone's half angle by, as a
// share of that angle's cosine, for the side's rim to be taken for an ellipse in all places (kMostStretch).
constexpr double kSteep = 1.0 / 30;

constexpr double kFar = 1e300;  // [m] a sphere is its first end

}  // namespace

bool suits_lanes(const Primitive& primitive) {
  return (primitive.law == Law::field || follows_paper(primitive)) && primitive.shape == Shape::round &&
         is_finite(primitive.radius1) && is_finite(primitive.radius2);
}

CutPlane seen_from(Vec3 origin, const HalfSpace& space) {
  return {space.normal, dot(space.normal, space.point - origin) + space.offset};
}

RoundHull round_hull(const Primitive& primitive) {
  Vec3 end1 = primitive.end1, end2 = primitive.end2;
  double radius1 = primitive.radius1, radius2 = primitive.radius2;
  if (radius2 > radius1) {
    std::swap(end1, end2);
    std::swap(radius1, radius2);
  }
  double length = norm(end2 - end1);
  if (!has_two_ends(length, radius1, radius2)) {
    length = 0;
    radius2 = radius1;
  }
  const Vec3 axis = length > 0 ? (end2 - end1) / length : Vec3{0, 0, 1};
  const double sine = length > 0 ? (radius1 - radius2) / length : 0;
  const double cosine = std::sqrt((1 - sine) * (1 + sine));
  RoundHull hull{end1, axis, length, radius1, radius2, sine, cosine, primitive.cut_count, {}};
  for (std::size_t i = 0; i < primitive.cut_count; ++i) hull.cut[i] = seen_from(end1, primitive.cut[i]);
  return hull;
}

void set_hull(const RoundHull& hull, KindTerms& terms) {
  put_vector(hull.axis, terms.axis);
  terms.first = hull.is_sphere() ? kFar : hull.sine * hull.radius1;
  terms.second = hull.is_sphere() ? kFar : hull.length + hull.sine * hull.radius2;
  terms.flat = hull.is_sphere() ? 0 : hull.is_cone() ? kFlatCosineCone : kFlatCosine;
  terms.slanted = hull.sine + kSteep * hull.cosine;
  terms.radius1 = hull.radius1;
  terms.sine = hull.sine;
  terms.cosine = hull.cosine;
}

RoundKind kind_of(const ExactKernels& kernels, const RoundHull& hull, const Corners& at) {
  KindTerms terms;
  set_hull(hull, terms);
  put_corners(at, 0, terms);
  terms.count = 1;
  terms.for_each_row([](double* row) { fill_up(row, 1); });
  kernels.pair_kinds(terms);
  return {hull.is_sphere(), hull.is_cone(), static_cast<RoundZone>(terms.zone[0])};
}

void set_kind(RoundKind kind, int cut_count, RoundTerms& terms) {
  terms.cut_count = cut_count;
  terms.sphere = kind.sphere;
  terms.cone = kind.cone;
  terms.flat = kind.zone == RoundZone::flat;
}

void add_sliver(const RoundTerms& terms, std::size_t k, Vec3 origin, Contact& contact) {
  const double volume = contact.volume + terms.volume[k];
  if (!(volume > 0)) return;
  const Vec3 moment = contact.volume * (contact.centre - origin) + vector_at(terms.centre, k);
  contact.centre = origin + (1 / volume) * moment;
  contact.volume = volume;
}

}  // namespace lumbrical
