// The step that a proxy would take towards the hand: as far as no gap of its cores closes.
//
// Wrist and joints pull like springs, each for itself: minimise 1/2 (x - x_d)^T K (x - x_d) over the turns x
// of the joints and the move of the wrist, so that no gap closes, width + J x >= 0. What holds each gap open
// is its multiplier, a force [N]: that is what the finger feels (virtual coupling: Colgate 1995, Borst and
// Indugula 2006; gaps as constraints: Ortega, Redon and Coquillart 2007).
#pragma once

#include <array>
#include <span>

#include "proxy/core_gaps.h"

namespace lumbrical {

/// [m] The levers on which the wrist's spring resists turns of the wrist and of the joints: about the hand's
/// length, and a finger's.
inline constexpr double kHandLever = 0.2, kFingerLever = 0.1;

/// [N] With which wrist and joints, each on its lever, pull at most: more than any hand is given to feel.
inline constexpr double kStrongestPull = 50;

/// Joints that turn: the wrist moves too, a phalanx' base joint in its own frame.
struct HandMove {
  Vec3 shift;                              ///< [m] W, of the wrist
  Vec3 turn;                               ///< W, of the wrist: tangents of half the angles, times 2
  std::array<Vec3, kPhalanxCount> bend{};  ///< the same of each phalanx, in its base joint's frame
};

/// Shortens a move to where its springs pull no harder; true if any had to be.
bool shorten(double stiffness, HandMove& move);

/// Of a move that would bring the proxy to the hand, what is left of it with `gaps` in the way, a spring of
/// `stiffness` [N/m] pulling at the wrist, which feels the share of pushes that is not `balanced`. Sets what
/// each gap pushes with, and how stiffly by itself.
HandMove pull(const Joints& proxy, const HandMove& wanted, double stiffness, double balanced,
              std::span<Gap> gaps);

}  // namespace lumbrical
