// What several bodies of a hand hold together, to be felt once (Settings::felt_once): a pass of its own,
// after each body has been felt by itself. Patches that two bodies may reach are searched for, and for every
// part of the hand that may be in one, what others are deeper in is taken off its sums.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/model.h"
#include "samples/sample_kernels.h"

namespace lumbrical {

/// Patches of which parts of a hand may have to leave something to other bodies, by part and size.
struct Overlaps {
  static constexpr std::size_t kParts = Rivals::kParts;
  Rivals rivals;
  std::vector<ListedPatch> listed, found;
  std::array<std::vector<SharedBlock>, 2> frontier;
  std::array<std::uint32_t, kParts * kPatchSizes + 1> begin{};

  [[nodiscard]] std::size_t count() const { return begin.back(); }
  [[nodiscard]] std::span<const ListedPatch> of(std::size_t part, std::size_t size) const {
    const std::size_t key = part * kPatchSizes + size;
    return std::span(listed).subspan(begin[key], begin[key + 1] - begin[key]);
  }
};

void size_overlaps(const Model& model, Overlaps& overlaps);

/// Of what felt bodies have found near, as `tiles` tells. False where there are more than there is room for
/// (Settings::max_candidates).
bool find_overlaps(const Model& model, const Primitives& hand, const Bodies& bodies, std::uint64_t tiles,
                   Overlaps& overlaps);

/// Steps of the lattice over a patch of a size, by which a part leaves something to others; `steps` are that
/// part's own lattices. A third of those where a skeleton comes near: that much is exact where fields are
/// linear, and a small share of what is felt.
inline std::size_t overlap_steps(const LatticeSteps* steps, std::size_t size, std::size_t level) {
  return (steps[kPatchSizes + size][level] + 2u) / 3;
}

/// Evaluations that it will take to take them off: `level` as that of lattices.
std::uint64_t effort_of(const Patches& patches, const Overlaps& overlaps, std::size_t level);

}  // namespace lumbrical
