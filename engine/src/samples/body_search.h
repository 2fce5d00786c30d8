// What one body of a hand, a finger or the palm, meets of a world's patches: its way down their tree.
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

/// Patches that a world has for all bodies together, or that there may be (Settings::max_candidates).
std::size_t most_patches(const Model& model);

/// What one thread searches with, for one body after the other.
struct PatchSearcher {
  std::array<std::vector<std::uint32_t>, 2> frontier;
  std::vector<FoundPatches> found, before;  ///< before: for a coarser level
  std::size_t count = 0;                    ///< found so far
  std::optional<Rivals> rivals;             ///< of the hand that is searched for

  [[nodiscard]] FoundPatches* end() { return found.data() + count; }
};

/// Whose bodies search, and among what.
struct HandSearch {
  const Model& model;
  const Primitives& hand;
  const Bodies& bodies;  ///< of the hand
  const CutPatches& cuts;
};

/// Where a body is searched for: among all patches, in what was found before, or in some blocks of patches.
struct SearchFrom {
  enum class Where : std::uint8_t { everywhere, before, blocks } where = Where::everywhere;
  std::span<const FoundPatches> before;
  std::span<const std::uint32_t> blocks;
};
/// What a body (the palm is behind the fingers) finds from there. Adds what it feels by the patches'
/// centroids to `force`. Searches stop where a searcher has found more than most_patches: there is room for a
/// step beyond that.
std::span<const FoundPatches> find_for_body(const HandSearch& task, std::size_t body, const SearchFrom& from,
                                            PatchSearcher& searcher, CentroidForce& force);

}  // namespace lumbrical
