// The plane that free bodies rest on, at a few points of each: springs so stiff that nobody sees them give
// way, with friction like a finger's (friction.h).
#pragma once

#include <array>
#include <span>

#include "base/fixed_list.h"
#include "lumbrical/tick.h"
#include "objects/body_motion.h"
#include "objects/friction.h"

namespace lumbrical {

/// All that touches a body.
using Springs = FixedList<Spring, kMostHands * kSegmentCount + kMostSupports>;

/// Of each point that a body rests on.
using SupportShares = std::array<Share, kMostSupports>;

/// What the ground does to a body of this mass and weight [N] that all else presses against it with `load`
/// [N], `dt` [s] after the last tick, about its centre of mass, W; updates the supports' states, and appends
/// those that carry it to `springs`. `expected` is the speed with which the step may end; `sticks`, of each
/// point, goes from one attempt at the step to the next.
Wrench rest_on(const Ground& ground, std::span<const Vec3> points, const MassProperties& body, double weight,
               double load, const Twist& expected, double dt, SupportShares& sticks, ObjectState& state,
               Springs& springs);

}  // namespace lumbrical
