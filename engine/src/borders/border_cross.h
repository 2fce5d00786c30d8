// How curved borders cut one triangle: not at all, or from edge to edge.
#pragma once

#include <array>

#include "borders/joint_border.h"
#include "model/corners.h"
#include "model/primitive.h"

namespace lumbrical {

enum class CutKind : std::uint8_t {
  planes,  ///< as the tile's own cuts do
  other,   ///< as others in their place do
  gone,    ///< all of the triangle is another tile's
  unclear  ///< a matter for `borders_on` and `collide_shared`
};

/// Where a border crosses edges of the triangle [m] W, from the joint; its kin's part lies to the right of
/// the way.
struct BorderCrossing {
  bool exists = false;
  Vec3 from, to;
};

struct TriangleCuts {
  CutKind kind = CutKind::planes;
  std::array<HalfSpace, 2> cut{};            ///< in the place of the tile's; a normal of 0 cuts nothing
  std::array<BorderCrossing, 2> crossing{};  ///< by the border towards the wrist, by the one away from it
};

/// Which of a tile's cuts is in the place of its border away from the wrist, or of that towards it.
inline std::size_t own_cut(const Primitive& tile, bool outer) { return outer ? tile.cut_count - 1u : 0u; }

/// The joint of that border, as an index of Primitives::border.
inline std::size_t joint_of(const Primitive& tile, bool outer) {
  return outer ? tile.segment : tile.segment - 1u;
}

/// How the near borders of `tile` go through the triangle `at` [m, W], `near` those in its reach. The cuts
/// in the place of borders that cross it are left to the caller.
TriangleCuts cross_borders(const Primitives& hand, const Primitive& tile, const TileBorders& near,
                           const Corners& at);

}  // namespace lumbrical
