// From a posed hand to the patches its bodies may meet, in order of size and kind: the first passes of the
// rungs of samples (sampled_forces.h). What is found and as what is a question to patch and body alone; in
// which order it is found does not matter.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lumbrical/model.h"
#include "samples/cut_patches.h"
#include "samples/overlaps.h"

namespace lumbrical {

struct Primitives;

/// Patches near a hand, sorted by their keys.
struct NearPatches {
  std::vector<ListedPatch> listed;
  std::array<std::uint32_t, kKeyCount + 1> begin{};  ///< those of key k go from begin[k] to begin[k + 1]
  std::uint64_t tiles = 0;                           ///< that are near any, a bit each by their numbers
  std::array<std::uint64_t, kKeyCount> innermost{};  ///< the tiles that patches of each key are listed for

  [[nodiscard]] std::size_t count() const { return begin.back(); }
  void forget() {
    begin.fill(0);
    tiles = 0;
  }
  [[nodiscard]] bool has(std::size_t patch_class) const {
    return begin[patch_class * kind::kCount] < begin[(patch_class + 1) * kind::kCount];
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

/// What one thread searches with, for one body after the other.
struct PatchSearcher {
  std::array<std::vector<std::uint32_t>, 2> frontier;
  std::vector<FoundPatches> found, before;  ///< before: for a coarser level
  std::size_t count = 0;                    ///< found so far
  std::optional<Rivals> rivals;             ///< of the hand that is searched for

  [[nodiscard]] FoundPatches* end() { return found.data() + count; }
};

/// Patches of a block that a body has found of one key, by their lanes.
struct PatchRun {
  std::uint32_t first;  ///< patch of the block; or the block as one
  std::uint32_t tile;   ///< as ListedPatch has it
  std::uint32_t lanes;  ///< a bit each
};

/// What the search works with, sized once for a model.
struct PatchSearchMemory {
  CutPatches cuts;  ///< of the tick (`cut_near`)
  std::vector<PatchSearcher> searcher;
  std::array<std::span<const FoundPatches>, Bodies::kMostFingers + 1> found;  ///< of each body, the palm last
  std::array<CentroidForce, Bodies::kMostFingers + 1> force;                  ///< on each body
  std::vector<PatchRun> runs;                                                 ///< in order of their keys
  std::size_t listed = 0;                                                     ///< patches, the last time
};

void size_search(const Model& model, PatchSearchMemory& memory, NearPatches& near);

/// What each body meets. False where that is more than there is room for (Settings::max_candidates).
bool find_patches(const Model& model, const Primitives& hand, const Bodies& bodies,
                  PatchSearchMemory& memory);

/// The same, from what was found for bodies that take larger blocks as ones on the skin and are otherwise the
/// same: those that are too large now are opened.
bool open_patches(const Model& model, const Primitives& hand, const Bodies& bodies,
                  PatchSearchMemory& memory);

bool found_any(const PatchSearchMemory& memory);

/// What was found as each body feels it by itself and, in `overlaps`, as several share it. False where that
/// is more than there is room for.
bool list_patches(const Model& model, const Bodies& bodies, PatchSearchMemory& memory, NearPatches& near,
                  Overlaps& overlaps);

/// What bodies feel together by the patches' centroids alone: the sum of their forces' sizes [m^3], of a
/// stiffness of 1. As the last search of all patches has it.
double force_at_centroids(const Bodies& bodies, const PatchSearchMemory& memory);

}  // namespace lumbrical
