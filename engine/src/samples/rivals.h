// Which parts of a posed hand, tiles and the palm by their numbers (bodies.h), share space with parts of
// other bodies: a question to the pose alone.
#pragma once

#include <array>
#include <cstdint>

#include "base/always_inline.h"
#include "samples/bodies.h"

namespace lumbrical {

/// The parts that share space with each, a bit each, asked for when first needed. Parts do from a tenth of
/// their radii apart: lattices don't tell where fields meet to the digit.
class Rivals {
 public:
  Rivals(const Primitives& hand, const Bodies& bodies) : hand_(hand), bodies_(bodies) {}
  [[nodiscard]] LUMBRICAL_INLINE std::uint64_t of(std::size_t part) {
    const std::uint64_t bit = std::uint64_t{1} << part;
    if ((known_ & bit) == 0) of_[part] = find(part);
    known_ |= bit;
    return of_[part];
  }

 private:
  [[nodiscard]] std::uint64_t find(std::size_t part) const;
  const Primitives& hand_;
  const Bodies& bodies_;
  std::uint64_t known_ = 0;
  std::array<std::uint64_t, Bodies::kMostParts> of_;
};

/// What may be deeper than a body's parts, and where bodies are, seen from that one's origin.
struct OtherParts {
  const Bodies& bodies;
  std::size_t body;
  BodyOffsets offset;
  Rivals* rivals;  ///< null: each part is felt by itself

  /// The body's own.
  [[nodiscard]] LUMBRICAL_INLINE const SplitPoint& origin() const { return bodies.origin[body]; }

  /// The rivals of a finger's tile, or of the palm as the first.
  [[nodiscard]] std::uint64_t of_tile(std::size_t tile) const {
    return rivals == nullptr ? 0 : rivals->of(body * Bodies::kTilesApart + tile);
  }
};

}  // namespace lumbrical
