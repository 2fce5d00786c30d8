// See lumbrical/passivity.h.
#include "lumbrical/passivity.h"

#include <cmath>
#include <limits>
#include <utility>

#include "base/small_turn.h"
#include "base/vector6.h"
#include "lumbrical/math.h"

namespace lumbrical {
namespace {

// What a limiter's factor recovers with; slow against anything that shakes [s].
constexpr double kRecovery = 1;
// What a bound that shrinks is followed with down to the margin, once below the bound itself [s].
constexpr double kEase = 2;
// How many times too stiff a touch may stay that has got stiffer as it deepened.
constexpr double kFarTooStiff = 2.5;
// What torques grow with that no motion asked for, as after a gap [s].
constexpr double kCreep = 2;

double quotient(double a, double b) { return b > 0 ? a / b : std::numeric_limits<double>::infinity(); }

struct JointAxis {
  Vec3 at;    // [m] in W
  Vec3 axis;  // about which it opens; closing turns about -axis
};

// How wrench and lever of segment s turn with joint k of the same finger, k at or before s.
struct Turned {
  Vec3 force, torque, base;
};

Turned turn_segment(const JointAxis& joint, Vec3 base, const SegmentJacobian& jacobian) {
  const Vec3 turn = -joint.axis;  // one radian of closing
  const Vec3 move = cross(turn, base - joint.at);
  const Vector6 change = times(jacobian.value, vector_of(move, turn));
  return {{change[0], change[1], change[2]}, {change[3], change[4], change[5]}, move};
}

FingerStiffness finger_stiffness(std::size_t finger, const std::array<JointAxis, 3>& joints,
                                 const HandForces& forces,
                                 const std::array<SegmentJacobian, kSegmentCount>& jacobians) {
  FingerStiffness stiffness{};
  for (std::size_t s = 0; s < 3; ++s) {
    const Wrench& wrench = forces.segment[3 * finger + s];
    for (std::size_t k = 0; k <= s; ++k) {
      const Turned d = turn_segment(joints[k], joints[s].at, jacobians[3 * finger + s]);
      for (std::size_t i = 0; i <= s; ++i) {
        const JointAxis& joint = joints[i];
        const Vec3 turn = -joints[k].axis;
        const Vec3 joint_moves = i > k ? cross(turn, joint.at - joints[k].at) : Vec3{};
        const Vec3 axis_turns = i > k ? cross(turn, joint.axis) : Vec3{};
        const Vec3 lever = joints[s].at - joint.at;
        const Vec3 torque = wrench.torque + cross(lever, wrench.force);
        const Vec3 change = d.torque + cross(d.base - joint_moves, wrench.force) + cross(lever, d.force);
        stiffness[i][k] += dot(joint.axis, change) + dot(axis_turns, torque);
      }
    }
  }
  return stiffness;
}

}  // namespace

StiffnessBound stiffness_bound(const LoopTiming& timing, const JointDynamics& joint) {
  const double period = timing.period + timing.jitter;
  StiffnessBound bound;
  bound.sampled = quotient(2 * joint.damping, period);
  bound.delayed = quotient(joint.damping, 0.5 * period + timing.delay);
  bound.friction = quotient(2 * joint.friction, joint.encoder_step);
  bound.largest = min(min(bound.sampled, bound.delayed), bound.friction);
  return bound;
}

StiffnessCertificate make_certificate(const DeviceProfile& profile, const LoopTiming& timing) {
  StiffnessCertificate certificate;
  certificate.timing = timing;
  for (std::size_t j = 0; j < kPhalanxCount; ++j) {
    const LoopTiming whole{timing.period, timing.jitter, timing.delay + own_delay(profile, j)};
    certificate.joint[j] = stiffness_bound(whole, profile.dynamics[j]);
    certificate.known[j] = profile.dynamics[j].damping > 0;
  }
  return certificate;
}

HandStiffness joint_stiffness(const std::array<Pose, kJointCount>& X_WJ, const HandForces& forces,
                              const std::array<SegmentJacobian, kSegmentCount>& jacobians) {
  HandStiffness stiffness{};
  for (std::size_t finger = 0; finger < kFingerCount; ++finger) {
    std::array<JointAxis, 3> joints;
    for (std::size_t s = 0; s < 3; ++s) {
      const Pose& pose = X_WJ[kPhalanxJoints[3 * finger + s].base];
      joints[s] = {pose.position, rotate(pose.orientation, {1, 0, 0})};
    }
    stiffness[finger] = finger_stiffness(finger, joints, forces, jacobians);
  }
  return stiffness;
}

void limit_stiffness(const StiffnessCertificate& certificate, const HandStiffness& stiffness,
                     const JointArray& torque, double dt, StiffnessLimiter& limiter) {
  for (std::size_t finger = 0; finger < kFingerCount; ++finger) {
    double squares = 0, size = 0, bound = std::numeric_limits<double>::infinity();
    for (std::size_t j = 3 * finger; j < 3 * finger + 3; ++j) {
      size += torque[j] * torque[j];
      if (certificate.known[j]) bound = min(bound, certificate.joint[j].largest);
    }
    size = std::sqrt(size);
    const double before = std::exchange(limiter.torque[finger], size);
    const double allowed_before = limiter.allowed[finger];
    const double eased = min(bound, allowed_before) * (1 - min(1, max(0, dt) / kEase));
    const double allowed = max(certificate.margin * bound, eased);
    limiter.allowed[finger] = allowed;
    const double share = bound > 0 && is_finite(bound) ? allowed / bound : certificate.margin;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t a = 3 * finger + i, b = 3 * finger + k;
        if (!certificate.known[a] || !certificate.known[b]) continue;
        const double most =
            share * std::sqrt(certificate.joint[a].largest) * std::sqrt(certificate.joint[b].largest);
        const double part = stiffness[finger][i][k] / most;
        squares += part * part;
      }
    }
    const double gain = std::sqrt(squares);
    const double wanted = gain > 1 ? 1 / gain : gain <= 1 ? 1 : 0;  // NaN: nothing can be promised
    limiter.passive[finger] = wanted;
    // What the torque has grown by and what is allowed has shrunk by since the last step: so far the factor
    // may fall at once. A torque that stays where it is is let down slowly while it is far too stiff; nearer
    // to what is passive the hand's own damping makes up for it, and letting go of a touch is felt, too.
    double& factor = limiter.factor[finger];
    const double shrunk = allowed < allowed_before ? allowed / allowed_before : 1;
    const double slowly = factor > kFarTooStiff * wanted ? 1 - min(1, max(0, dt) / kEase) : 1;
    const double held = size > 0 ? min(slowly, before / size) * shrunk : 0;
    factor = wanted < factor ? max(wanted, held * factor)
                             : factor + (wanted - factor) * min(1, max(0, dt) / kRecovery);
  }
}

