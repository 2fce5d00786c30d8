// See delay_cells.h.
#include "delay_cells.h"

#include <cmath>
#include <numbers>

#include "hand_scenes.h"
#include "lumbrical/shapes.h"

namespace lumbrical::bench {
namespace {

constexpr double kThinMug = 0.03;  // [m] radius

MugShape mug_of(Play play) {
  MugShape mug;
  mug.segments = 24;
  if (play == Play::thin) mug.radius = kThinMug;
  return mug;
}

SceneObject touched(Play play) {
  switch (play) {
    case Play::grasp:
    case Play::thin:
      return {"mug", make_mug(mug_of(play))};
    case Play::press:
      return {"bumps", make_height_field(0.4, 80, 0.002, 0.04)};
    case Play::taps:
      return {"plate", make_plane(0.4, 40, 1)};
  }
  return {};
}

Hand hand_of(Play play) {
  switch (play) {
    case Play::grasp:
      return default_hand(Side::right);
    case Play::thin:
      return default_hand(Side::left, 0.17);
    case Play::press:
      return default_hand(Side::right, 0.21);
    case Play::taps:
      return default_hand(Side::left);
  }
  return {};
}

/// `frame(t)` for `seconds` [s], a hundred times a second.
template <class Frame>
Motion made_motion(const Hand& hand, double seconds, Frame&& frame) {
  constexpr double kRate = 100;  // [Hz]
  Motion motion;
  motion.side = hand.side;
  motion.radius = hand.radius;
  const int count = static_cast<int>(seconds * kRate) + 1;
  for (int i = 0; i < count; ++i) motion.samples.push_back({i / kRate, frame(i / kRate)});
  return motion;
}

constexpr double kTurn = 2 * std::numbers::pi;

// From 12 mm above the bumps to 4 mm into them and back, once in four seconds, and round a circle.
Motion pressing(const Hand& hand) {
  const DeviceFrame lying = test::pressed_frame(hand, 0, 0);
  return made_motion(hand, 8, [&](double time) {
    DeviceFrame frame = lying;
    frame.base.position.z += 0.004 + 0.008 * std::cos(kTurn * 0.25 * time);
    frame.base.position.x += 0.015 * std::sin(kTurn * 0.2 * time);
    return frame;
  });
}

// From 8 mm above the plate to 4 mm into it and back, once a second.
Motion tapping(const Hand& hand) {
  const DeviceFrame up = tips_frame(hand, -0.008, 0), down = tips_frame(hand, 0.004, 0);
  return made_motion(hand, 4, [&](double time) {
    DeviceFrame frame = up;
    const auto share = static_cast<float>(0.5 - 0.5 * std::cos(kTurn * time));
    for (std::size_t a = 0; a < kAngleCount; ++a) frame.angle[a] += share * (down.angle[a] - up.angle[a]);
    return frame;
  });
}

}  // namespace

Status load_patient_profile(const std::string& path, DeviceProfile& profile) {
  const Status status = load_device_profile(path, profile);
  profile.response_timeout = 0.2;
  profile.safety.answer_timeout = 0.5;
  return status;
}

Status build_play(Play play, double stiffness, Model& model) {
  Scene scene;
  scene.hand = hand_of(play);
  scene.settings.stiffness = stiffness;
  scene.settings.rate = 1000;
  scene.objects.push_back(touched(play));
  return build_model(scene, {}, model);
}

Motion play_motion(Play play, const Model& model) {
  switch (play) {
    case Play::grasp:
      return mug_grasp(model, 10);
    case Play::thin: {
      const MugShape mug = mug_of(play);
      return make_grasp(model.hand, mug.radius, mug.height, 10);
    }
    case Play::press:
      return pressing(model.hand);
    case Play::taps:
      return tapping(model.hand);
  }
  return {};
}

Motion mug_grasp(const Model& model, double seconds) {
  const MugShape mug;
  return make_grasp(model.hand, mug.radius, mug.height, seconds);
}

}  // namespace lumbrical::bench
