// How fine a lattice a hand is felt by.
//
// What a lattice is off by hardly depends on how deep a part of the hand is in: it comes from where the world
// crosses the skin. So the harder a hand presses, the smaller the share of its force that is, and the coarser
// a lattice will do; and a hand that touches lightly meets few patches and can afford a fine one. How hard it
// presses is told by the patches' centroids, nearly, before any lattice is gone through. Between two levels
// lies a narrow range of forces where both are felt and mixed, so that a growing force never jumps.
#pragma once

#include <array>

#include "index/patches.h"
#include "lumbrical/math.h"

namespace lumbrical {

/// How much each level counts, 1 in all.
using LevelWeights = std::array<double, kLevels>;

/// How finely a hand is felt. Whoever moves a hand by little to learn what that changes feels it as finely
/// as before: what another choice would change is of the size of its errors.
struct Fineness {
  LevelWeights level{};
  bool coarse_blocks = false;  ///< blocks on the skin are those of level 0, whatever the lattices
  double one_cell = 0;         ///< the share, 0 to 1, with which each lattice counts as one cell
};

/// Least forces for which level k will do without the next finer one: sums of what bodies feel by centroids,
/// of a stiffness of 1, in units of PatchRules::radius3. A step's fourth power goes with them. Measured over
/// drapes, fingertips, grasps and real meshes (docs/mechanics.md).
inline constexpr std::array<double, kLevels - 1> kEnoughForce = {37, 17, 5, 2.1, 0.95, 0.42, 0.2, 0.08};

/// Share of them that is too little.
inline constexpr double kTooLittle = 0.9;

inline LevelWeights level_weights(double force) {
  LevelWeights weights{};
  double left = 1;
  for (std::size_t k = 0; k + 1 < kLevels; ++k) {
    const double enough = min(left, clamp((force / kEnoughForce[k] - kTooLittle) / (1 - kTooLittle), 0, 1));
    weights[k] = enough;
    left -= enough;
  }
  weights[kLevels - 1] = left;
  return weights;
}

}  // namespace lumbrical
