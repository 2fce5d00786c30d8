// Pairs of a slab of the palm with triangles, gathered for the SIMD kernels (slab_contacts.h, slab_rims.h).
#pragma once

#include <array>
#include <span>

#include "lanes/field_kernels.h"
#include "lumbrical/contact.h"
#include "model/corners.h"

namespace lumbrical {

/// Working memory of one thread.
struct SlabBatch {
  explicit SlabBatch(const FieldKernels& table) : kernels(table) {}
  const FieldKernels& kernels;
  Vec3
      origin;  ///< [m] W, a point of the core: the same for both slabs, so that they share it to the last bit
  SlabTerms pairs;
  RimTerms rims;
  std::array<Contact*, SlabTerms::kCapacity> contact;  ///< of each pair
  std::array<Contact*, SlabTerms::kCapacity> left;     ///< to `collide_slab`
};

/// Empties the batch for pairs of `slab`.
void begin_batch(const Slab& slab, SlabBatch& batch);

inline bool is_full(const SlabBatch& batch) { return batch.pairs.count == SlabTerms::kCapacity; }

/// Adds the pair with the triangle of these corners [m, W], whose contact is to be written when the batch is
/// computed.
void add_to_batch(const Corners& at, Contact& contact, SlabBatch& batch);

/// Computes the contacts, but for their indices, and empties the batch; an area of zero marks that there is
/// none. Those it leaves to `collide_slab` are valid until the next call.
std::span<Contact* const> finish_batch(SlabBatch& batch);

}  // namespace lumbrical
