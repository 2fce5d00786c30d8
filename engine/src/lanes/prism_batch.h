// Pairs of the palm with triangles, gathered for the SIMD kernel (prism_contacts.h).
#pragma once

#include <array>
#include <span>

#include "lanes/field_kernels.h"
#include "lumbrical/contact.h"

namespace lumbrical {

/// Working memory of one thread.
struct PrismBatch {
  PrismBatch(const Prism& palm, const FieldKernels& table);
  const FieldKernels& kernels;
  Vec3 origin;  ///< [m] W, a point of the palmar face
  PrismTerms pairs;
  std::array<Contact*, PrismTerms::kCapacity> contact;  ///< of each pair
};

inline bool is_full(const PrismBatch& batch) { return batch.pairs.count == PrismTerms::kCapacity; }

/// Adds the pair with triangle a, b, c [m, W], whose contact is to be written when the batch is computed.
void add_to_batch(Vec3 a, Vec3 b, Vec3 c, Contact& contact, PrismBatch& batch);

/// Computes the contacts, but for their indices, and empties the batch. Those it leaves to `collide_prism`
/// are valid until the next call.
std::span<Contact* const> finish_batch(PrismBatch& batch);

}  // namespace lumbrical
