#include "index/patch_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/fixed_list.h"
#include "base/set_bits.h"
#include "lumbrical/math.h"

namespace lumbrical {
namespace {

// [R] Longest steps of the lattices at a precision of 1e-4 of the hand's force, from the coarsest level to
// the finest, R the mean radius of what is sampled: all segments have the same lattices, so that patches of
// several go through kernels together. Measured: docs/mechanics.md; a user measures his own scene with
// `lumbrical run --compare-precision`. The error falls with the step's fourth power. The first two differ by
// the blocks that are taken as ones (kBlockOnSkin).
constexpr std::array<double, kLevels> kStep = {0.46, 0.46, 0.37, 0.3, 0.245, 0.2, 0.165, 0.132, 0.102};

// R is no less and no more than these shares of a segment's own radius.
constexpr double kThick = 0.5, kThin = 1.5;

// A segment counts as no thinner than this share of what is usual in the hand: one that is nearly a point is
// hardly felt, and would have patches everywhere be as small as it is.
constexpr double kThinnest = 0.2;

// [R] The steps that patches are measured in, at a precision of 1e-4 and at coarser ones: of longer patches
// most would be nowhere near a finger.
constexpr double kSizeStep = 0.16;

// Steps are rounded up to an even number.
static_assert(kPatchSizes * kSizeStep <= (kMostSteps - 2) * kStep[kLevels - 1]);

// How many times finer than a patch is long in those, level by level, lattices are where a skeleton comes
// near.
constexpr std::array<double, kLevels> kNearSkeleton = {1, 1, 1, 1.25, 1.25, 1.5, 1.75, 1.75, 2};
static_assert(kStep[0] == kStep[1] && kNearSkeleton[0] == kNearSkeleton[1]);

// Patches of smaller sizes have the last of these on every level: theirs cost less than a second look would.
constexpr std::size_t kLeastSizeWithLevels = 4;

// [R] Largest size of a block that is taken as one at a precision of 1e-4; the error falls with its third
// power.
constexpr double kBlockSize = 0.3;

// The same above the palm's polygon, where its field is linear and forces exact whatever the size, and beside
// it, where its curvature jumps.
constexpr double kBlockAbovePalm = 2, kBlockBesidePalm = 0.25;

// [R] The same where a body's skin goes through, by level: the error falls with the size's fifth power or so,
// and with the hand's force.
constexpr std::array<double, kLevels> kBlockOnSkin = {0.24, 0.21, 0.17, 0.14, 0.12, 0.1, 0.087, 0.073, 0.06};

// By Newton's method, since the C library's differs between machines.
double cube_root(double x) {
  double root = max(x, 1);
  for (int i = 0; i < 60; ++i) root = (2 * root + x / (root * root)) / 3;
  return root;
}

double radius_of(const Hand& hand, std::size_t segment) {
  if (segment == kPalmSegment) return 0.5 * hand.palm.thickness;
  const auto [base, tip] = kPhalanxJoints[segment];
  return min(hand.radius[base], hand.radius[tip]);
}

std::uint32_t sampled_segments(const Settings& settings) {
  constexpr std::uint32_t kOfFinger = kPhalanxCount / kFingerCount, kFinger = (1u << kOfFinger) - 1;
  std::uint32_t segments = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i)
    segments |= std::uint32_t{settings.law[i] == Law::field && settings.precision[i] > 0} << i;
  for (std::uint32_t first = 0; first < kPhalanxCount; first += kOfFinger) {
    if ((segments >> first & kFinger) != kFinger) segments &= ~(kFinger << first);
  }
  return segments;
}

template <class Of>
double mean_over(std::uint32_t segments, const Of& of) {
  double sum = 0, count = 0;
  for_numbers(segments, [&](std::size_t i) {
    sum += of(i);
    ++count;
  });
  return sum / count;
}

double median_radius(const Hand& hand, std::uint32_t segments) {
  FixedList<double, kSegmentCount> radii;
  for_numbers(segments, [&](std::size_t i) { radii.push_back(radius_of(hand, i)); });
  std::sort(radii.begin(), radii.end());
  return *(radii.begin() + radii.size() / 2);
}

/// [m] Of what is sampled.
struct UsualRadius {
  double mean, least;
};

// By how much longer than at 1e-4 steps may be where the error falls with their fourth power.
double longer_for(double precision) { return std::sqrt(std::sqrt(precision / 1e-4)); }

// [m] R, as long as a segment's precision makes it.
double step_unit(const Hand& hand, const Settings& settings, std::size_t segment, const UsualRadius& usual) {
  const double own = max(radius_of(hand, segment), usual.least);
  return longer_for(settings.precision[segment]) * clamp(usual.mean, kThick * own, kThin * own);
}

LatticeSteps lattice_steps(double size, double unit) {
  LatticeSteps steps;
  for (std::size_t level = 0; level < kLevels; ++level)
    steps[level] = steps_for(size / (kStep[level] * unit));
  steps[kOneCell] = 1;
  return steps;
}

LatticeSteps steps_near_skeleton(double size, double unit, bool has_levels) {
  LatticeSteps steps;
  const std::uint8_t own = steps_for(size / (kSizeStep * unit));
  for (std::size_t level = 0; level < kLevels; ++level)
    steps[level] = steps_for(kNearSkeleton[has_levels ? level : kLevels - 1] * own);
  steps[kOneCell] = 1;
  return steps;
}

void set_lattices(std::size_t segment, double unit, PatchRules& rules) {
  for (std::size_t k = 0; k < kPatchSizes; ++k) {
    const double size = rules.step * static_cast<double>(k + 1);
    const LatticeSteps& steps = rules.steps[segment][k] = lattice_steps(size, unit);
    rules.has_levels[k] = rules.has_levels[k] || steps[0] != steps[kLevels - 1];
    const bool has_levels = rules.has_levels[kPatchSizes + k] = k >= kLeastSizeWithLevels;
    rules.steps[segment][kPatchSizes + k] = steps_near_skeleton(size, unit, has_levels);
  }
  for (std::size_t k = 0; k < kPatchClasses; ++k) {
    LatticeSteps& most = rules.most_steps[k];
    for (std::size_t level = 0; level < most.size(); ++level)
      most[level] = std::max(most[level], rules.steps[segment][k][level]);
  }
}

void set_blocks(const Hand& hand, double precision, std::size_t segment, PatchRules& rules) {
  const double unit = cube_root(precision / 1e-4), radius = radius_of(hand, segment);
  const bool is_palm = segment == kPalmSegment;
  rules.block_size[segment] = (is_palm ? kBlockBesidePalm : kBlockSize) * unit * radius;
  if (is_palm) rules.block_above_palm = kBlockAbovePalm * unit * radius;
}

}  // namespace

