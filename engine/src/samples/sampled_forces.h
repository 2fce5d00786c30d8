// The narrowphase of the rungs of samples: from a posed hand to the wrench of every segment, in a few passes
// over arrays. Search the blocks near every body, classify their patches, put them in order of size and kind
// (sample_search.h); then, sixteen at a time, gather, kernel, sum: what is smooth by rules, the rest by
// lattices, as fine as the hand's force calls for (levels.h).
//
// Sums do not care for their order: every number that enters one is first rounded to a multiple of a fixed
// quantum, so that adding is exact, whatever found a patch and on however many threads.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lumbrical/model.h"
#include "samples/levels.h"
#include "samples/sample_lists.h"

namespace lumbrical {

/// What the sampled segments feel, before limits.
struct SampledForces {
  /// Of a stiffness of 1: [m^3], [m^4] about the joint at the segment's base.
  std::array<Wrench, kSegmentCount> segment{};
  Fineness fineness;
  std::uint64_t evaluations = 0;  ///< of a field
  double error_factor = 1;        ///< how many times the error is what the precision asks, by estimate
  bool coarsened = false;         ///< to stay within Settings::effort
  std::uint32_t patch_count = 0;  ///< near bodies, those of blocks taken as wholes counted as one
  /// Pairs of a segment and a patch it touches. Patches that are felt finely count by their quarters
  /// (is_in_quarters), blocks as ones as sixteen patches.
  std::uint32_t contact_count = 0;
};

/// Working memory, sized once for a model, and the last tick's result.
struct SampleMemory {
  SampledForces forces;
  std::uint64_t spent = 0;  ///< of Settings::effort, by what the same tick has felt before
  Bodies bodies;
  PatchSearchMemory search;
  NearPatches near;
  std::vector<SampleThread> thread;
};

void size_samples(const Model& model, SampleMemory& memory);

inline constexpr std::uint32_t kAllSegments = (1u << kSegmentCount) - 1;

/// Segments that are felt by samples, a bit each.
std::uint32_t sampled_segments(const Model& model);

/// Forces on those of `segments`; as finely as the force calls for and Settings::effort allows, or as
/// `given`. False where more patches are near than there is room for (Settings::max_candidates).
bool sample_forces(const Model& model, const Primitives& hand, std::uint32_t segments, SampleMemory& memory,
                   SampledForces& forces, const Fineness* given = nullptr);

/// To feel a hand again that has hardly moved; null where nothing was near.
inline const Fineness* fineness_of(const SampledForces& forces) {
  return forces.evaluations > 0 ? &forces.fineness : nullptr;
}

}  // namespace lumbrical
