// Which spheres of a tree a body may meet (sphere_hits.h): a finger's tiles at once, or the palm.
#pragma once

#include "base/prefetch.h"
#include "samples/sample_kernels.h"
#include "search/sphere_hits.h"

namespace lumbrical::LUMBRICAL_ISA {

template <class V>
std::size_t finger_hits(const SphereBlock* spheres, const SphereQuery* queries, std::size_t query_count,
                        const std::uint32_t* blocks, std::size_t block_count, bool tiles,
                        std::uint32_t* hits) {
  constexpr std::size_t kAhead = 4;
  std::size_t count = 0;
  for (std::size_t i = 0; i < block_count; ++i) {
    if (i + kAhead < block_count) prefetch(&spheres[blocks[i + kAhead]], sizeof(SphereBlock));
    unsigned of[FingerBody::kMostTiles] = {0, 0, 0};
    unsigned any = 0;
    for (std::size_t k = 0; k < query_count; ++k) {
      of[k] = hits_in_block<V>(spheres[blocks[i]], queries[k]);
      any |= of[k];
    }
    const std::uint32_t first = blocks[i] * SphereBlock::kWidth;
    for (; any != 0; any &= any - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(any));
      hits[count++] = tiles ? found_at(first + lane, tiles_in_lane(of, lane)) : first + lane;
    }
  }
  return count;
}

template <class V>
std::size_t palm_hits(const SphereBlock* spheres, const PalmQuery& palm, const std::uint32_t* blocks,
                      std::size_t block_count, std::uint32_t* hits) {
  constexpr std::size_t kAhead = 4;
  constexpr double kRounding = 1.000001;  // of what is far away, as its spheres are large
  const V zero = number<V>(0);
  std::size_t count = 0;
  for (std::size_t i = 0; i < block_count; ++i) {
    if (i + kAhead < block_count) prefetch(&spheres[blocks[i + kAhead]], sizeof(SphereBlock));
    const SphereBlock& block = spheres[blocks[i]];
    for (unsigned lane = 0; lane < SphereBlock::kWidth;
         lane += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
      const V x = get(block.x.data() + lane, V{}), y = get(block.y.data() + lane, V{}),
              z = get(block.z.data() + lane, V{});
      const V reach = get(block.r.data() + lane, V{}) * number<V>(kRounding) + V(palm.slack);
      V farthest = number<V>(-1e30);
      for (std::size_t k = 0; k < palm.plane_count; ++k) {
        const float(&plane)[4] = palm.plane[k];
        farthest = max(farthest, V(plane[0]) * x + V(plane[1]) * y + V(plane[2]) * z + V(plane[3]));
      }
      for (unsigned bits = wide::bits_of(reach > zero && farthest <= reach); bits != 0; bits &= bits - 1) {
        hits[count++] =
            blocks[i] * SphereBlock::kWidth + lane + static_cast<std::uint32_t>(__builtin_ctz(bits));
      }
    }
  }
  return count;
}

}  // namespace lumbrical::LUMBRICAL_ISA
