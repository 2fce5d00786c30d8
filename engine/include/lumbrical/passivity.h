// How stiff a joint may be rendered, and what keeps it from shaking all the same: the stiffness certificate,
// a limiter that holds the contact's stiffness under it, and a passivity observer and controller per joint.
//
// Angles close the hand, torques open it: power tau * dq/dt is what the hand gives to the device.
#pragma once

#include <array>
#include <cstdint>

#include "lumbrical/device_profile.h"
#include "lumbrical/jacobian.h"

namespace lumbrical {

/// What was measured of the loop, device excepted.
struct LoopTiming {
  double period = 0.001;  ///< [s] between two commands that reach the device
  double jitter = 0;      ///< [s] by which a period may be longer
  double delay = 0;       ///< [s] from reading an angle to its torque, beyond the hold of one period
};

/// Largest passive stiffness of one joint, each bound by itself [N m/rad].
struct StiffnessBound {
  double sampled = 0;   ///< 2 b / T (Colgate and Schenkel, 1994)
  double delayed = 0;   ///< b / (T / 2 + t_d) (the same with a delay)
  double friction = 0;  ///< 2 f_c / D (Abbott and Okamura, 2005); infinite where the encoder has no step
  double largest = 0;   ///< the least of them: a spring stiffer than this can shake
};

StiffnessBound stiffness_bound(const LoopTiming& timing, const JointDynamics& joint);

struct StiffnessCertificate {
  LoopTiming timing;
  double margin = 0.8;  ///< share of `largest` the limiter allows
  std::array<StiffnessBound, kPhalanxCount> joint{};
  /// Joints whose damping the profile doesn't say have no bound: false, and nothing is limited there.
  std::array<bool, kPhalanxCount> known{};
};

StiffnessCertificate make_certificate(const DeviceProfile& profile, const LoopTiming& timing);

/// [N m/rad] for each finger: how the opening torque of its joint i grows as its joint k closes.
using FingerStiffness = std::array<std::array<double, 3>, 3>;
using HandStiffness = std::array<FingerStiffness, kFingerCount>;

/// Stiffness of the joints from the segments' Jacobians and wrenches, for the hand whose joints stand at
/// `X_WJ` and flex about their x axes. Includes how levers and axes turn with the joints before them.
HandStiffness joint_stiffness(const std::array<Pose, kJointCount>& X_WJ, const HandForces& forces,
                              const std::array<SegmentJacobian, kSegmentCount>& jacobians);

/// A factor per finger, 0 .. 1, that holds its stiffness below the certificate's.
struct StiffnessLimiter {
  std::array<double, kFingerCount> factor = {1, 1, 1, 1, 1};
};

/// One step of `dt` [s]. Stiffness matrix and bounds of a finger are compared by the largest gain of
/// D^-1/2 K D^-1/2 (its Frobenius norm, which is no less; for a single contact equal), D holding margin times
/// the bounds. A factor falls at once and recovers with the time constant of one second, so that it does not
/// itself become part of a fast loop.
void limit_stiffness(const StiffnessCertificate& certificate, const HandStiffness& stiffness, double dt,
                     StiffnessLimiter& limiter);

/// Time-domain passivity observer and controller of one joint (Hannaford and Ryu, 2002). The energy is exact
/// for a torque that is held between two samples (Stramigioli): what is observed is what the device did.
struct PassivityObserver {
  double energy = 0;     ///< [J] taken from the hand in this touch and not yet given back; < 0: generated
  double generated = 0;  ///< [J] the lowest `energy` ever was, as a positive number
  double bled = 0;       ///< [J] taken back by the controller's damping
  double angle = 0;      ///< [rad] last
  bool started = false;
};

struct PassivityLimits {
  double damping = 0.01;    ///< [N m s/rad] largest the controller may add; keep below the device's own
  double tolerance = 1e-6;  ///< [J] of generated energy that is let pass: encoder steps make some
};

struct PassivityStep {
  double dt = 0.001;  ///< [s] since the last step
  double angle = 0;   ///< [rad] the newest
  double acted = 0;   ///< [N m] the torque the device made since the last step
  double torque = 0;  ///< [N m] what the touch asks for now
  double given = 0;   ///< [J] what the touch has taken elsewhere since the last step: see arm_work
};

/// Returns what to command: the torque, plus damping while more energy than the tolerance has been generated.
/// Without touch (both torques 0) the account is closed: what an earlier touch has taken must not pay for
/// what a later one gives.
double observe_passivity(const PassivityLimits& limits, const PassivityStep& step,
                         PassivityObserver& observer);

/// [J] what each finger's touch takes from the arm when the wrist moves from one pose to another [both X_WH].
/// The arm feels none of it, but it comes back through the joints, and the observers must know.
std::array<double, kFingerCount> arm_work(const Pose& before, const Pose& after,
                                          const std::array<Pose, kJointCount>& X_WJ,
                                          const HandForces& forces);

}  // namespace lumbrical
