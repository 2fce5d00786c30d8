// See feedback_check.h.
#include "device/feedback_check.h"

#include <cmath>

#include "base/steady_clock.h"
#include "lumbrical/math.h"

namespace lumbrical {
namespace {

constexpr double kSlack = 0.01;  // [rad] that an angle may be off by without being wrong

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

bool jumps(const JointDynamics& joint, float angle, std::int64_t now, const AngleMemory& memory) {
  if (memory.asked == 0) return false;
  const double passed = in_seconds(now - memory.asked);
  const double moved = std::fabs(static_cast<double>(angle) - static_cast<double>(memory.believed));
  return moved > kFastestJoint * passed + 2 * joint.encoder_step + kSlack;
}

bool is_stuck(const JointDynamics& joint, const JointTorque& torque, float angle, std::int64_t now,
              AngleMemory& memory) {
  if (memory.since == 0 || angle != memory.still) {
    memory.still = angle;
    memory.since = now;
    memory.low = memory.high = torque.now;
    return false;
  }
  memory.low = min(memory.low, torque.now);
  memory.high = max(memory.high, torque.now);
  const bool still = in_seconds(now - memory.since) >= kStillTime;
  return still && torque.span > 0 &&
         memory.high - memory.low > max(kStillShare * torque.span, 4 * joint.friction);
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
    if (!in_range || jumps(dynamics, feedback.angle[a], feedback.time, memory[a])) {
      memory[a].doubt = in_range ? kAngleJumped : kAngleOutOfRange;
      feedback.flags |= memory[a].doubt;
      feedback.valid &= ~bit;
      feedback.angle[a] = memory[a].believed;
      continue;
    }
    memory[a].believed = feedback.angle[a];
    memory[a].asked = feedback.asked;
    memory[a].doubt = 0;
    if (!is_flexion(sensor)) continue;
    if (is_stuck(dynamics, torque_about(profile, feedback.acted, joint), feedback.angle[a], feedback.time,
                 memory[a])) {
      feedback.flags |= memory[a].doubt = kAngleStuck;
      feedback.valid &= ~bit;
    }
  }
}

}  // namespace lumbrical
