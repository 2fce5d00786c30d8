// What several bodies of a hand hold together, to be felt once (FeltOnce): patches that two bodies may reach
// are searched for, and of every part of the hand that may be in one what others are deeper in is taken off
// its sums, by lattices of the level that the part is felt by.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/model.h"
#include "samples/sample_kernels.h"

namespace lumbrical {

/// Patches of which parts of a hand may have to leave something to other bodies, by size and part.
struct Overlaps {
  static constexpr std::size_t kParts = Rivals::kParts;
  Rivals rivals;
  std::vector<ListedPatch> listed, found;
  std::array<std::vector<SharedBlock>, 2> frontier;
  std::array<std::uint32_t, kPatchSizes * kParts + 1> begin{};

  /// Of a class: where a skeleton comes near lattices are no finer than elsewhere, for what is lost there is
  /// a small share of what is felt.
  [[nodiscard]] std::size_t count_of(std::size_t patch_class) const {
    return patch_class < kPatchSizes ? begin[(patch_class + 1) * kParts] - begin[patch_class * kParts] : 0;
  }
  [[nodiscard]] std::span<const ListedPatch> of(std::size_t size, std::size_t part) const {
    const std::size_t key = size * kParts + part;
    return std::span(listed).subspan(begin[key], begin[key + 1] - begin[key]);
  }
};

void size_overlaps(const Model& model, Overlaps& overlaps);

/// Of what felt bodies have found near, as `tiles` tells. False where there are more than there is room for
/// (Settings::max_candidates).
bool find_overlaps(const Model& model, const Primitives& hand, const Bodies& bodies, std::uint64_t tiles,
                   Overlaps& overlaps);

}  // namespace lumbrical