std::uint8_t steps_for(double wanted) {
  const auto steps = static_cast<std::uint8_t>(max(1, std::ceil(wanted - 0.125 * min(wanted, 2))));
  return is_in_quarters(steps) ? static_cast<std::uint8_t>(steps + steps % 2) : steps;
}

PatchRules patch_rules(const Hand& hand, const Settings& settings) {
  PatchRules rules;
  rules.segments = sampled_segments(settings);
  if (rules.segments == 0) return rules;
  const double mean = mean_over(rules.segments, [&](std::size_t i) { return radius_of(hand, i); });
  rules.radius3 = mean_over(rules.segments, [&](std::size_t i) {
    const double radius = radius_of(hand, i);
    return radius * radius * radius;
  });
  const UsualRadius usual{mean, kThinnest * median_radius(hand, rules.segments)};
  const auto unit_of = [&](std::size_t i) { return step_unit(hand, settings, i, usual); };
  double finest = std::numeric_limits<double>::infinity();
  rules.step = finest;
  for_numbers(rules.segments, [&](std::size_t i) {
    rules.step = min(rules.step, kSizeStep * min(unit_of(i), mean));
    finest = min(finest, longer_for(settings.precision[i]));
  });
  for_numbers(rules.segments, [&](std::size_t i) {
    set_lattices(i, unit_of(i), rules);
    set_blocks(hand, settings.precision[i], i, rules);
  });
  for (std::size_t level = 0; level < kLevels; ++level)
    rules.block_on_skin[level] = kBlockOnSkin[level] * finest * mean;
  return rules;
}

}  // namespace lumbrical
