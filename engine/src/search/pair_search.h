// The search for the triangles near one primitive: in a tree, a grid of them, voxels or all.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "exact/exact_kernels.h"
#include "lumbrical/search_memory.h"
#include "model/primitive.h"
#include "search/near_pairs.h"

namespace lumbrical {

/// Where searches leave what they find: primitive << 33 | Contact::triangle << 1 | unclear, in any order.
/// Counts on where there is no room.
struct FoundPairs {
  std::span<std::uint64_t> room;
  std::atomic<std::size_t> count{0};
};

/// What the search for one primitive's pairs needs.
struct PairSearch {
  const Model& model;
  const Primitives& hand;
  const ExactKernels& kernels;
  SearchMemory& memory;
  MissTerms& terms;
  FoundPairs& found;
  const Hull* hull = nullptr;
  std::uint64_t index = 0;  ///< of the primitive
  double skin = 0;          ///< [m]; 0: candidates themselves are wanted
};

/// Gathers up to kCapacity triangles for the kernel.
void set_triangles(const Triangles& world, std::span<const std::uint32_t> triangles, MissTerms& terms);

/// All pairs of the primitive; false where there is no room. `cells` are those of the grid that the hand may
/// meet.
bool search_for(PairSearch& search, std::span<const std::uint32_t> cells);

}  // namespace lumbrical
