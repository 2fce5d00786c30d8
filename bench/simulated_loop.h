// One joint of a simulated device pressed against a touch, over a bus with period, delay and jitter: where
// the loop starts to shake, and what limiter, energy account and local model change. bench/z_width.cpp prints
// the tables, the tests run them smaller. Simulated time throughout: the same figures on every machine.
#pragma once

#include <functional>

#include "lumbrical/device_simulation.h"
#include "lumbrical/passivity.h"

namespace lumbrical::bench {

struct Touched {
  double torque = 0;     ///< [N m] opening
  double stiffness = 0;  ///< [N m/rad]
};
using Touch = std::function<Touched(double angle)>;

Touch linear_wall(double stiffness);  ///< at angle 0, one-sided
/// A wall whose stiffness grows as the root of depth and is `stiffness` at 0.1 rad, as a sphere's is under
/// the field law.
Touch round_wall(double stiffness);
/// A fingertip of the real engine on a plane, moved by the first joint of the index.
Touch engine_touch(double stiffness_per_volume);

struct SimulatedLoop {
  JointDynamics dynamics{4e-5, 0.01, 0, 0};
  HumanJoint human{0, 0};        ///< worst case: no hold at all, only `push`
  double push = 0.02;            ///< [N m] closing, constant
  double middle = 0, sweep = 0;  ///< [rad] of the human's target; they need human.stiffness
  double period = 0.001;         ///< [s] of commands
  double delay = 0.001;          ///< [s] from reading the angle to its torque
  double jitter = 0;             ///< [s] by which a command may come later
  bool limiter = false, account = false;
  double local_period = 0;  ///< [s] of the device's own loop; 0: it holds the torque
  double seconds = 3;
  double start = 0.02;  ///< [rad] at which the joint is let go, at rest
};

struct LoopOutcome {
  double swing = 0;         ///< [rad] between the extremes in the last fifth of the time
  double generated = 0;     ///< [J] that the device has given beyond what it took, at worst
  double felt_error = 0;    ///< root mean square of acting less ideal torque, as a share of the ideal's
  double least_factor = 1;  ///< of the limiter
  bool shakes = false;      ///< swing of more than ten times what an encoder step or 0.1 mrad would explain
};
LoopOutcome simulate(const SimulatedLoop& loop, const Touch& touch);

/// The stiffness at which the linear wall starts to shake, to two percent [N m/rad].
double shaking_stiffness(SimulatedLoop loop);

}  // namespace lumbrical::bench
