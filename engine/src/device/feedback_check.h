// Whether what a device says about its joints can be true.
#pragma once

#include <array>
#include <cstdint>

#include "lumbrical/device.h"
#include "lumbrical/device_link.h"
#include "lumbrical/device_profile.h"

namespace lumbrical {

inline constexpr double kFastestJoint = 50;  ///< [rad/s] no finger in a device is faster
/// [rad] Nor goes farther at once: where more time has passed, what is beyond it goes at kFastFinger.
inline constexpr double kFarthestAtOnce = 0.3, kFastFinger = 15;  // [rad], [rad/s]
inline constexpr double kStillTime = 0.25;  ///< [s] an angle that stands still for less is none that is stuck
inline constexpr double kStillShare = 0.25;  ///< of a joint's span of torques: more must have moved the joint

struct TorqueRange {
  double low = 0, high = 0;  ///< [N m]
};

/// What is remembered of one angle.
struct AngleMemory {
  float believed = 0;
  std::int64_t asked = 0;     ///< when it was asked for, the one that was believed; 0: none yet
  float least = 0, most = 0;  ///< of those believed
  float still = 0;            ///< the value that it has had
  std::int64_t since = 0;     ///< since then; 0: none yet
  TorqueRange newer, older;   ///< torques that moved nothing: in the last kStillTime at most, and before
  std::int64_t turned = 0;    ///< when `newer` began
  bool stuck = false;         ///< at `still`, until it moves
  std::uint32_t doubt = 0;    ///< DeviceFlag: why the newest one is not believed; 0: it is
  float said = 0;             ///< while it jumps: the newest one,
  std::int64_t said_at = 0;   ///< when that was asked for,
  std::int64_t steady = 0;    ///< and since when each could follow the one before; 0: it could not
};
using FeedbackMemory = std::array<AngleMemory, kAngleCount>;

/// Takes back from `feedback.valid` what can't be, and says why in its flags (DeviceFlag): a sensor out of
/// its range; an angle farther from the last one believed than kFastestJoint, and beyond kFarthestAtOnce
/// kFastFinger, takes it in the time since that was asked for; one that has stood still, to the last bit, for
/// kStillTime or more while motors and wires changed the joint's torque within that time, or twice as long,
/// by more than kStillShare of their span and four times its friction. What pushes a joint on at an end of
/// its sensor's range, or where it has never been farther, although it has moved by half a radian, is no such
/// torque: it may stand at its stop. What is not believed is replaced by what was believed last, and is
/// believed again as soon as it is possible, what was stuck once it moves, what jumped once it is back within
/// kFarthestAtOnce of what was believed, or has gone on without another jump until all forces have faded and
/// the hand has settled.
void check_feedback(const DeviceProfile& profile, DeviceFeedback& feedback, FeedbackMemory& memory);

}  // namespace lumbrical
