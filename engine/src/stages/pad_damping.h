// Damping of pads (Pad::damping): a force grows as it is pressed in and shrinks as it is let go, as Hunt and
// Crossley's does (1975): F (1 + c v). It begins and ends with the force, and never turns it round.
#pragma once

#include <array>
#include <optional>

#include "lumbrical/tick.h"
#include "model/primitive.h"

namespace lumbrical {

/// [m/s] of segments' base joints, [rad/s], W.
using PadSpeeds = std::array<Twist, kSegmentCount>;

/// Of what went from one pose to the other in a tick.
Twist speed_between(const Pose& from, const Pose& to, double rate);

/// How fast the placed hand's segments move, from where they were a tick before; keeps where they are. All 0
/// without damping, and where there was no tick before that could be trusted.
PadSpeeds speeds_of_pads(const Settings& settings, bool trusted, const Primitives& hand,
                         std::optional<PadState>& pad);

/// -1 .. 1: by which share the force grows of a segment that feels `wrench` about its base joint and moves so
/// relative to what it touches.
double damping_share(double damping, const Wrench& wrench, const Twist& speed);

/// Damps what segments feel of a world that stands still.
void damp_pads(const Pad& pad, const PadSpeeds& speeds, const Primitives& hand, HandForces& forces);

}  // namespace lumbrical
