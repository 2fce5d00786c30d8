// Which parts of a posed hand, tiles and the palm by their numbers (bodies.h), share space with parts of
// other bodies: a question to the pose alone, asked before any patch is looked at.
#pragma once

#include <array>
#include <cstdint>

#include "samples/bodies.h"

namespace lumbrical {

struct Rivals {
  static constexpr std::size_t kParts = (Bodies::kMostFingers + 1) * Bodies::kTilesApart;
  std::array<std::uint64_t, kParts> of{};  ///< those of each part, a bit each
  std::uint64_t any = 0;                   ///< the parts that have some
};

/// Those among `parts` of which at least one is felt. Parts are rivals from a tenth of their radii apart:
/// lattices don't tell where fields meet to the digit.
Rivals find_rivals(const Primitives& hand, const Bodies& bodies, std::uint64_t parts = ~std::uint64_t{0});

}  // namespace lumbrical
