#include "lanes/round_batch.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lumbrical {
namespace {

void write_contact(const RoundTerms& pairs, Vec3 origin, std::size_t k, Contact& contact) {
  contact.area = pairs.area[k];
  contact.volume = pairs.volume[k];
  contact.depth = pairs.depth[k];
  contact.error = pairs.error[k];
  contact.normal = vector_at(pairs.normal, k);
  contact.centroid = origin + vector_at(pairs.centroid, k);
  contact.centre = origin + vector_at(pairs.centre, k);
}

// Every row of numbers that is handed to the kernel.
constexpr std::size_t kRows = 29;
std::array<double*, kRows> rows_of(RoundTerms& pairs) {
  std::array<double*, kRows> rows{pairs.length, pairs.radius1, pairs.radius2, pairs.sine, pairs.cosine};
  std::size_t count = 5;
  for (double* offset : pairs.cut_offset) rows[count++] = offset;
  for (auto* vector : {pairs.axis, pairs.a, pairs.b, pairs.c, pairs.cut_normal[0], pairs.cut_normal[1],
                       pairs.cut_normal[2]}) {
    for (std::size_t axis = 0; axis < 3; ++axis) rows[count++] = vector[axis];
  }
  return rows;
}

// Appends pair number k of the batch.
void queue_sliver(RoundTerms& pairs, std::size_t k, Vec3 origin, Contact* contact, SliverQueue& queue) {
  RoundTerms& queued = queue.terms.pairs;
  queued.cone = true;
  queued.cut_count = queued.count == 0 ? pairs.cut_count : std::max(queued.cut_count, pairs.cut_count);
  const std::size_t to = queued.count++;
  const auto rows = rows_of(pairs), queued_rows = rows_of(queued);
  for (std::size_t row = 0; row < kRows; ++row) queued_rows[row][to] = rows[row][k];
  queue.origin[to] = origin;
  queue.contact[to] = contact;
}

void pad(RoundTerms& pairs) {
  for (double* row : rows_of(pairs)) fill_up(row, pairs.count);
}

void add_sliver(const RoundTerms& pairs, std::size_t k, Vec3 origin, Contact& contact) {
  const double volume = contact.volume + pairs.volume[k];
  if (!(volume > 0)) return;
  const Vec3 moment = contact.volume * (contact.centre - origin) + vector_at(pairs.centre, k);
  contact.centre = origin + (1 / volume) * moment;
  contact.volume = volume;
}

// Computes what is queued. What takes more steps than allowed goes on to the queue of those.
void run_slivers(SliverBatch& batch, SliverQueue& queue) {
  RoundTerms& pairs = queue.terms.pairs;
  if (pairs.count == 0) return;
  pad(pairs);
  batch.kernels.cone_slivers(queue.terms);
  for (std::size_t k = 0; k < pairs.count; ++k) {
    if (pairs.status[k] == kContact) {
      add_sliver(pairs, k, queue.origin[k], *queue.contact[k]);
    } else if (queue.terms.patient) {
      batch.rest.push_back(queue.contact[k]);
    } else {
      if (batch.uneven.terms.pairs.count == RoundBatch::kCapacity) run_slivers(batch, batch.uneven);
      queue_sliver(pairs, k, queue.origin[k], queue.contact[k], batch.uneven);
    }
  }
  pairs.count = 0;
}

// Queues the pairs of the batch that lack their slivers. What is computed to make room is of former batches:
// a contact's sums must not depend on which pairs it shares a queue with.
void queue_slivers(std::span<const std::size_t> lacking, RoundBatch& batch, SliverBatch& slivers) {
  if (slivers.even.terms.pairs.count + lacking.size() > RoundBatch::kCapacity)
    run_slivers(slivers, slivers.even);
  for (const std::size_t k : lacking)
    queue_sliver(batch.pairs, k, batch.origin[k], batch.contact[k], slivers.even);
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
  RoundTerms& pairs = batch.pairs;
  if (pairs.count == 0) {
    pairs.sphere = hull.is_sphere();
    pairs.cone = hull.is_cone();
    pairs.cut_count = 0;
  }
  const std::size_t k = pairs.count++;
  batch.origin[k] = hull.origin;
  put_pair(hull, a, b, c, k, pairs);
  pairs.cut_count = std::max(pairs.cut_count, static_cast<int>(cuts.size()));
  for (std::size_t i = 0; i < RoundTerms::kMostCuts; ++i) {
    const HalfSpace space = i < cuts.size() ? cuts[i] : HalfSpace{};
    put_vector(space.normal, k, pairs.cut_normal[i]);
    pairs.cut_offset[i][k] = dot(space.normal, space.point - hull.origin) + space.offset;
  }
  batch.contact[k] = &contact;
}

std::span<Contact* const> finish_batch(RoundBatch& batch, SliverBatch& slivers) {
  RoundTerms& pairs = batch.pairs;
  slivers.rest.clear();
  if (pairs.count == 0) return {};
  pad(pairs);
  slivers.kernels.round_contacts(pairs);
  std::array<std::size_t, RoundBatch::kCapacity> lacking;
  std::size_t lacking_count = 0;
  for (std::size_t k = 0; k < pairs.count; ++k) {
    Contact& contact = *batch.contact[k];
    const double status = pairs.status[k];
    contact.area = 0;
    if (status == kUnsure) slivers.rest.push_back(&contact);
    if (status != kContact && status != kSlivers) continue;
    write_contact(pairs, batch.origin[k], k, contact);
    if (status == kSlivers) lacking[lacking_count++] = k;
  }
  queue_slivers(std::span(lacking).first(lacking_count), batch, slivers);
  pairs.count = 0;
  return {slivers.rest.begin(), slivers.rest.end()};
}

std::span<Contact* const> finish_slivers(SliverBatch& slivers) {
  slivers.rest.clear();
  run_slivers(slivers, slivers.even);
  run_slivers(slivers, slivers.uneven);
  return {slivers.rest.begin(), slivers.rest.end()};
}

}  // namespace lumbrical
