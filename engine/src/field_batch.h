// The field law for spheres and capsules in batches: pairs are taken apart into disc terms, kernels compute
// the terms in lanes, and the terms are summed per pair in a fixed order.
#pragma once

#include <array>

#include "field_kernels.h"
#include "lumbrical/contact.h"
#include "section.h"

namespace lumbrical {

/// Pairs taken apart before their terms are computed.
inline constexpr std::size_t kBatchPairs = 32;

/// Working memory of one thread.
struct FieldBatch {
  struct Pair {
    Contact* contact;
    Vec3 base, u, v;  ///< frame of the triangle's plane, base under the primitive's first end
    double least;     ///< [m^2] smaller than this an area is what rounding leaves of nothing
    double area, area_x, area_y, volume, volume_x, volume_y, depth;
    bool whole;        ///< the triangle is wholly inside: its area is known without terms
    bool depth_known;  ///< the section's deepest point lies in the triangle
  };
  explicit FieldBatch(const FieldKernels& table) : kernels(table) {}
  const FieldKernels& kernels;
  std::size_t pair_count = 0;
  std::array<Pair, kBatchPairs> pair;
  DiscTerms<double> closed;
  DiscTerms<float> single;
};

/// Adds a pair whose contact is to be written when the batch is computed. False where the closed form would
/// lose digits (axis nearly in the plane, shallow contact): the pair is then for `collide`. Sets the
/// contact's area to 0 where there is none. `tolerance` is Settings::tolerance.
bool add_to_batch(const Section& section, double tolerance, Contact& contact, FieldBatch& batch);

/// Computes what is in the batch and empties it.
void finish_batch(FieldBatch& batch);

}  // namespace lumbrical
