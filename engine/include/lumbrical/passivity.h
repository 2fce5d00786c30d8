// How stiff a joint may be rendered, and what keeps it from shaking all the same: the stiffness certificate,
// a limiter that holds the contact's stiffness under it, and an energy account per finger.
//
// Angles close the hand, torques open it: power tau * dq/dt is what the hand gives to the device.
#pragma once

#include <array>

#include "lumbrical/device_profile.h"
#include "lumbrical/jacobian.h"
#include "lumbrical/loop_timing.h"

namespace lumbrical {

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

/// `timing` is the bus's; what the device itself takes (own_delay) is added joint by joint.
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
  std::array<double, kFingerCount> passive = factor;     ///< where the factors are drawn to
  std::array<double, kFingerCount> torque{}, allowed{};  ///< [N m], [N m/rad] of the last step
};

/// One step of `dt` [s]; `torque` [N m] is what the touch asks for. Stiffness matrix and bounds of a finger
/// are compared by the largest gain of D^-1/2 K D^-1/2 (its Frobenius norm, which is no less; for a single
/// contact equal), D holding margin times the bounds. A factor
/// - falls at once, but while the touch gets stiffer with depth no further than holds the torque where it is:
///   a torque that fell fast as a finger goes deeper would draw it in;
/// - goes on falling from there with a time constant of two seconds where the touch stays far too stiff, 2.5
///   times and more;
/// - falls with the bounds where these shrink: at once to where the touch is passive, without the margin, and
///   in two seconds to the margin, since a small change of the bus is no reason for a kick;
/// - recovers with the time constant of one second, so that it does not itself become part of a fast loop.
void limit_stiffness(const StiffnessCertificate& certificate, const HandStiffness& stiffness,
                     const JointArray& torque, double dt, StiffnessLimiter& limiter);

/// What one finger has taken from the hand in this touch and not yet given back: a passivity observer in the
/// time domain (Hannaford and Ryu, 2002), exact for torques held between two samples (Stramigioli). What the
/// device's own damping takes, which the certificate counts on, is on the account too: the balance is that of
/// the hand, not of the motors.
struct EnergyAccount {
  double energy = 0;     ///< [J] < 0: generated
  double generated = 0;  ///< [J] the lowest `energy` ever was, as a positive number
  double reach = 0;      ///< [sqrt J] what the torques of now may grow to: see pay
};

/// What happened between two fresh samples of a finger's joints. Stale ones tell nothing and are no step.
struct EnergyStep {
  double dt = 0.001;              ///< [s] between them; in doubt longer
  std::array<double, 3> moved{};  ///< [rad] closing
  std::array<double, 3> acted{};  ///< [N m] the torques the device made meanwhile, wires' preload left out
  double given = 0;               ///< [J] what the touch has taken elsewhere: see arm_work
  bool touching = false;          ///< torques act or are wanted
  std::array<double, 3> held{};   ///< [s] before it without a change of the angle: its way took so long, too
};

/// Without touch the account is closed: what an earlier touch has taken must not pay for what a later one
/// gives, but what it has given too much stays owed. A step with a number that isn't finite closes it too.
void keep_account(const StiffnessCertificate& certificate, const DeviceProfile& profile, std::size_t finger,
                  const EnergyStep& step, EnergyAccount& account);

/// The largest share, 0 .. 1, of a finger's torques [N m] that its account pays for; one step of `dt` [s].
///
/// A spring as stiff as the certificate allows, bent until it gives those torques, holds torque^2 / (2 K).
/// - It is bent no further than the account and a loan can pay for.
/// - While the touch takes more than it gives, the torques grow from step to step by no more than such a
///   spring's would over the way the joints went, or what the arm has put in.
/// - But for that they creep, by half of what they are in a second.
/// - Where nothing is wanted any more the touch is over and its account closed, though a bus may still
///   deliver what was.
///
/// So they are no stiffer than that spring, and end when what was taken is given back, whatever the touch,
/// its law, or the delay. Scaling only ever takes away: it can't shake by itself.
double pay(const StiffnessCertificate& certificate, std::size_t finger, const std::array<double, 3>& torque,
           double dt, EnergyAccount& account);

/// With another certificate: what the finger's torques may grow to stays what it was. A bound that has shrunk
/// is the limiter's affair.
void renew_account(const StiffnessCertificate& before, const StiffnessCertificate& after, std::size_t finger,
                   EnergyAccount& account);

/// Lent to a finger, so that a touch can begin: what the stiffest allowed spring holds this far in [rad], and
/// at most so much [J].
inline constexpr double kLentWay = 0.005, kMostLent = 1e-4;

/// [J] what each finger's touch takes from the arm when the wrist moves from one pose to another [both X_WH].
/// The arm feels none of it, but it comes back through the joints, and the observers must know.
std::array<double, kFingerCount> arm_work(const Pose& before, const Pose& after,
                                          const std::array<Pose, kJointCount>& X_WJ,
                                          const HandForces& forces);

}  // namespace lumbrical
