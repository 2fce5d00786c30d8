// A hand that touches a ball, recorded and replayed: what the tests of replay, traces and comparisons share.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "lumbrical/shapes.h"
#include "lumbrical/tick.h"
#include "recording_fixture.h"

namespace lumbrical::test {

inline constexpr std::uint64_t kTicks = 600;

inline Scene touch_scene() {
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"ball", make_sphere(0.04, 4)});
  return scene;
}

/// A hand, palm down, its middle fingers over the ball, comes down and goes up again, fingers slowly bending.
inline DeviceFrame touch_frame(std::uint64_t tick, InputKind kind, const Hand& hand) {
  const double phase = static_cast<double>(tick) / static_cast<double>(kTicks);
  DeviceFrame frame;
  frame.kind = kind;
  // y up in the hand's frame becomes z up in the world.
  frame.base.orientation = {0.70710678118654752, 0.70710678118654752, 0, 0};
  frame.base.position = {0.001 * phase, -0.12, 0.12 - 0.32 * phase * (1 - phase)};
  std::array<double, kAngleCount> angles{};
  for (std::size_t i = 0; i < kAngleCount; ++i) angles[i] = i % 4 == 0 ? 0 : 0.2 * phase;
  for (std::size_t i = 0; i < kAngleCount; ++i) angles[i] = static_cast<float>(angles[i]);
  if (kind == InputKind::joint_angles) {
    for (std::size_t i = 0; i < kAngleCount; ++i) frame.angle[i] = static_cast<float>(angles[i]);
    return frame;
  }
  std::array<Pose, kJointCount> poses;
  forward_kinematics(hand, Pose{}, angles, poses);
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const auto& [p, q] = poses[j];
    frame.joint[j].position = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    frame.joint[j].orientation = {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z),
                                  static_cast<float>(q.w)};
  }
  return frame;
}

inline void record_touch(const std::string& path, InputKind kind, const Execution& execution = {},
                         const Scene& scene = touch_scene(), std::uint64_t ticks = kTicks) {
  Model model;
  Status status = build_model(scene, execution, model);
  ASSERT_TRUE(status.ok()) << status.message();
  Recorder recorder;
  status = recorder.open(cleared(path), scene, {});
  ASSERT_TRUE(status.ok()) << status.message();
  State state;
  Scratch scratch = make_scratch(model);
  std::uint64_t contacts = 0;
  for (std::uint64_t i = 0; i < ticks; ++i) {
    TickRecord record;
    record.device = touch_frame(i, kind, scene.hand);
    if (i == 450) record.device.flags = kTrackingLost;
    record.output = tick(model, state, scratch, record.device);
    take_results(state, scratch, record);
    record.duration_ns = static_cast<std::uint32_t>(i);
    contacts += record.output.contact_count;
    ASSERT_TRUE(recorder.record(record));
  }
  status = recorder.close();
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_GT(contacts, 0u) << "the hand never touches the ball";
}

/// What that hand feels of a model, with the state that each tick left; `see` is shown both.
template <class See>
void record_ticks(const Model& model, InputKind kind, Recorder& recorder, const See& see) {
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    TickRecord record;
    record.device = touch_frame(i, kind, model.hand);
    record.output = tick(model, state, scratch, record.device);
    take_results(state, scratch, record);
    ASSERT_TRUE(recorder.record(record, &state));
    see(record, state);
  }
}

inline Status replay_file(const std::string& path, ReplayResult& result, const ReplayOptions& options = {}) {
  RecordingReader reader;
  if (Status status = reader.open(path); !status.ok()) return status;
  return replay(reader, options, result);
}

/// Replays of a recorded touch, of either kind of input.
class TouchReplay : public ::testing::TestWithParam<InputKind> {
 protected:
  void SetUp() override { record_touch(path_, GetParam()); }

  /// Alters one tick of a copy and replays that.
  Divergence altered(std::uint64_t tick, const std::function<void(TickRecord&)>& edit) {
    const std::string copy = temporary_path("altered.mcap");
    alter_recording(path_, copy, [&](TickRecord& record) {
      if (record.output.tick == tick) edit(record);
      return true;
    });
    ReplayResult result;
    const Status status = replay_file(copy, result);
    EXPECT_TRUE(status.ok()) << status.message();
    EXPECT_TRUE(result.first_divergence.has_value());
    std::filesystem::remove(copy);
    return result.first_divergence.value_or(Divergence{});
  }

  std::string path_ = temporary_path("touch.mcap");
};

inline void expect_divergence(const Divergence& divergence, std::uint64_t tick, const std::string& stage,
                              const std::string& field) {
  EXPECT_EQ(divergence.tick, tick) << field;
  EXPECT_EQ(divergence.stage, stage) << field;
  EXPECT_EQ(divergence.field, field);
  EXPECT_NE(divergence.recorded, divergence.replayed) << field;
}

}  // namespace lumbrical::test
