// Pairs of the palm with triangles, gathered for the SIMD kernels (prism_contacts.h, prism_rim.h).
#pragma once

#include <array>
#include <span>

#include "lanes/field_kernels.h"
#include "lumbrical/contact.h"
#include "model/corners.h"

namespace lumbrical {

/// Working memory of one thread.
struct PrismBatch {
  PrismBatch(const Prism& palm, const FieldKernels& table);
  const FieldKernels& kernels;
  Vec3 origin;  ///< [m] W, a point of the palmar face
  PrismTerms pairs;
  RimTerms rims;
  std::array<Contact*, PrismTerms::kCapacity> contact;  ///< of each pair
  std::array<Contact*, PrismTerms::kCapacity> left;     ///< to `collide_prism`
};

inline bool is_full(const PrismBatch& batch) { return batch.pairs.count == PrismTerms::kCapacity; }

/// Adds the pair with the triangle of these corners [m, W], whose contact is to be written when the batch is
/// computed.
void add_to_batch(const Corners& at, Contact& contact, PrismBatch& batch);

/// Computes the contacts, but for their indices, and empties the batch; an area of zero marks that there is
/// none. Those it leaves to `collide_prism` are valid until the next call.
std::span<Contact* const> finish_batch(PrismBatch& batch);

}  // namespace lumbrical
