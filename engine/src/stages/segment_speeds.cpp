#include "stages/segment_speeds.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/set_bits.h"
#include "base/shortened.h"
#include "base/small_turn.h"
#include "lumbrical/math.h"

namespace lumbrical {
namespace {

// [s] Over this the mean of a speed goes: trackers tremble, and turns change their speed where two samples
// meet. What trembles must not be felt as if it went on, and what steps no harder than it is. The skin's own
// fastest way to give after is as long (docs/pads.md).
constexpr double kSteady = 0.005;

// [m/s], [rad/s] Faster is no hand.
constexpr double kFastest = 20, kFastestTurn = 200;

// [m], [rad] A tracker may hold each sample for some ticks, so that a hand goes by steps. What is
// faster in a single tick has jumped only where it goes farther than this.
constexpr double kLongestStep = 0.15, kLongestTurn = 1.5;

// What of a hand goes farthest, whatever it does.
constexpr std::array<Joint, 6> kEnds = {kThumbTip, kIndexTip, kMiddleTip, kRingTip, kLittleTip, kWrist};

bool some_object_moves(const Model& model) {
  return std::any_of(model.apart.begin(), model.apart.end(),
                     [](const ApartObject& object) { return moves_by_itself(object.mechanism); });
}

// Of a single tick.
bool goes_on(const Twist& speed, double rate) {
  return norm(speed.velocity) <= max(kFastest, rate * kLongestStep) &&
         norm(speed.angular_velocity) <= max(kFastestTurn, rate * kLongestTurn);
}

}  // namespace

Twist speed_between(const Pose& from, const Pose& to, double rate) {
  return {rate * (to.position - from.position), rate * small_turn(from.orientation, to.orientation)};
}

Twist steadied(const Twist& mean, const Twist& now, double rate) {
  if (!goes_on(now, rate)) return {};
  const double share = min(1, 1 / (rate * kSteady));
  const Vec3 velocity = shortened(now.velocity, kFastest),
             turn = shortened(now.angular_velocity, kFastestTurn);
  return {mean.velocity + share * (velocity - mean.velocity),
          mean.angular_velocity + share * (turn - mean.angular_velocity)};
}

bool has_jumped(const Joints& joints, double rate, HandState& state) {
  const double longest = max(kLongestStep, kFastest / rate);
  bool jumped = false;
  for (std::size_t i = 0; i < kEnds.size(); ++i) {
    const Vec3 was = std::exchange(state.ends[i], joints.has(kEnds[i]) ? joints.position(kEnds[i]) : Vec3{});
    const bool both = joints.has(kEnds[i]) && has_bit(state.joints, kEnds[i]);
    jumped = jumped || (both && !(norm(state.ends[i] - was) <= longest));
  }
  return jumped;
}

SegmentSpeeds speeds_of(double rate, bool trusted, const Primitives& hand,
                        std::optional<MotionState>& motion) {
  if (!motion || !trusted) motion = MotionState{};
  if (!trusted) return {};
  const std::uint32_t known = hand.joints.valid & static_cast<std::uint32_t>(motion->valid);
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const Pose& X_WS = base_pose(hand, i);
    Pose& was = motion->segment[i];
    Twist& speed = motion->speed[i];
    const bool known_before = has_bit(known, base_joint_of(i));
    speed = known_before ? steadied(speed, speed_between(was, X_WS, rate), rate) : Twist{};
    was = X_WS;
  }
  motion->valid = hand.joints.valid;
  return motion->speed;
}

SegmentSpeeds speeds_asked_for(const Model& model, bool trusted, const Primitives& hand,
                               std::optional<MotionState>& motion) {
  if (model.settings.pad.damping > 0 || some_object_moves(model))
    return speeds_of(model.settings.rate, trusted, hand, motion);
  motion.reset();
  return {};
}

}  // namespace lumbrical