void keep_account(const StiffnessCertificate& certificate, const DeviceProfile& profile, std::size_t finger,
                  const EnergyStep& step, EnergyAccount& account) {
  double touch = step.given, damped = 0, bent = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t j = 3 * finger + k;
    const JointDynamics& joint = profile.dynamics[j];
    // The least that viscous damping takes over a way in a time is at even speed; a way that rounding to
    // encoder steps may have invented doesn't count.
    const double way = max(0, std::fabs(step.moved[k]) - joint.encoder_step);
    touch += step.acted[k] * step.moved[k];
    const double time = step.dt + step.held[k];
    if (time > 0) damped += certificate.margin * joint.damping * way * way / time;
    if (certificate.known[j])
      bent += 0.5 * certificate.margin * certificate.joint[j].largest * step.moved[k] * step.moved[k];
  }
  const bool finite = is_finite(touch + damped) && is_finite(bent);
  account.energy = finite ? account.energy + touch + damped : min(0, account.energy);
  if (!step.touching) account.energy = min(0, account.energy);
  account.generated = max(account.generated, -account.energy);
  if (!finite || touch < 0) return;  // a spring that gives back what it holds grows by no way
  const double reach = account.reach + std::sqrt(bent);
  account.reach = std::sqrt(reach * reach + max(0, step.given));
}

double pay(const StiffnessCertificate& certificate, std::size_t finger, const std::array<double, 3>& torque,
           double dt, EnergyAccount& account) {
  double needed = 0, softest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t j = 3 * finger + k;
    if (!certificate.known[j] || torque[k] == 0) continue;
    const double allowed = certificate.margin * certificate.joint[j].largest;
    needed += quotient(0.5 * torque[k] * torque[k], allowed);
    softest = min(softest, allowed);
  }
  if (needed == 0) {
    if (account.reach > 0) account.energy = min(0, account.energy);  // until now something was wanted
    account.reach = 0;
    return 1;
  }
  const double lent = min(kMostLent, 0.5 * softest * kLentWay * kLentWay);
  const double most = std::sqrt(max(0, account.energy + lent));
  double& reach = account.reach;
  reach = max(reach, std::sqrt(lent));
  reach += max(0, min(reach, most - reach)) * min(1, max(0, dt) / kCreep);
  reach = min(reach, most);
  const double wanted = std::sqrt(needed);
  if (wanted > reach) return reach / wanted;
  reach = wanted;
  return 1;
}

void renew_account(const StiffnessCertificate& before, const StiffnessCertificate& after, std::size_t finger,
                   EnergyAccount& account) {
  double softer = 0;  // how many times: energy at the same torque goes with it
  for (std::size_t j = 3 * finger; j < 3 * finger + 3; ++j) {
    const double ratio = quotient(before.joint[j].largest, after.joint[j].largest);
    if (before.known[j] && after.known[j] && is_finite(ratio)) softer = max(softer, ratio);
  }
  if (softer > 0) account.reach *= std::sqrt(softer);
}

std::array<double, kFingerCount> arm_work(const Pose& before, const Pose& after,
                                          const std::array<Pose, kJointCount>& X_WJ,
                                          const HandForces& forces) {
  const Vec3 moved = after.position - before.position;
  const Vec3 turned = small_turn(before.orientation, after.orientation);
  std::array<double, kFingerCount> work{};
  for (std::size_t s = 0; s < kPhalanxCount; ++s) {
    const Vec3 lever = X_WJ[kPhalanxJoints[s].base].position - after.position;
    const Wrench& wrench = forces.segment[s];
    work[s / 3] -= dot(wrench.force, moved + cross(turned, lever)) + dot(wrench.torque, turned);
  }
  return work;
}

}  // namespace lumbrical
