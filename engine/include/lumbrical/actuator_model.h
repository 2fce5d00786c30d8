// From the torques a touch asks for to what a device can do: a bounded least-squares solve that also tells
// what was lost.
#pragma once

#include <array>
#include <cstdint>

#include "lumbrical/device_profile.h"

namespace lumbrical {

using ActuatorArray = std::array<double, kMaxActuators>;

struct ActuatorSolution {
  ActuatorArray command{};      ///< each in its own unit, within what the actuator can do while active
  JointArray torque{};          ///< [N m] opening torque these commands make
  JointArray lost{};            ///< [N m] wanted minus made
  double lost_norm = 0;         ///< [N m] root of the sum of squares
  std::uint32_t saturated = 0;  ///< bit i: actuator i is at its upper end or, for motors, its lower end
};

/// Commands whose torques come closest to `wanted` [N m, opening] in the sense of least squares: motors
/// between lower and upper, wires between preload and upper, brakes between 0 and upper against the motion of
/// their joints. `speed` [rad/s] > 0 closes; where a brake's joints rest it can hold against a push in
/// whichever sense is wanted, and where they already move in the wanted sense it can do nothing. Of several
/// best answers the one with the smallest commands (relative to their range) beyond the preloads. What is not
/// finite counts as 0. Deterministic; allocates nothing; takes a few microseconds.
ActuatorSolution solve_actuators(const DeviceProfile& profile, const JointArray& wanted,
                                 const JointArray& speed);

}  // namespace lumbrical
