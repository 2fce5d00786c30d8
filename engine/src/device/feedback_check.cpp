// See feedback_check.h.
#include "device/feedback_check.h"

#include <algorithm>
#include <cmath>

#include "base/steady_clock.h"
#include "lumbrical/math.h"
#include "lumbrical/safety.h"

namespace lumbrical {
namespace {

constexpr double kSlack = 0.01;      // [rad] that an angle may be off by without being wrong
constexpr double kShowsStops = 0.5;  // [rad] that a joint has moved by which has been at them

struct JointTorque {
  double now = 0, span = 0;  // [N m]
};

// Of what drives it: a brake's torque moves nothing.
JointTorque torque_about(const DeviceProfile& profile, const ActuatorArray& acted, std::size_t joint) {
  JointTorque torque;
  for (std::size_t i = 0; i < profile.actuators.size(); ++i) {
    const Actuator& actuator = profile.actuators[i];
    if (actuator.drive == Drive::brake) continue;
    torque.now += actuator.arm[joint] * acted[i];
    torque.span += std::fabs(actuator.arm[joint]) * (actuator.upper - actuator.lower);
  }
  return torque;
}

// In a time within which nothing was believed, a finger that comes back has not gone `on`.
bool jumps(const JointDynamics& joint, float from, float to, double passed, bool on) {
  const double moved = std::fabs(static_cast<double>(to) - static_cast<double>(from));
  const double beyond = on ? kFastFinger * max(0, passed - kFarthestAtOnce / kFastestJoint) : 0;
  const double way = min(kFastestJoint * passed, kFarthestAtOnce + beyond);
  return moved > way + 2 * joint.encoder_step + kSlack;
}

// Of one that can't have followed what was believed. A sensor that has slipped says what is possible from one
// answer to the next: force at another place than before comes from nothing, and softly.
bool has_settled(const DeviceProfile& profile, const JointDynamics& joint, float angle,
                 const DeviceFeedback& feedback, AngleMemory& memory) {
  const double passed = in_seconds(feedback.time - memory.said_at);
  const bool follows = memory.steady != 0 && !jumps(joint, memory.said, angle, passed, true);
  if (!follows) memory.steady = feedback.asked;
  memory.said = angle;
  memory.said_at = feedback.asked;
  return follows && in_seconds(feedback.asked - memory.steady) >= max(kSettling, profile.safety.fade);
}

bool is_believable(const DeviceProfile& profile, const JointDynamics& joint, float angle,
                   const DeviceFeedback& feedback, AngleMemory& memory) {
  const bool doubted = (memory.doubt & (kAngleJumped | kAngleOutOfRange)) != 0;
  const double passed = in_seconds(feedback.time - memory.asked);
  return memory.asked == 0 || !jumps(joint, memory.believed, angle, passed, !doubted) ||
         has_settled(profile, joint, angle, feedback, memory);
}

void believe(float angle, std::int64_t asked, AngleMemory& memory) {
  const bool first = memory.asked == 0;
  memory.least = first ? angle : std::min(memory.least, angle);
  memory.most = first ? angle : std::max(memory.most, angle);
  memory.believed = angle;
  memory.asked = asked;
  memory.doubt = 0;
  memory.steady = 0;
}

// [N m] Of what opens the joint, what must move it: at an end of its sensor's range, and where it was never
// opened or closed farther, it may stand at its stop.
double moving_torque(double torque, float angle, const Sensor& sensor, double step,
                     const AngleMemory& memory) {
  const auto least = static_cast<double>(memory.least), most = static_cast<double>(memory.most),
             now = static_cast<double>(angle);
  const bool shown = most - least >= kShowsStops;
  if (now <= sensor.lower + kSlack + step || (shown && now < least + kSlack)) torque = min(0, torque);
  if (now >= sensor.upper - kSlack - step || (shown && now > most - kSlack)) torque = max(0, torque);
  return torque;
}

void remember_torque(double torque, float angle, std::int64_t now, AngleMemory& memory) {
  const bool moves = memory.since == 0 || angle != memory.still;
  if (moves) {
    memory.still = angle;
    memory.since = now;
  }
  const double age = in_seconds(now - memory.turned);  // longer than twice as long ago after a silence
  if (moves || age >= kStillTime) {
    const TorqueRange only{torque, torque};
    memory.older = moves || age >= 2 * kStillTime ? only : memory.newer;
    memory.newer = only;
    memory.turned = now;
  }
  memory.newer = {min(memory.newer.low, torque), max(memory.newer.high, torque)};
}

bool is_held(const JointDynamics& joint, double span, std::int64_t now, const AngleMemory& memory) {
  const double low = min(memory.newer.low, memory.older.low),
               high = max(memory.newer.high, memory.older.high);
  const bool still = in_seconds(now - memory.since) >= kStillTime;
  return still && span > 0 && high - low > max(kStillShare * span, 4 * joint.friction);
}

}  // namespace

void check_feedback(const DeviceProfile& profile, DeviceFeedback& feedback, FeedbackMemory& memory) {
  feedback.flags = 0;
  for (const Sensor& sensor : profile.sensors) {
    const auto a = static_cast<std::size_t>(sensor.angle);
    const std::uint32_t bit = 1u << a;
    const std::size_t joint = sensed_joint(sensor);
    const JointDynamics& dynamics = profile.dynamics[joint];
    const bool in_range = (feedback.valid & bit) != 0;
    if (!in_range) memory[a].steady = 0;
    if (!in_range || !is_believable(profile, dynamics, feedback.angle[a], feedback, memory[a])) {
      memory[a].doubt = in_range ? kAngleJumped : kAngleOutOfRange;
      feedback.flags |= memory[a].doubt;
      feedback.valid &= ~bit;
      feedback.angle[a] = memory[a].believed;
      continue;
    }
    believe(feedback.angle[a], feedback.asked, memory[a]);
    if (!is_flexion(sensor)) continue;
    // Once stuck it is so until it moves: without torques, which end with the doubt, it would be believed
    // again.
    const bool stays_stuck = memory[a].stuck && feedback.angle[a] == memory[a].still;
    const JointTorque torque = torque_about(profile, feedback.acted, joint);
    const double moving =
        moving_torque(torque.now, feedback.angle[a], sensor, dynamics.encoder_step, memory[a]);
    remember_torque(moving, feedback.angle[a], feedback.time, memory[a]);
    memory[a].stuck = stays_stuck || is_held(dynamics, torque.span, feedback.time, memory[a]);
    if (memory[a].stuck) {
      feedback.flags |= memory[a].doubt = kAngleStuck;
      feedback.valid &= ~bit;
    }
  }
}

}  // namespace lumbrical
