// The plane that free bodies rest on, at a few points of each: springs so stiff that nobody sees them give
// way, with friction like a finger's (friction.h).
#pragma once

#include <array>
#include <span>

#include "lumbrical/object.h"
#include "objects/body_motion.h"

namespace lumbrical {

struct Support {
  std::array<Spring, kMostSupports> spring;
  std::size_t count = 0;
  Wrench wrench;  ///< of all of them on the body, about its centre of mass, W
};

/// What the ground does to a body of this mass and weight [N], `dt` [s] after the last tick; updates the
/// supports' states.
Support rest_on(const Ground& ground, std::span<const Vec3> points, const MassProperties& body, double weight,
                double dt, ObjectState& state);

}  // namespace lumbrical
