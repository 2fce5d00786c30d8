// Tiles whose borders run through triangles, on their way into the SIMD kernel (border_bulges.h) and out of
// it.
#pragma once

#include <array>
#include <span>

#include "borders/border_cut.h"
#include "exact/pair_slots.h"
#include "exact/round_pairs.h"

namespace lumbrical {

/// The cuts a pair has in the place of its tile's own.
struct OwnCuts {
  std::uint32_t slot = 0;
  std::array<HalfSpace, 2> cut{};
  BulgeMoments bulge{};            ///< what the tile gains beyond cuts that are chords
  std::array<double, 2> height{};  ///< [m] no farther from its chord each border is: towards the wrist, away
  bool clear = true;               ///< false: not for the lanes
};

/// A border on its way across a pair's triangle.
struct BorderWay {
  std::uint32_t own = 0;  ///< whose cut it decides
  bool outer = false;     ///< the border away from the wrist
  Vec3 from, to;  ///< [m] W, from the joint: where it enters and leaves; once followed, its chord's ends
};

/// Follows all borders, a pair's next to each other: puts their chords in the place of cuts and adds up what
/// lies beyond them. `hulls` are those of the primitives.
void follow_borders(const PairSlots& pairs, std::span<const RoundHull> hulls, std::span<BorderWay> ways,
                    std::span<OwnCuts> own);

}  // namespace lumbrical
