// Pairs of one round primitive with triangles, gathered for the SIMD kernel (round_contacts.h).
#pragma once

#include <array>
#include <span>

#include "lanes/field_kernels.h"
#include "lumbrical/contact.h"
#include "model/primitive.h"

namespace lumbrical {

/// Working memory of one thread.
struct RoundBatch {
  explicit RoundBatch(const FieldKernels& table) : kernels(table) {}
  const FieldKernels& kernels;
  Vec3 origin;  ///< [m] W, the primitive's larger end
  RoundTerms<double> pairs;
  RoundTerms<float> single;
  std::array<Contact*, RoundTerms<double>::kCapacity> contact, slivers;  ///< of each pair
};

/// Is the primitive one the kernel knows?
bool suits_batch(const Primitive& primitive);

/// Empties the batch for pairs of `primitive`. `tolerance` is Settings::tolerance.
void begin_batch(const Primitive& primitive, double tolerance, RoundBatch& batch);

inline bool is_full(const RoundBatch& batch) { return batch.pairs.count == RoundTerms<double>::kCapacity; }

/// Adds the pair with triangle a, b, c [m, W], whose contact is to be written when the batch is computed.
/// `cut` has the primitive's cuts or as many others in their place; a normal of 0 cuts nothing.
void add_to_batch(Vec3 a, Vec3 b, Vec3 c, const std::array<HalfSpace, 2>& cut, Contact& contact,
                  RoundBatch& batch);

/// Pairs the kernel leaves something of to do.
struct RoundRest {
  std::span<Contact*> slivers;       ///< for `add_slivers`
  std::span<Contact* const> unsure;  ///< for `collide_section`
};

/// Computes the contacts of all pairs, but for their indices, and empties the batch; the area is 0 where
/// there is none. The rest is valid until the next call.
RoundRest finish_batch(RoundBatch& batch);

}  // namespace lumbrical
