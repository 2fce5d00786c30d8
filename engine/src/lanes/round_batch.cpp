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

// Appends pair number k of the batch.
void queue_sliver(RoundTerms<double>& pairs, std::size_t k, Vec3 origin, Contact* contact,
                  SliverQueue& queue) {
  RoundTerms<double>& queued = queue.terms.pairs;
  queued.cone = true;
  queued.cut_count = queued.count == 0 ? pairs.cut_count : std::max(queued.cut_count, pairs.cut_count);
  const std::size_t to = queued.count++;
  std::array<const double*, 25> from;
  std::size_t rows = 0, next = 0;
  for_rows(pairs, [&](const double* row) { from[rows++] = row + k; });
  for_rows(queued, [&](double* row) { row[to] = *from[next++]; });
  queue.origin[to] = origin;
  queue.contact[to] = contact;
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

void add_sliver(const RoundTerms<double>& pairs, std::size_t k, Vec3 origin, Contact& contact) {
  const double volume = contact.volume + pairs.volume[k];
  if (!(volume > 0)) return;
  const Vec3 moment = contact.volume * (contact.centre - origin) + vector_at(pairs.centre, k);
  contact.centre = origin + (1 / volume) * moment;
  contact.volume = volume;
}

// Computes what is queued. What takes more steps than allowed goes on to the queue of those.
void run_slivers(RoundBatch& batch, SliverQueue& queue) {
  RoundTerms<double>& pairs = queue.terms.pairs;
  if (pairs.count == 0) return;
  pad(pairs);
  batch.kernels.cone_slivers(queue.terms);
  for (std::size_t k = 0; k < pairs.count; ++k) {
    if (pairs.status[k] == kContact) {
      add_sliver(pairs, k, queue.origin[k], *queue.contact[k]);
    } else if (queue.terms.patient) {
      batch.rest[batch.rest_count++] = queue.contact[k];
    } else {
      if (batch.uneven.terms.pairs.count == RoundBatch::kCapacity) run_slivers(batch, batch.uneven);
      queue_sliver(pairs, k, queue.origin[k], queue.contact[k], batch.uneven);
    }
  }
  pairs.count = 0;
}

// Makes room for so many more slivers. Those that are computed for it are of former batches: a contact's sums
// must not depend on which pairs it shares a queue with.
void make_room(std::size_t more, RoundBatch& batch) {
  if (batch.slivers.terms.pairs.count + more > RoundBatch::kCapacity) run_slivers(batch, batch.slivers);
}

// Writes the contacts that single precision is good for and leaves the other pairs.
void finish_single(RoundBatch& batch) {
  RoundTerms<double>& pairs = batch.pairs;
  RoundTerms<float>& single = batch.single;
  copy_to_single(pairs, single);
  pad(single);
  batch.kernels.round_contacts_single(single);
  std::array<std::size_t, RoundBatch::kCapacity> unsure, lacking;
  std::size_t left = 0, slivers = 0;
  for (std::size_t k = 0; k < pairs.count; ++k) {
    if (single.status[k] == static_cast<float>(kUnsure)) {
      unsure[left++] = k;
      continue;
    }
    write_contact(single, batch.origin[k], k, *batch.contact[k]);
    if (single.status[k] == static_cast<float>(kSlivers)) lacking[slivers++] = k;
  }
  make_room(slivers + left, batch);
  for (std::size_t i = 0; i < slivers; ++i) {
    const std::size_t k = lacking[i];
    queue_sliver(pairs, k, batch.origin[k], batch.contact[k], batch.slivers);
  }
  for_rows(pairs, [&](double* row) {
    for (std::size_t k = 0; k < left; ++k) row[k] = row[unsure[k]];
  });
  for (std::size_t k = 0; k < left; ++k) {
    batch.contact[k] = batch.contact[unsure[k]];
    batch.origin[k] = batch.origin[unsure[k]];
  }
  pairs.count = left;
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

std::span<Contact* const> finish_batch(RoundBatch& batch) {
  RoundTerms<double>& pairs = batch.pairs;
  batch.rest_count = 0;
  if (pairs.count == 0) return {};
  if (pairs.tolerance >= kSingleFrom && !pairs.flat) finish_single(batch);
  pad(pairs);
  if (pairs.count > 0) batch.kernels.round_contacts(pairs);
  std::array<std::size_t, RoundBatch::kCapacity> lacking;
  std::size_t slivers = 0;
  for (std::size_t k = 0; k < pairs.count; ++k) {
    Contact& contact = *batch.contact[k];
    const double status = pairs.status[k];
    contact.area = 0;
    if (status == kUnsure) batch.rest[batch.rest_count++] = &contact;
    if (status != kContact && status != kSlivers) continue;
    write_contact(pairs, batch.origin[k], k, contact);
    if (status == kSlivers) lacking[slivers++] = k;
  }
  make_room(slivers, batch);
  for (std::size_t i = 0; i < slivers; ++i) {
    const std::size_t k = lacking[i];
    queue_sliver(pairs, k, batch.origin[k], batch.contact[k], batch.slivers);
  }
  pairs.count = 0;
  return std::span(batch.rest).first(batch.rest_count);
}

std::span<Contact* const> finish_slivers(RoundBatch& batch) {
  batch.rest_count = 0;
  run_slivers(batch, batch.slivers);
  run_slivers(batch, batch.uneven);
  return std::span(batch.rest).first(batch.rest_count);
}

}  // namespace lumbrical
