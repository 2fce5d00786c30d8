// What the segments feel of the gaps that hold their cores.
//
// A gap is a point, but stands for a contact about as wide as the core. Near a joint that lies on both
// segments, as the field's would. So of a push at the joint each of them feels half, and farther away the
// neighbour the less, nothing from the core's radius on: what slides over a joint goes from one segment to
// the next without a step, and at the joint it is the same whose gap it is. The neighbour's share acts at the
// joint, the rest so much farther from it that no joint's torque changes.
#pragma once

#include <span>

#include "proxy/core_gaps.h"

namespace lumbrical {

/// Gaps that push, and shares of them: each on one segment.
using PushList = FixedList<Gap, 2 * kMostGapsPerSegment * kSegmentCount>;

/// Lists what `gaps` push the segments with, measured at these joints [W] of the proxy.
void list_pushes(const Hand& hand, const Joints& proxy, std::span<const Gap> gaps, PushList& pushing);

}  // namespace lumbrical
