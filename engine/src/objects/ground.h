// The plane that free bodies rest on, at a few points of each: springs so stiff that nobody sees them give
// way, with friction like a finger's (friction.h).
#pragma once

#include <span>

#include "base/fixed_list.h"
#include "lumbrical/tick.h"
#include "objects/body_motion.h"

namespace lumbrical {

/// All that touches a body.
using Springs = FixedList<Spring, kMostHands * kSegmentCount + kMostSupports>;

/// What the ground does to a body of this mass and weight [N] that all else presses against it with `load`
/// [N], `dt` [s] after the last tick, about its centre of mass, W; updates the supports' states, and appends
/// those that carry it to `springs`.
Wrench rest_on(const Ground& ground, std::span<const Vec3> points, const MassProperties& body, double weight,
               double load, double dt, ObjectState& state, Springs& springs);

}  // namespace lumbrical
