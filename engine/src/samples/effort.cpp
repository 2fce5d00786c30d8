#include "samples/effort.h"

namespace lumbrical {
namespace {

// A cell is its centroid and, shared with its neighbours, half a corner or more.
constexpr std::uint64_t kPerCell = 2;
// Points of a block, and about those of a rule.
constexpr std::uint64_t kPerBlock = 7, kPerRule = 16;
// What any parts share, in time: about four fields, and what parts them.
constexpr std::uint64_t kPerParts = 9;

// Share of a bound on effort from which on one cell a patch is mixed in.
constexpr double kNearly = 0.9;

std::uint64_t count_of(const NearPatches& near, std::uint32_t first, std::uint32_t last,
                       std::size_t patch_class) {
  return near.of_kinds(first, last, patch_class).size();
}

}  // namespace

Effort effort_of(const PatchRules& rules, const NearPatches& near) {
  Effort effort;
  for (std::size_t k = 0; k < kPatchClasses; ++k) {
    if (!near.has(k)) continue;
    const std::uint64_t smooth = kPerRule * count_of(near, kind::kInside, kind::kInside + 2, k) +
                                 kPerBlock * count_of(near, kind::kBlockInside, kind::kBlockInside + 2, k) +
                                 kPerBlock * count_of(near, kind::kPalmSide, kind::kPalmBlockBeside, k);
    const std::uint64_t shares =
        count_of(near, kind::kTile, kind::kFarEnd + 2, k) +
        2 * count_of(near, kind::kInnerJoint, kind::kOuterJoint, k) +
        3 * count_of(near, kind::kFinger, kind::kFinger, k) + count_of(near, kind::kPalm, kind::kPalm, k) +
        2 * near.overlaps.count_together(k) + kPerParts * near.overlaps.count_by_parts(k);
    effort.always += smooth;
    effort.one_cell += smooth + kPerCell * shares;
    for (std::size_t level = 0; level < kLevels; ++level) {
      const std::uint64_t steps = rules.most_steps[k][level], all = kPerCell * shares * steps * steps;
      if (rules.has_levels[k]) {
        effort.level[level] += all;
      } else if (level == 0) {
        effort.always += all;
      }
    }
  }
  return effort;
}

std::uint64_t evaluations_of(const Effort& effort, const LevelWeights& weights) {
  std::uint64_t evaluations = effort.always;
  for (std::size_t level = 0; level < kLevels; ++level)
    evaluations += weights[level] > 0 ? effort.level[level] : 0;
  return evaluations;
}

bool keep_effort(const Effort& effort, std::uint64_t most, LevelWeights& weights) {
  if (most == 0) return false;
  bool coarsened = false;
  for (std::size_t level = kLevels; level-- > 1;) {
    if (!(weights[level] > 0) || evaluations_of(effort, weights) <= most) continue;
    weights[level - 1] += weights[level];
    weights[level] = 0;
    coarsened = true;
  }
  return coarsened;
}

double one_cell_share(const Effort& effort, std::uint64_t most) {
  if (most == 0) return 0;
  const std::uint64_t coarsest = effort.always + effort.level[0];
  if (coarsest == effort.one_cell) return coarsest > most ? 1 : 0;  // they are the same lattices
  if (most <= effort.one_cell) return 1;
  const double share = static_cast<double>(coarsest) / static_cast<double>(most - effort.one_cell);
  return clamp((share - kNearly) / (1 - kNearly), 0, 1);
}

double error_factor_of(const LevelWeights& weights, double force) {
  double factor = 0;
  for (std::size_t level = 0; level < kLevels; ++level) {
    const double least = level + 1 < kLevels ? kEnoughForce[level] : 0;
    factor += weights[level] * max(1, force > 0 ? least / force : 1);
  }
  return factor;
}

double one_cell_error_factor(const PatchRules& rules, const NearPatches& near, double force) {
  double coarser = 1;
  for (std::size_t k = 0; k < kPatchClasses; ++k) {
    if (near.has(k)) coarser = max(coarser, rules.most_steps[k][0]);
  }
  const double fourth = coarser * coarser * coarser * coarser;
  return fourth * max(1, force > 0 ? kEnoughForce[0] / force : 1);
}

}  // namespace lumbrical
