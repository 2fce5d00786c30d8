// Damping of pads (Pad::damping): a force grows as it is pressed in and shrinks as it is let go, as Hunt and
// Crossley's does (1975): F (1 + c v). It begins and ends with the force, and never turns it round.
#pragma once

#include <array>

#include "lumbrical/tick.h"
#include "model/primitive.h"

namespace lumbrical {

/// By which share the force would grow of a segment that feels `wrench` about its base joint and moves so
/// relative to what it touches; in the frame of the placed hand.
double damping_wanted(double damping, const Primitives& hand, std::size_t segment, const Wrench& wrench,
                      const Twist& speed);

/// By which it does: -1 .. 1.
constexpr double damping_share(double wanted) { return clamp(wanted, -1, 1); }

/// Damps what segments feel of a world that stands still; `speed` is that of their base joints.
void damp_pads(const Pad& pad, const std::array<Twist, kSegmentCount>& speed, const Primitives& hand,
               HandForces& forces);

}  // namespace lumbrical
