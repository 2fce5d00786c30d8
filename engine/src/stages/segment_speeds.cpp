#include "stages/segment_speeds.h"

#include <algorithm>

#include "base/small_turn.h"
#include "lumbrical/math.h"

namespace lumbrical {
namespace {

// [s] Over this the mean of a speed goes: trackers tremble, and what trembles must not be felt as if it went
// on.
constexpr double kSteady = 0.005;

// [m/s], [rad/s] Faster is no hand: what seems so has jumped, and does not go on.
constexpr double kFastest = 20, kFastestTurn = 200;

bool some_object_moves(const Model& model) {
  return std::any_of(model.apart.begin(), model.apart.end(),
                     [](const ApartObject& object) { return moves_by_itself(object.mechanism); });
}

Twist between(const Twist& from, const Twist& to, double share) {
  return {from.velocity + share * (to.velocity - from.velocity),
          from.angular_velocity + share * (to.angular_velocity - from.angular_velocity)};
}

bool goes_on(const Twist& speed) {
  return norm(speed.velocity) < kFastest && norm(speed.angular_velocity) < kFastestTurn;
}

}  // namespace

Twist speed_between(const Pose& from, const Pose& to, double rate) {
  return {rate * (to.position - from.position), rate * small_turn(from.orientation, to.orientation)};
}

SegmentSpeeds speeds_of(const Model& model, bool trusted, const Primitives& hand,
                        std::optional<MotionState>& motion) {
  SegmentSpeeds speeds;
  const bool some_hang_on = some_object_moves(model);
  if (!some_hang_on && !(model.settings.pad.damping > 0)) {
    motion.reset();
    return speeds;
  }
  if (!motion || !trusted) motion = MotionState{};
  if (!trusted) return speeds;
  const double rate = model.settings.rate, share = min(1, 1 / (rate * kSteady));
  const std::uint32_t known = hand.joints.valid & static_cast<std::uint32_t>(motion->valid);
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const Pose& X_WS = base_pose(hand, i);
    Pose& was = motion->segment[i];
    Twist& steady = motion->speed[i];
    const bool known_before = (known >> base_joint_of(i) & 1u) != 0;
    if (known_before) speeds.now[i] = speed_between(was, X_WS, rate);
    steady = some_hang_on && known_before && goes_on(speeds.now[i]) ? between(steady, speeds.now[i], share)
                                                                    : Twist{};
    was = X_WS;
  }
  speeds.steady = motion->speed;
  motion->valid = hand.joints.valid;
  return speeds;
}

}  // namespace lumbrical
