// Which spheres a thick segment may meet, one source for every instruction set.
//
// The comparison is loose enough for single precision: with the slack of the spheres and of the query nothing
// that meets is left out (tests/search/broadphase_test.cpp). What is found too much is sorted out later in
// double precision, so it does not show in a result.
#pragma once

#include "base/prefetch.h"
#include "lumbrical/model.h"
#include "search/sphere_query.h"
#include "simd/wide_functions.h"

namespace lumbrical::LUMBRICAL_ISA {

/// One bit per sphere of the block.
template <class V>
inline unsigned hits_in_block(const SphereBlock& block, const SphereQuery& query) {
  const V zero = number<V>(0), one = number<V>(1);
  const V dx(query.dx), dy(query.dy), dz(query.dz);
  unsigned bits = 0;
  for (unsigned i = 0; i < SphereBlock::kWidth; i += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
    const V px = get(block.x.data() + i, V{}) - V(query.x), py = get(block.y.data() + i, V{}) - V(query.y),
            pz = get(block.z.data() + i, V{}) - V(query.z);
    const V t = clamp((px * dx + py * dy + pz * dz) * V(query.inverse), zero, one);
    const V gx = px - t * dx, gy = py - t * dy, gz = pz - t * dz;
    const V reach = get(block.r.data() + i, V{}) + V(query.reach);
    const V square = (gx * gx + gy * gy + gz * gz) * number<V>(0.99999);
    bits |= wide::bits_of((reach > zero) & (square <= reach * reach)) << i;
  }
  return bits;
}

/// Writes the places of the spheres hit, 16 times the block plus the lane, in the order of `blocks`; returns
/// how many.
template <class V>
std::size_t sphere_hits(const SphereBlock* spheres, const SphereQuery& query, const std::uint32_t* blocks,
                        std::size_t block_count, std::uint32_t* hits) {
  constexpr std::size_t kAhead = 4;
  std::size_t count = 0;
  for (std::size_t i = 0; i < block_count; ++i) {
    if (i + kAhead < block_count) prefetch(&spheres[blocks[i + kAhead]], sizeof(SphereBlock));
    const std::uint32_t first = blocks[i] * SphereBlock::kWidth;
    const unsigned bits = hits_in_block<V>(spheres[blocks[i]], query);
    if (bits == 0) continue;
    // Without a branch that nobody can foresee.
    for (std::uint32_t k = 0; k < SphereBlock::kWidth; ++k) {
      hits[count] = first + k;
      count += bits >> k & 1;
    }
  }
  return count;
}

}  // namespace lumbrical::LUMBRICAL_ISA
