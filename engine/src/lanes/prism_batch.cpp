#include "lanes/prism_batch.h"

namespace lumbrical {
namespace {

using Corner = double[3][PrismTerms::kCapacity];

void set_corner(Vec3 p, std::size_t k, Corner& corner) {
  corner[0][k] = p.x;
  corner[1][k] = p.y;
  corner[2][k] = p.z;
}

Vec3 point_of(const Corner& from, std::size_t k) { return {from[0][k], from[1][k], from[2][k]}; }

}  // namespace

PrismBatch::PrismBatch(const Prism& palm, const FieldKernels& table)
    : kernels(table), origin(palm.face[0].point) {
  pairs.face_count = palm.face_count;
  for (std::size_t i = 0; i < static_cast<std::size_t>(palm.face_count); ++i) {
    const Vec3 n = palm.face[i].normal;
    pairs.normal[i][0] = n.x;
    pairs.normal[i][1] = n.y;
    pairs.normal[i][2] = n.z;
    pairs.offset[i] = dot(n, palm.face[i].point - origin);
  }
}

void add_to_batch(Vec3 a, Vec3 b, Vec3 c, Contact& contact, PrismBatch& batch) {
  const std::size_t k = batch.pairs.count++;
  set_corner(a - batch.origin, k, batch.pairs.a);
  set_corner(b - batch.origin, k, batch.pairs.b);
  set_corner(c - batch.origin, k, batch.pairs.c);
  batch.contact[k] = &contact;
}

std::span<Contact* const> finish_batch(PrismBatch& batch) {
  PrismTerms& pairs = batch.pairs;
  if (pairs.count == 0) return {};
  for (std::size_t k = pairs.count; k % 16 != 0; ++k) {
    for (Corner* corner : {&pairs.a, &pairs.b, &pairs.c}) set_corner(point_of(*corner, 0), k, *corner);
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
    contact.normal = point_of(pairs.direction, k);
    contact.centroid = batch.origin + point_of(pairs.centroid, k);
    contact.centre = batch.origin + point_of(pairs.centre, k);
  }
  pairs.count = 0;
  return {batch.contact.data(), left};
}

}  // namespace lumbrical
