#include "lanes/round_batch.h"

#include <cmath>
#include <utility>

#include "lanes/lane_vectors.h"

namespace lumbrical {
namespace {

// Single precision is tried from this tolerance: below it only regions of half the section would do.
constexpr double kSingleFrom = 1e-3;

template <class T>
void write_contact(const RoundTerms<T>& pairs, Vec3 origin, std::size_t k, Contact& contact) {
  contact.area = pairs.area[k];
  contact.volume = pairs.volume[k];
  contact.depth = pairs.depth[k];
  contact.error = pairs.error[k];
  contact.normal = vector_at(pairs.normal, k);
  contact.centroid = origin + vector_at(pairs.centroid, k);
  contact.centre = origin + vector_at(pairs.centre, k);
}

template <class T>
void move_cuts(std::size_t from, std::size_t to, RoundTerms<T>& pairs) {
  for (int i = 0; i < pairs.cut_count; ++i) {
    for (auto& normal : pairs.cut_normal[i]) normal[to] = normal[from];
    pairs.cut_offset[i][to] = pairs.cut_offset[i][from];
  }
}

// Kernels compute whole registers: the last ones are filled with copies of a pair.
template <class T>
void pad(RoundTerms<T>& pairs) {
  for (std::size_t k = pairs.count; k % 16 != 0; ++k) {
    for (auto* corner : {pairs.a, pairs.b, pairs.c}) {
      for (std::size_t axis = 0; axis < 3; ++axis) corner[axis][k] = corner[axis][0];
    }
    move_cuts(0, k, pairs);
  }
}

void copy_to_single(const RoundTerms<double>& pairs, RoundTerms<float>& single) {
  const auto number = [](double value) { return static_cast<float>(value); };
  single.count = pairs.count;
  single.length = number(pairs.length);
  single.radius1 = number(pairs.radius1);
  single.radius2 = number(pairs.radius2);
  single.sine = number(pairs.sine);
  single.cosine = number(pairs.cosine);
  single.tolerance = number(pairs.tolerance);
  single.cut_count = pairs.cut_count;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    single.axis[axis] = number(pairs.axis[axis]);
    for (std::size_t k = 0; k < pairs.count; ++k) {
      single.a[axis][k] = number(pairs.a[axis][k]);
      single.b[axis][k] = number(pairs.b[axis][k]);
      single.c[axis][k] = number(pairs.c[axis][k]);
    }
  }
  for (int i = 0; i < pairs.cut_count; ++i) {
    for (std::size_t k = 0; k < pairs.count; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        single.cut_normal[i][axis][k] = number(pairs.cut_normal[i][axis][k]);
      single.cut_offset[i][k] = number(pairs.cut_offset[i][k]);
    }
  }
}

// Writes the contacts that single precision is good for and leaves the other pairs.
std::size_t finish_single(RoundBatch& batch) {
  RoundTerms<double>& pairs = batch.pairs;
  RoundTerms<float>& single = batch.single;
  copy_to_single(pairs, single);
  pad(single);
  batch.kernels.round_contacts_single(single);
  std::size_t left = 0, slivers = 0;
  for (std::size_t k = 0; k < pairs.count; ++k) {
    if (single.status[k] == static_cast<float>(kUnsure)) {
      for (auto* corner : {pairs.a, pairs.b, pairs.c}) {
        for (std::size_t axis = 0; axis < 3; ++axis) corner[axis][left] = corner[axis][k];
      }
      move_cuts(k, left, pairs);
      batch.contact[left++] = batch.contact[k];
      continue;
    }
    write_contact(single, batch.origin, k, *batch.contact[k]);
    if (single.status[k] == static_cast<float>(kSlivers)) batch.slivers[slivers++] = batch.contact[k];
  }
  pairs.count = left;
  return slivers;
}

}  // namespace

bool suits_batch(const Primitive& primitive) {
  return primitive.law == Law::field && primitive.shape == Shape::round && is_finite(primitive.radius1) &&
         is_finite(primitive.radius2);
}

RoundHull round_hull(const Primitive& primitive) {
  Vec3 end1 = primitive.end1, end2 = primitive.end2;
  double radius1 = primitive.radius1, radius2 = primitive.radius2;
  if (radius2 > radius1) {
    std::swap(end1, end2);
    std::swap(radius1, radius2);
  }
  double length = norm(end2 - end1);
  if (!(length > radius1 - radius2 && length > 1e-12 * radius1)) {
    length = 0;
    radius2 = radius1;
  }
  const Vec3 axis = length > 0 ? (end2 - end1) / length : Vec3{0, 0, 1};
  const double sine = length > 0 ? (radius1 - radius2) / length : 0;
  return {end1, axis, length, radius1, radius2, sine, std::sqrt((1 - sine) * (1 + sine))};
}

void begin_batch(const Primitive& primitive, double tolerance, RoundBatch& batch) {
  const RoundHull hull = round_hull(primitive);
  RoundTerms<double>& pairs = batch.pairs;
  batch.origin = hull.origin;
  pairs.count = 0;
  put_vector(hull.axis, pairs.axis);
  pairs.length = hull.length;
  pairs.radius1 = hull.radius1;
  pairs.radius2 = hull.radius2;
  pairs.sine = hull.sine;
  pairs.cosine = hull.cosine;
  pairs.tolerance = tolerance;
  pairs.cut_count = primitive.cut_count;
}

void add_to_batch(Vec3 a, Vec3 b, Vec3 c, const std::array<HalfSpace, 2>& cut, Contact& contact,
                  RoundBatch& batch) {
  const std::size_t k = batch.pairs.count++;
  put_vector(a - batch.origin, k, batch.pairs.a);
  put_vector(b - batch.origin, k, batch.pairs.b);
  put_vector(c - batch.origin, k, batch.pairs.c);
  for (int i = 0; i < batch.pairs.cut_count; ++i) {
    const HalfSpace& space = cut[static_cast<std::size_t>(i)];
    put_vector(space.normal, k, batch.pairs.cut_normal[i]);
    batch.pairs.cut_offset[i][k] = dot(space.normal, space.point - batch.origin) + space.offset;
  }
  batch.contact[k] = &contact;
}

RoundRest finish_batch(RoundBatch& batch) {
  RoundTerms<double>& pairs = batch.pairs;
  if (pairs.count == 0) return {};
  std::size_t slivers = pairs.tolerance >= kSingleFrom ? finish_single(batch) : 0, unsure = 0;
  pad(pairs);
  if (pairs.count > 0) batch.kernels.round_contacts(pairs);
  for (std::size_t k = 0; k < pairs.count; ++k) {
    Contact& contact = *batch.contact[k];
    const double status = pairs.status[k];
    contact.area = 0;
    if (status == kUnsure) batch.contact[unsure++] = &contact;
    if (status != kContact && status != kSlivers) continue;
    write_contact(pairs, batch.origin, k, contact);
    if (status == kSlivers) batch.slivers[slivers++] = &contact;
  }
  pairs.count = 0;
  return {{batch.slivers.data(), slivers}, {batch.contact.data(), unsure}};
}

}  // namespace lumbrical
