#include "lanes/prism_batch.h"

#include "lanes/lane_vectors.h"

namespace lumbrical {
PrismBatch::PrismBatch(const Prism& palm, const FieldKernels& table)
    : kernels(table), origin(palm.face[0].point) {
  pairs.face_count = palm.face_count;
  for (std::size_t i = 0; i < static_cast<std::size_t>(palm.face_count); ++i) {
    put_vector(palm.face[i].normal, pairs.normal[i]);
    pairs.offset[i] = dot(palm.face[i].normal, palm.face[i].point - origin);
  }
}

void add_to_batch(Vec3 a, Vec3 b, Vec3 c, Contact& contact, PrismBatch& batch) {
  const std::size_t k = batch.pairs.count++;
  put_vector(a - batch.origin, k, batch.pairs.a);
  put_vector(b - batch.origin, k, batch.pairs.b);
  put_vector(c - batch.origin, k, batch.pairs.c);
  batch.contact[k] = &contact;
}

std::span<Contact* const> finish_batch(PrismBatch& batch) {
  PrismTerms& pairs = batch.pairs;
  if (pairs.count == 0) return {};
  for (std::size_t k = pairs.count; k % 16 != 0; ++k) {
    for (auto* corner : {&pairs.a, &pairs.b, &pairs.c}) put_vector(vector_at(*corner, 0), k, *corner);
  }
  batch.kernels.prism_contacts(pairs);
  std::size_t left = 0;
  for (std::size_t k = 0; k < pairs.count; ++k) {
    Contact& contact = *batch.contact[k];
    if (pairs.simple[k] == 0) {
      batch.contact[left++] = &contact;
      continue;
    }
    contact.area = pairs.area[k];
    contact.volume = pairs.volume[k];
    contact.depth = pairs.depth[k];
    contact.error = 0;
    contact.normal = vector_at(pairs.direction, k);
    contact.centroid = batch.origin + vector_at(pairs.centroid, k);
    contact.centre = batch.origin + vector_at(pairs.centre, k);
  }
  pairs.count = 0;
  return {batch.contact.data(), left};
}

}  // namespace lumbrical
