// Patches that several bodies of a hand have found, to be felt once (FeltOnce). Where one body is deeper
// throughout, it alone keeps the patch. All others leave their bodies' lists and go through kernels that give
// each part what is its own: one for what a finger's tile and the palm share, or two tiles, as nearly all
// are; and one for any parts.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/model.h"
#include "samples/cut_patches.h"
#include "samples/rivals.h"
#include "samples/sample_kernels.h"

namespace lumbrical {

/// Of a block of patches: lanes that any body has found, and that several have; and, if there are any of
/// those, its number among such blocks.
struct MetLanes {
  std::uint16_t once, again;
  std::uint32_t number;
};

/// A block of which several bodies have found the same patches: a bit per lane.
struct SharedBlock {
  std::uint32_t block;
  std::uint64_t parts = 0;                               ///< near any of its patches, of bodies that share it
  std::uint16_t of_body[Bodies::kMostFingers + 1] = {};  ///< found by each
  std::uint16_t outdone[Bodies::kMostFingers + 1] = {};  ///< others are deeper throughout
  std::uint16_t near_skeleton = 0, at_joint = 0;         ///< of any body; shared by tiles of a finger
  std::uint16_t of_tile = 0, of_two = 0;                 ///< of one or two tiles and the palm
  std::uint16_t of_others = 0;                           ///< else of several
};

/// A block that a part takes as one, beside another part that does.
struct TakenBlock {
  std::uint32_t block;
  std::uint8_t part;
};

/// A patch that a tile shares with the palm, or with another one, and the key of its list.
struct FoundTogether {
  ListedPatch patch;
  std::uint32_t key;
};
/// A patch that other parts share, and its class.
struct FoundByParts {
  std::uint32_t place, patch_class;
  std::uint64_t parts;
};
/// Patches, and of each the parts of the hand that share it, a bit each.
struct SharedPatches {
  std::span<const ListedPatch> patches;
  const std::uint64_t* parts;
};

/// What there is room for is sized once; blocks that are met are unmarked again after every search.
struct Overlaps {
  std::vector<MetLanes> met;            ///< of each block
  std::vector<std::uint8_t> taken_by;   ///< of each block as one: the part's number plus 1, or 0
  bool any_whole = false;               ///< is there any of those?
  std::vector<TakenBlock> taken_again;  ///< by others than those
  std::vector<SharedBlock> shared;
  std::vector<FoundPatches> kept;
  std::array<std::span<const FoundPatches>, Bodies::kMostFingers + 1> left;  ///< to each body by itself

  std::uint64_t parts = 0;  ///< that share any patch, a bit each
  std::vector<FoundTogether> found_together;
  std::vector<ListedPatch> together;
  std::array<std::uint32_t, 2 * kPatchClasses + 1> together_begin{};  ///< by number of tiles and class
  std::vector<FoundByParts> found_by_parts;
  std::vector<ListedPatch> by_parts;
  std::vector<std::uint64_t> parts_of;  ///< each of those
  std::array<std::uint32_t, kPatchClasses + 1> by_parts_begin{};

  /// What one or two tiles and the palm share.
  [[nodiscard]] std::span<const ListedPatch> together_of(std::size_t tiles, std::size_t patch_class) const {
    const std::size_t key = (tiles - 1) * kPatchClasses + patch_class;
    return std::span(together).subspan(together_begin[key], together_begin[key + 1] - together_begin[key]);
  }
  [[nodiscard]] std::size_t count_together(std::size_t patch_class) const {
    return together_of(1, patch_class).size() + together_of(2, patch_class).size();
  }
  /// What other parts share, those that the same ones share in a row.
  [[nodiscard]] SharedPatches by_parts_of(std::size_t patch_class) const {
    const std::uint32_t begin = by_parts_begin[patch_class], end = by_parts_begin[patch_class + 1];
    return {std::span(by_parts).subspan(begin, end - begin), parts_of.data() + begin};
  }
  [[nodiscard]] std::size_t count_by_parts(std::size_t patch_class) const {
    return by_parts_begin[patch_class + 1] - by_parts_begin[patch_class];
  }
  /// Of all, by the bodies that share them: two at least.
  [[nodiscard]] std::uint32_t patch_count() const {
    return 2 * (together_begin.back() + by_parts_begin.back());
  }
  [[nodiscard]] bool has(std::size_t patch_class) const {
    return count_together(patch_class) + count_by_parts(patch_class) > 0;
  }
  void forget() {
    together_begin.fill(0);
    by_parts_begin.fill(0);
    parts = 0;
  }
};

void size_overlaps(const Model& model, Overlaps& overlaps);

/// From what each body has found to what it feels by itself and what several share. False where that is more
/// than there is room for (Settings::max_candidates).
bool part_overlaps(const Model& model, const CutPatches& cuts, const Bodies& bodies, Rivals& rivals,
                   std::span<const std::span<const FoundPatches>> found, Overlaps& overlaps);

}  // namespace lumbrical
