// The narrowphase of the rungs of samples: from a posed hand to the wrench of every segment, in a few passes
// over arrays. Search the blocks near every body; classify their patches; put them in order of kind and size;
// sixteen at a time, gather, kernel, sum.
//
// Sums do not care for their order: every number that enters one is first rounded to a multiple of a fixed
// quantum, so that adding is exact, whatever found a patch and on however many threads.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lumbrical/model.h"
#include "samples/sample_kernels.h"

namespace lumbrical {

struct Primitives;

/// What the sampled segments feel, before limits.
struct SampledForces {
  /// Of a stiffness of 1: [m^3], [m^4] about the joint at the segment's base.
  std::array<Wrench, kSegmentCount> segment{};
  std::uint32_t patch_count = 0;    ///< near bodies, those of blocks taken as wholes counted as one
  std::uint32_t contact_count = 0;  ///< pairs of a body and a patch it touches
};

/// Working memory, sized once for a model, and the last tick's result.
struct SampleMemory {
  SampledForces forces;
  Bodies bodies;
  std::array<std::vector<std::uint32_t>, 2> frontier;  ///< of the search
  std::vector<FoundPatch> found;                       ///< patches near the bodies, body by body
  std::vector<std::uint32_t> ordered;                  ///< their places, by kind and size within a body
};

void size_samples(const Model& model, SampleMemory& memory);

inline constexpr std::uint32_t kAllSegments = (1u << kSegmentCount) - 1;

/// Segments that are felt by samples, a bit each.
std::uint32_t sampled_segments(const Model& model);

/// Are a segment and a triangle left out by the exact rung?
bool felt_by_samples(const Model& model, std::size_t segment, std::uint32_t triangle);

/// Forces on those of `segments`. False where more patches are near than there is room for
/// (Settings::max_candidates).
bool sample_forces(const Model& model, const Primitives& hand, std::uint32_t segments, SampleMemory& memory,
                   SampledForces& forces);

}  // namespace lumbrical
