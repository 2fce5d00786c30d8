// What samples will cost, counted before their kernels run, and how a bound on it is kept
// (Settings::effort). Only counts decide, never a clock, so every machine decides alike.
#pragma once

#include <array>
#include <cstdint>

#include "samples/levels.h"
#include "samples/near_patches.h"

namespace lumbrical {

/// Evaluations of fields that the patches near a hand ask for.
struct Effort {
  std::uint64_t always = 0;  ///< rules, blocks, and lattices that are the same on all levels
  std::array<std::uint64_t, kLevels> level{};  ///< the other lattices of each level
  std::uint64_t one_cell = 0;                  ///< rules, blocks, and all lattices, were they of one cell
};
Effort effort_of(const PatchRules& rules, const NearPatches& near);

/// Takes weight from fine levels to coarser ones until what remains is within `most` (0: no bound); true if
/// it had to. The coarsest level may take more.
bool keep_effort(const Effort& effort, std::uint64_t most, LevelWeights& weights);

/// With what share, 0 to 1, lattices of one cell are mixed in, so that nothing steps where a growing effort
/// reaches `most` (0: no bound): it grows while even the coarsest level takes nearly what they leave of it.
double one_cell_share(const Effort& effort, std::uint64_t most);

/// What the levels of those weights cost together.
std::uint64_t evaluations_of(const Effort& effort, const LevelWeights& weights);

/// How many times the precision asked for the error is, by estimate, on lattices mixed like this under a
/// force in units of R^3: a level's error is that of the least force for which it will do.
double error_factor_of(const LevelWeights& weights, double force);

/// The same of lattices of one cell over the largest patches near: it grows with the cells' fourth power.
double one_cell_error_factor(const PatchRules& rules, const NearPatches& near, double force);

}  // namespace lumbrical
