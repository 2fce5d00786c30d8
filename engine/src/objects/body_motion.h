// How an object moves by itself in a tick: one linearly implicit step of Euler's, in which all that touches
// it is as stiff as it is.
//
//   (M + h D + h^2 K) du = h (f - D u - h K (u - v)),   u += du,   x += h u
//
// K is the stiffness of hand and ground at their patches, v how fast those move, D dampers. So a key of 5 g
// stays stable under 2 kN/m at 1 kHz, where an explicit step would not, without sub-steps; and it damps what
// is too fast for the step. Joints are subspaces: of the six speeds of a body only those count that its joint
// leaves it.
#pragma once

#include <span>

#include "lumbrical/object.h"

namespace lumbrical {

/// Something that touches a body at a point and gives way like a spring along its normal, across it and
/// turned about it.
struct Spring {
  Vec3 arm;                      ///< [m] W, from the centre of mass
  Vec3 normal;                   ///< unit, W
  double along = 0, across = 0;  ///< [N/m]; a damper [N s/m] as a spring of 1/dt of it, slack now
  double about = 0;              ///< [N m/rad]
  Twist anchor{};                ///< W, how what it hangs on moves
  double tilt = 0;               ///< [N m/rad] about the ways across the normal
};

/// [m/s] W, of a body's point that lies `arm` [m, W] from its centre of mass.
inline Vec3 velocity_at(const ObjectState& state, Vec3 arm) {
  return state.velocity + cross(state.angular_velocity, arm);
}

/// Moves a body by `dt` [s] under `wrench` [W, about its centre of mass], of which springs have a part, and
/// which changes as they give way. Returns the speed at which they do: that at the step's end, along the ways
/// that its joint left at the beginning. `start` is where its coordinate is 0.
Twist advance_body(const Mechanism& mechanism, const Pose& start, std::span<const Spring> springs,
                   const Wrench& wrench, double dt, ObjectState& state);

/// How a spring's force on the body changes in a step that ends with this speed: force, and torque about its
/// end.
Wrench change_of(const Spring& spring, const Twist& speed, double dt);

/// Adds its stiffness about the centre of mass, `scale` times.
void add_spring(const Spring& spring, double scale, Matrix6& to);

/// Whether ticks may have left an object of that mobility so, but for rounding: one that stands still is at
/// its start, what a joint holds where the joint lets it be.
bool may_be_at(const Mechanism& mechanism, const Pose& start, const ObjectState& state);

}  // namespace lumbrical
