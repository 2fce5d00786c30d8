#include "lanes/round_batch.h"

#include <algorithm>
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

// Calls f with every row of numbers that is handed to the kernel.
template <class T, class F>
void for_rows(RoundTerms<T>& pairs, F&& f) {
  for (auto* vector : {pairs.axis, pairs.a, pairs.b, pairs.c, pairs.cut_normal[0], pairs.cut_normal[1]}) {
    for (std::size_t axis = 0; axis < 3; ++axis) f(vector[axis]);
  }
  for (T* row : {pairs.length, pairs.radius1, pairs.radius2, pairs.sine, pairs.cosine, pairs.cut_offset[0],
                 pairs.cut_offset[1]}) {
    f(row);
  }
}

// Kernels compute whole registers: the last ones are filled with copies of a pair.
template <class T>
void pad(RoundTerms<T>& pairs) {
  for_rows(pairs, [&](T* row) {
    for (std::size_t k = pairs.count; k % 16 != 0; ++k) row[k] = row[0];
  });
}

void copy_to_single(RoundTerms<double>& pairs, RoundTerms<float>& single) {
  single.count = pairs.count;
  single.sphere = pairs.sphere;
  single.cone = pairs.cone;
  single.tolerance = static_cast<float>(pairs.tolerance);
  single.cut_count = pairs.cut_count;
  std::array<double*, 25> from;
  std::size_t rows = 0, next = 0;
  for_rows(pairs, [&](double* row) { from[rows++] = row; });
  for_rows(single, [&](float* row) {
    for (std::size_t k = 0; k < pairs.count; ++k) row[k] = static_cast<float>(from[next][k]);
    ++next;
  });
}

// Writes the contacts that single precision is good for and leaves the other pairs.
std::size_t finish_single(RoundBatch& batch) {
  RoundTerms<double>& pairs = batch.pairs;
  RoundTerms<float>& single = batch.single;
  copy_to_single(pairs, single);
  pad(single);
  batch.kernels.round_contacts_single(single);
  std::array<std::size_t, RoundTerms<double>::kCapacity> unsure;
  std::size_t left = 0, slivers = 0;
  for (std::size_t k = 0; k < pairs.count; ++k) {
    if (single.status[k] == static_cast<float>(kUnsure)) {
      unsure[left++] = k;
      continue;
    }
    write_contact(single, batch.origin[k], k, *batch.contact[k]);
    if (single.status[k] == static_cast<float>(kSlivers)) batch.slivers[slivers++] = batch.contact[k];
  }
  for_rows(pairs, [&](double* row) {
    for (std::size_t k = 0; k < left; ++k) row[k] = row[unsure[k]];
  });
  for (std::size_t k = 0; k < left; ++k) {
    batch.contact[k] = batch.contact[unsure[k]];
    batch.origin[k] = batch.origin[unsure[k]];
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

void add_to_batch(const RoundHull& hull, Vec3 a, Vec3 b, Vec3 c, std::span<const HalfSpace> cuts,
                  Contact& contact, RoundBatch& batch) {
  RoundTerms<double>& pairs = batch.pairs;
  if (pairs.count == 0) {
    pairs.sphere = hull.is_sphere();
    pairs.cone = hull.is_cone();
    pairs.cut_count = 0;
  }
  const std::size_t k = pairs.count++;
  batch.origin[k] = hull.origin;
  put_vector(hull.axis, k, pairs.axis);
  pairs.length[k] = hull.length;
  pairs.radius1[k] = hull.radius1;
  pairs.radius2[k] = hull.radius2;
  pairs.sine[k] = hull.sine;
  pairs.cosine[k] = hull.cosine;
  put_vector(a - hull.origin, k, pairs.a);
  put_vector(b - hull.origin, k, pairs.b);
  put_vector(c - hull.origin, k, pairs.c);
  pairs.cut_count = std::max(pairs.cut_count, static_cast<int>(cuts.size()));
  for (std::size_t i = 0; i < 2; ++i) {
    const HalfSpace space = i < cuts.size() ? cuts[i] : HalfSpace{};
    put_vector(space.normal, k, pairs.cut_normal[i]);
    pairs.cut_offset[i][k] = dot(space.normal, space.point - hull.origin) + space.offset;
  }
  batch.contact[k] = &contact;
}

RoundRest finish_batch(RoundBatch& batch) {
  RoundTerms<double>& pairs = batch.pairs;
  if (pairs.count == 0) return {};
  const bool single = pairs.tolerance >= kSingleFrom && !pairs.flat;
  std::size_t slivers = single ? finish_single(batch) : 0, unsure = 0;
  pad(pairs);
  if (pairs.count > 0) batch.kernels.round_contacts(pairs);
  for (std::size_t k = 0; k < pairs.count; ++k) {
    Contact& contact = *batch.contact[k];
    const double status = pairs.status[k];
    contact.area = 0;
    if (status == kUnsure) batch.contact[unsure++] = &contact;
    if (status != kContact && status != kSlivers) continue;
    write_contact(pairs, batch.origin[k], k, contact);
    if (status == kSlivers) batch.slivers[slivers++] = &contact;
  }
  pairs.count = 0;
  return {{batch.slivers.data(), slivers}, {batch.contact.data(), unsure}};
}

}  // namespace lumbrical
