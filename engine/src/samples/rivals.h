// Which parts of a posed hand, tiles and the palm by their numbers (bodies.h), share space with parts of
// other bodies: a question to the pose alone, asked before any patch is looked at.
#pragma once

#include <array>
#include <cstdint>

#include "samples/bodies.h"

namespace lumbrical {

struct Rivals {
  std::array<std::uint64_t, Bodies::kMostParts> of{};  ///< those of each part, a bit each
  std::uint64_t any = 0;                               ///< the parts that have some

  /// Those of any part of a body.
  [[nodiscard]] std::uint64_t of_body(std::size_t body) const {
    std::uint64_t others = 0;
    for (std::size_t k = 0; k < Bodies::kTilesApart; ++k) others |= of[body * Bodies::kTilesApart + k];
    return others;
  }
};

/// All parts of other bodies.
Rivals all_rivals(const Bodies& bodies);
/// Those of which at least one is felt. Parts are rivals from a tenth of their radii apart: lattices don't
/// tell where fields meet to the digit.
Rivals find_rivals(const Primitives& hand, const Bodies& bodies);

}  // namespace lumbrical
