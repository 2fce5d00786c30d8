// See channel_metadata.h.
#include "recording/channel_metadata.h"

#include "lumbrical/device.h"
#include "lumbrical/hand.h"

namespace lumbrical {
namespace {

template <class NameOf>
std::string listed(int count, NameOf&& name_of) {
  std::string text;
  for (int i = 0; i < count; ++i) text += (i == 0 ? "" : ",") + std::string(name_of(i));
  return text;
}

std::string angle_name(int angle) {
  const std::string finger(finger_name(angle / 4));
  return finger + (angle % 4 == 0 ? " abduction" : " flexion " + std::to_string(angle % 4));
}

// TickFlag, from bit 0 on.
constexpr const char* kFlags =
    "input not finite,input implausible,input lost,input extrapolated,segment missing,segment degenerate,"
    "angle clamped,candidate overflow,force limited,fading,coarsened";
static_assert(kCoarsened == 1u << 10);

constexpr const char* kUnits =
    "base.position m,base.orientation quaternion w x y z,joints.position m in the base frame,"
    "joints.orientation quaternion x y z w,angles rad,segments.force N in the world frame,"
    "segments.torque N m,segments.joint_torque N m,segments.flexion_torque N m,force_error N,"
    "error_estimate N,duration_ns ns";

}  // namespace

std::map<std::string, std::string> channel_metadata() {
  return {
      {"segments", listed(kSegmentCount, segment_name)},
      {"joints", listed(kJointCount, joint_name)},
      {"angles", listed(kAngleCount, angle_name)},
      {"flags", kFlags},
      {"units", kUnits},
      {"log_time",
       "session time: tick / rate in ns; the clock at its start: metadata start_utc, start_monotonic_ns"}};
}

}  // namespace lumbrical
