// What is near a hand, list by list through the kernels (sample_kernels.h) to the sums of tiles and palm.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "samples/near_patches.h"

namespace lumbrical {

/// What is felt once and, where two levels are mixed, by the lattices of either.
enum class Mix : std::uint8_t { once, coarser, finer };

/// What one thread works with.
struct SampleThread {
  std::vector<ListedPatch> chosen;            ///< for one kernel
  std::array<std::vector<BodySums>, 3> sums;  ///< of each Mix, of tiles and palm by their numbers
  std::uint32_t touched = 0;

  [[nodiscard]] const std::vector<BodySums>& sums_of(Mix mix) const {
    return sums[static_cast<std::size_t>(mix)];
  }
  [[nodiscard]] std::vector<BodySums>& sums_of(Mix mix) { return sums[static_cast<std::size_t>(mix)]; }
};

/// A hand's patches, and who computes them: one of `threads`, each of which takes its part of every list.
struct SampleWork {
  const SampleKernels& kernels;
  const Patches& patches;
  const CutPatches& cuts;
  const Bodies& bodies;
  const NearPatches& near;
  SampleThread& memory;
  std::size_t number, threads;
  std::size_t lists = 0;  ///< shared out so far

  [[nodiscard]] const FingerBody* fingers() const { return bodies.finger.data(); }
  [[nodiscard]] BodySums* sums(Mix mix) const { return memory.sums_of(mix).data(); }
  [[nodiscard]] PatchList list(std::span<const ListedPatch> listed, std::size_t steps = 0) const {
    return {patches.shape.data(), listed.data(), listed.size(),
            bodies.origin.data(), steps,         static_cast<std::uint32_t>(patches.shape.size()),
            cuts.shape.data()};
  }
  /// Whole rows of sixteen; where there are too few for all, list by list others go without.
  [[nodiscard]] std::span<const ListedPatch> own_part(std::span<const ListedPatch> all) {
    if (threads == 1) return all;
    const std::size_t rows = piece_count(all.size(), PatchBlock::kWidth), turn = lists++ % threads;
    const auto begin = [&](std::size_t thread) {
      return std::min(all.size(), (rows * thread + turn) / threads * PatchBlock::kWidth);
    };
    return all.subspan(begin(number), begin(number + 1) - begin(number));
  }
  [[nodiscard]] std::span<const ListedPatch> of_kinds(std::uint32_t first, std::uint32_t last,
                                                      std::size_t patch_class) {
    return own_part(near.of_kinds(first, last, patch_class));
  }
};

/// Blocks as ones, inside the skin or on it.
void run_blocks(SampleWork& work, std::size_t block_class);

/// What lies inside, where fields are smooth, or linear: of the patches of a class.
void run_smooth(SampleWork& work, std::size_t patch_class);

/// Lattices of a level over the patches of a class, those that several bodies share too.
void run_lattices(SampleWork& work, std::size_t patch_class, std::size_t level, Mix mix);

}  // namespace lumbrical
