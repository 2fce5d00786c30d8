// Tiles whose borders run through triangles, gathered for the SIMD kernel (border_bulges.h).
#pragma once

#include <array>
#include <span>

#include "base/fixed_list.h"
#include "borders/border_cut.h"
#include "lanes/round_batch.h"

namespace lumbrical {

/// A tile and a triangle that one or two of its borders cross.
struct BorderPair {
  Contact* contact = nullptr;
  std::array<HalfSpace, 2> cut{};
  std::array<int, 2> lane{-1, -1};  ///< of the border towards the wrist, of the one away from it
  bool clear = false;  ///< the cuts are the chords, with the moments beyond them; otherwise not for the lanes
  BulgeMoments bulge;
};

/// Working memory of one thread.
struct BorderBatch {
  explicit BorderBatch(const FieldKernels& table) : kernels(table) {}
  const FieldKernels& kernels;
  BorderTerms terms;
  FixedList<BorderPair, BorderTerms::kCapacity> pairs;
};

/// Is there room for a pair more?
inline bool has_room(const BorderBatch& batch) { return batch.terms.count + 2 <= BorderTerms::kCapacity; }

/// Adds the pair of `tile`, whose hull is `hull`, with the triangle a, b, c [m, W] that borders cross.
void add_to_batch(const Primitives& hand, const Primitive& tile, const RoundHull& hull,
                  const TriangleCuts& cuts, Vec3 a, Vec3 b, Vec3 c, Contact& contact, BorderBatch& batch);

/// Computes all pairs and empties the batch. What is returned is valid until the next pair is added.
std::span<const BorderPair> finish_batch(const Primitives& hand, BorderBatch& batch);

}  // namespace lumbrical
