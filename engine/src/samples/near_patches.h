// What was found near a hand, in order: which patches each kernel takes, sixteen in a row.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "samples/sample_search.h"

namespace lumbrical {

/// Patches of a block that a body has found of one key, by their lanes.
struct PatchRun {
  std::uint32_t first;  ///< patch of the block; or the block as one
  std::uint32_t tile;   ///< as ListedPatch has it
  std::uint32_t lanes;  ///< a bit each
};

/// Patches near a hand: what each body feels by itself, sorted by keys, and what several share.
struct NearPatches {
  std::vector<ListedPatch> listed;
  std::vector<PatchRun> runs;                        ///< in the same order
  std::array<std::uint32_t, kKeyCount + 1> begin{};  ///< those of key k go from begin[k] to begin[k + 1]
  std::uint64_t tiles = 0;                           ///< that are near any, a bit each by their numbers
  std::array<std::uint64_t, kKeyCount> innermost{};  ///< the tiles that patches of each key are listed for
  Overlaps overlaps;

  [[nodiscard]] std::size_t count() const { return begin.back(); }
  void forget() {
    begin.fill(0);
    tiles = 0;
    innermost.fill(0);
    overlaps.forget();
  }
  [[nodiscard]] bool has(std::size_t patch_class) const {
    return begin[patch_class * kind::kCount] < begin[(patch_class + 1) * kind::kCount] ||
           overlaps.has(patch_class);
  }
  /// Those of a class and of kinds `first` to `last`.
  [[nodiscard]] std::span<const ListedPatch> of_kinds(std::uint32_t first, std::uint32_t last,
                                                      std::size_t patch_class) const {
    const std::size_t key = patch_class * kind::kCount;
    return std::span(listed).subspan(begin[key + first], begin[key + last + 1] - begin[key + first]);
  }
  /// The tiles that those are listed for, a bit each.
  [[nodiscard]] std::uint64_t tiles_of_kinds(std::uint32_t first, std::uint32_t last,
                                             std::size_t patch_class) const {
    std::uint64_t tiles_of_any = 0;
    for (std::size_t k = first; k <= last; ++k) tiles_of_any |= innermost[patch_class * kind::kCount + k];
    return tiles_of_any;
  }
};

void size_near(const Model& model, NearPatches& near);

/// From what was found. False where that is more than there is room for.
bool list_patches(const Model& model, const Bodies& bodies, PatchSearchMemory& memory, NearPatches& near);

}  // namespace lumbrical
