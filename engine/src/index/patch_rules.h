// How finely a hand feels: how large patches of triangles may be, how fine the lattices are that go through
// them, and which blocks of them are taken as ones. All of it goes by the hand's radii and the precision
// asked for, never by a pose.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "lumbrical/hand.h"
#include "lumbrical/model.h"

namespace lumbrical {

/// A patch's size is one less than how many steps of a length of their own it is long, rounded up. Its class
/// is that, or by kPatchSizes more where a body's skeleton comes near (an axis, a centre, the palm's
/// polygon): there its field has a kink.
inline constexpr std::size_t kPatchSizes = 7, kPatchClasses = 2 * kPatchSizes;

/// The lattice with most steps: twice as many as a patch is long, where a skeleton comes near.
inline constexpr std::size_t kMostSteps = 2 * kPatchSizes;

/// Lattices of so many steps, whose number is even then, are gone through quarter by quarter of a patch, side
/// by side: where they are that fine, patches are few.
inline constexpr std::size_t kLeastStepsInQuarters = 8, kMostStepsAtOnce = kMostSteps / 2;
constexpr bool is_in_quarters(std::size_t steps) { return steps >= kLeastStepsInQuarters; }

/// Lattices from coarse to fine. How fine the one is by which a hand is felt depends on its force
/// (samples/levels.h).
inline constexpr std::size_t kLevels = 9;
/// Steps by level and, behind them, 1: one cell a patch, for a tick that must not take longer.
inline constexpr std::size_t kOneCell = kLevels;
using LatticeSteps = std::array<std::uint8_t, kLevels + 1>;

struct PatchRules {
  /// Felt by samples, a bit each: the palm and fingers of which every segment follows the field law with a
  /// precision above 0. A finger's segments share out space, which one rung has to do for all of them.
  std::uint32_t segments = 0;
  double step = 0;     ///< [m] that patches are measured in (patch_cuts.h)
  double radius3 = 0;  ///< [m^3] mean of the sampled segments' radii cubed
  /// Steps of the lattices that a hand segment has in a patch of a class.
  std::array<std::array<LatticeSteps, kPatchClasses>, kSegmentCount> steps{};
  std::array<LatticeSteps, kPatchClasses> most_steps{};  ///< that any segment has
  std::array<bool, kPatchClasses> has_levels{};          ///< does any segment's lattice depend on the level?
  /// [m] Largest size of a block that a segment takes as one.
  std::array<double, kSegmentCount> block_size{};
  double block_above_palm = 0;  ///< [m] the same of the palm above its polygon
  /// [m] The same where a body's skin goes through, by level; put to 0 where a world has few as small.
  std::array<double, kLevels> block_on_skin{};
};

PatchRules patch_rules(const Hand& hand, const Settings& settings);

/// As many steps as keep cells within an eighth of what is asked for.
std::uint8_t steps_for(double wanted);

}  // namespace lumbrical
