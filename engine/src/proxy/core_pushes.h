// What the segments feel of the gaps that hold their cores.
//
// A gap is a point, but stands for a contact about as wide as the core. Near a joint that lies on both
// segments, as the field's would. So of a push at the joint each of them feels half, and farther away the
// neighbour the less, nothing from the core's radius on: what slides over a joint goes from one segment to
// the next without a step, and at the joint it is the same whose gap it is. The neighbour's share acts at the
// joint, the rest so much farther from it that no joint's torque changes.
//
// Which gaps hold a finger may change from tick to tick, and with that on which segment it is pushed, while
// the finger as a whole feels the same. So what one segment hands on to the next follows that in time. What
// is handed on is a force within the finger: with the couple that keeps every joint's torque it does no work,
// however late it is.
#pragma once

#include <span>

#include "lumbrical/tick.h"
#include "model/primitive.h"
#include "proxy/core_gaps.h"

namespace lumbrical {

/// Gaps that push, and shares of them: each on one segment.
using PushList = FixedList<Gap, 2 * kMostGapsPerSegment * kSegmentCount>;

/// Lists what `gaps` push the segments with, measured at these joints [W] of the proxy.
void list_pushes(const Hand& hand, const Joints& proxy, std::span<const Gap> gaps, PushList& pushing);

/// Once `forces` have all pushes: what more has gone from one segment of a finger to another than the
/// finger's whole has changed by follows in time. No joint's torque changes, nor the finger's force. `anew`:
/// forces are of another hand than in the last tick.
void hand_on(const PushList& pushing, const Primitives& hand, double rate, bool anew, ProxyState& kept,
             HandForces& forces);

}  // namespace lumbrical
