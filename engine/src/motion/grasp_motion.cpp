// The demo's motions: a hand reaches for an upright cylinder, closes on it, strokes it, or lifts and tilts it
// and puts it down, and lets go. The closing angles are solved for by bisection, joint by joint from the base
// of each finger.
#include "base/elementary.h"
#include "base/floating_point.h"
#include "lumbrical/motion.h"

namespace lumbrical {
namespace {

constexpr double kRate = 100;           // [Hz]
constexpr double kPalmPress = 0.0005;   // [m] how deep the palm lies in the surface while it holds
constexpr double kLightPress = 0.0010;  // [m] how deep the phalanges do
constexpr double kFirmPress = 0.0020;   // [m] the same when squeezing
constexpr double kStroke = 0.010;       // [m] up and down from the middle
constexpr double kTurn = 0.15;          // [rad] about the object's axis, either way
constexpr double kTilt = 0.5;           // [rad] of what is lifted, away from the hand
constexpr double kLift = 0.008;  // [m] of the palm above the object's middle, so that the fingers share it
constexpr Vec3 kWithdrawal{-0.15, 0, 0.03};  // [m] from the grasp to where the motion starts and ends

using Angles = std::array<double, kAngleCount>;

// The open hand [rad]: the thumb opposite the fingers and stretched away, the fingers nearly straight.
constexpr std::array<double, 4> kOpenThumb = {1.0, -0.5, 0, 0};
constexpr std::array<double, 4> kOpenFinger = {0, 0.10, 0.20, 0.10};

// What the hand does at a moment, each from 0 to 1 (of a stroke height and turn from -1 to 1).
struct Action {
  double away;     // at the start of the reach
  double closing;  // from the open hand to a light grasp
  double squeeze;  // from a light to a firm grasp
  double height;   // of the stroke, or of the lift
  double turn;     // about the object's axis, or away from the hand
};
struct Key {
  double time;  // of the whole duration, 0..1
  Action action;
};
constexpr std::array<Key, 9> kKeys = {{
    {0.00, {1, 0, 0, 0, 0}},
    {0.18, {0, 0, 0, 0, 0}},    // reach
    {0.30, {0, 1, 0, 0, 0}},    // close
    {0.38, {0, 1, 1, 0, 0}},    // squeeze
    {0.52, {0, 1, 0.3, 1, 1}},  // stroke upwards, lighter
    {0.68, {0, 1, 1, -1, -1}},  // stroke downwards, firmly
    {0.78, {0, 1, 0, 0, 0}},
    {0.88, {0, 0, 0, 0, 0}},  // let go
    {1.00, {1, 0, 0, 0, 0}},  // withdraw
}};

// As firmly as the stroke's firmest, all the time.
constexpr std::array<Key, 9> kLiftKeys = {{
    {0.00, {1, 0, 0, 0, 0}},
    {0.15, {0, 0, 0, 0, 0}},  // reach
    {0.25, {0, 1, 0, 0, 0}},  // close
    {0.32, {0, 1, 1, 0, 0}},  // squeeze
    {0.45, {0, 1, 1, 1, 0}},  // lift
    {0.58, {0, 1, 1, 1, 1}},  // tilt
    {0.75, {0, 1, 1, 0, 0}},  // upright again, and down
    {0.87, {0, 0, 0, 0, 0}},  // let go
    {1.00, {1, 0, 0, 0, 0}},  // withdraw
}};

struct Cylinder {
  double radius;  // [m], round the z axis, taken as endless
};

// Least distance of a phalanx's skin from the cylinder; negative when inside. The fifth of the bone next to
// its base is left out: it belongs to the joint before, which cannot be moved by this one.
double phalanx_gap(const Hand& hand, const std::array<Pose, kJointCount>& X_WJ, int segment,
                   Cylinder object) {
  const auto [base, tip] = kPhalanxJoints[segment];
  double least = 1e9;
  constexpr int kSteps = 20;
  for (int i = kSteps / 5; i <= kSteps; ++i) {
    const double t = static_cast<double>(i) / kSteps;
    const Vec3 p = (1 - t) * X_WJ[base].position + t * X_WJ[tip].position;
    const double radius = (1 - t) * hand.radius[base] + t * hand.radius[tip];
    least = min(least, std::sqrt(p.x * p.x + p.y * p.y) - object.radius - radius);
  }
  return least;
}

// Least gap of the phalanges of a finger from its `first` (0..2) on.
double finger_gap(const Hand& hand, const Pose& X_WH, const Angles& angles, int finger, int first,
                  Cylinder object) {
  std::array<Pose, kJointCount> X_WJ;
  forward_kinematics(hand, X_WH, angles, X_WJ);
  double least = 1e9;
  for (int i = first; i < 3; ++i) least = min(least, phalanx_gap(hand, X_WJ, 3 * finger + i, object));
  return least;
}

// Flexes a finger's joints one after the other, each from where it is, until a phalanx beyond it is `press`
// deep in the object or the joint's limit is reached.
void close_finger(const Hand& hand, const Pose& X_WH, int finger, double press, Cylinder object,
                  Angles& angles) {
  for (int i = 0; i < 3; ++i) {
    double& angle = angles[4 * finger + 1 + i];
    const double upper = hand.finger[finger].limit[1 + i].upper;
    const auto touches = [&](double value) {
      angle = value;
      return finger_gap(hand, X_WH, angles, finger, i, object) <= -press;
    };
    double free = angle;
    if (touches(free)) continue;
    constexpr double kStep = 0.02;  // [rad]
    double touching = free + kStep;
    while (touching < upper && !touches(touching)) {
      free = touching;
      touching += kStep;
    }
    if (touching >= upper && !touches(upper)) continue;
    touching = min(touching, upper);
    for (int step = 0; step < 40; ++step) {
      const double middle = 0.5 * (free + touching);
      (touches(middle) ? touching : free) = middle;
    }
    angle = free;
  }
}

Angles open_hand(const Hand& hand) {
  Angles angles{};
  for (int f = 0; f < kFingerCount; ++f) {
    for (int i = 0; i < 4; ++i) {
      const AngleLimit limit = hand.finger[f].limit[i];
      angles[4 * f + i] = clamp(f == 0 ? kOpenThumb[i] : kOpenFinger[i], limit.lower, limit.upper);
    }
  }
  return angles;
}

// The angles at which every finger presses `press` deep, from straight fingers bent back as far as they go.
Angles closed_hand(const Hand& hand, const Pose& X_WH, double press, Cylinder object) {
  Angles angles = open_hand(hand);
  for (int f = 0; f < kFingerCount; ++f) {
    for (int i = 1; i < 4; ++i) {
      const AngleLimit limit = hand.finger[f].limit[i];
      angles[4 * f + i] = i == 1 ? limit.lower : clamp(0, limit.lower, limit.upper);
    }
    close_finger(hand, X_WH, f, press, object, angles);
  }
  return angles;
}

// The wrist at the grasp: palm on the -x side facing the object, thumb uppermost.
Pose grasp_pose(const Hand& hand, Cylinder object, double height) {
  const Vec3 x{0, 0, hand.side == Side::right ? -1.0 : 1.0}, y{-1, 0, 0};
  Pose X_WP{{}, quat_from_axes(x, y, cross(x, y))};
  // The object lies towards the knuckles, the more so the thicker it is, to leave room for the ball of the
  // thumb.
  const double forward = 0.012 + 0.75 * max(0, object.radius - 0.037);
  const Vec3 axis_P{0, kPalmPress - hand.palm.height - object.radius, -forward};
  X_WP.position = Vec3{0, 0, 0.5 * height + kLift} - rotate(X_WP.orientation, axis_P);
  return X_WP * inverse(hand.palm_joint);
}

// From 0 to 1 with the least jerk: speed and acceleration are zero at both ends.
double minimum_jerk(double t) { return t * t * t * (10 + t * (6 * t - 15)); }

Action action_at(const std::array<Key, 9>& keys, double time) {
  std::size_t next = 1;
  while (next + 1 < keys.size() && time > keys[next].time) ++next;
  const Key& a = keys[next - 1];
  const Key& b = keys[next];
  const double s = minimum_jerk(clamp((time - a.time) / (b.time - a.time), 0, 1));
  const auto between = [&](double Action::*part) {
    return a.action.*part + s * (b.action.*part - a.action.*part);
  };
  return {between(&Action::away), between(&Action::closing), between(&Action::squeeze),
          between(&Action::height), between(&Action::turn)};
}

Pose stroke_at(const Action& action) {
  const SinCos half = sin_cos(0.5 * kTurn * action.turn);
  return {{0, 0, kStroke * action.height}, {half.cos, 0, 0, half.sin}};
}

// About the middle of what is held.
Pose lift_at(const Action& action, double lift, double middle) {
  const SinCos half = sin_cos(0.5 * kTilt * action.turn);
  const Quat tilt{half.cos, 0, half.sin, 0};
  return {Vec3{0, 0, lift * action.height + middle} - rotate(tilt, {0, 0, middle}), tilt};
}

Pose base_at(const Pose& grasp, const Pose& moved, const Action& action) {
  Pose base = moved * grasp;
  base.position += action.away * kWithdrawal;
  base.orientation = normalized(base.orientation);
  return base;
}

}  // namespace

Motion make_grasp(const Hand& hand, double radius, double height, double seconds, double lift) {
  const FloatingPointGuard guard;
  const Cylinder object{radius};
  const Pose grasp = grasp_pose(hand, object, height);
  const Angles open = open_hand(hand);
  const Angles light = closed_hand(hand, grasp, kLightPress, object);
  const Angles firm = closed_hand(hand, grasp, kFirmPress, object);

  Motion motion;
  motion.side = hand.side;
  motion.radius = hand.radius;
  motion.format = "grasp";
  const double length = seconds > 0.1 ? min(seconds, 3600) : 0.1;
  const int sample_count = static_cast<int>(std::floor(length * kRate + 0.5)) + 1;
  motion.samples.resize(static_cast<std::size_t>(sample_count));
  for (int i = 0; i < sample_count; ++i) {
    const Action action =
        action_at(lift > 0 ? kLiftKeys : kKeys, static_cast<double>(i) / (sample_count - 1));
    MotionSample& sample = motion.samples[static_cast<std::size_t>(i)];
    sample.time = i / kRate;
    sample.frame.kind = InputKind::joint_angles;
    const Pose moved = lift > 0 ? lift_at(action, lift, 0.5 * height) : stroke_at(action);
    sample.frame.base = base_at(grasp, moved, action);
    for (int a = 0; a < kAngleCount; ++a) {
      sample.frame.angle[a] = static_cast<float>(open[a] + action.closing * (light[a] - open[a]) +
                                                 action.squeeze * (firm[a] - light[a]));
    }
  }
  return motion;
}

}  // namespace lumbrical
