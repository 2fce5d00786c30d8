// Whose a convex part of a triangle's plane is, of two tiles, or where their border enters and leaves it.
#pragma once

#include <array>
#include <cstdint>

#include "borders/tile_kin.h"

namespace lumbrical {

/// Where a border crosses the edge of a part, once round counter-clockwise.
struct Crossings {
  static constexpr std::size_t kMaxCount = 8;
  std::uint32_t count = 0;
  std::array<Point2, kMaxCount> at;
  bool leaving_first = false;  ///< the first of them leads out of the tile
};

/// What of a part is the tile's, as far as its kin goes.
enum class PartShare : std::uint8_t {
  all,
  none,
  crossed,  ///< one border runs through, between the two crossings
  unclear,  ///< look at smaller parts
};

/// The part has its corners within `reach` of its `middle` [m]. Adds to `crossings` [m].
PartShare share_with(const Kin& kin, const Polygon2& polygon, Point2 middle, double reach,
                     Crossings& crossings);

}  // namespace lumbrical
