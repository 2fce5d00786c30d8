// Replay: the same bits again from the file alone, and the very field named where something was changed.
#include <gtest/gtest.h>

#include <algorithm>

#include "lumbrical/shapes.h"
#include "recording/replay.h"
#include "recording/session_message.h"
#include "touch_session.h"

namespace lumbrical::test {
namespace {

class Replay : public TouchReplay {};
INSTANTIATE_TEST_SUITE_P(Inputs, Replay, ::testing::Values(InputKind::joint_poses, InputKind::joint_angles),
                         testing::PrintToStringParamName());

TEST_P(Replay, GivesEveryBitAgain) {
  ReplayOptions options;
  for (const Broadphase broadphase : {Broadphase::tree, Broadphase::brute}) {
    for (const std::uint32_t threads : {1u, 3u}) {
      options.execution.broadphase = broadphase;
      options.execution.threads = threads;
      ReplayResult result;
      const Status status = replay_file(path_, result, options);
      ASSERT_TRUE(status.ok()) << status.message();
      EXPECT_EQ(result.ticks, kTicks);
      EXPECT_FALSE(result.first_divergence.has_value())
          << result.first_divergence->tick << ' ' << result.first_divergence->stage << ' '
          << result.first_divergence->field << ' ' << result.first_divergence->recorded << ' '
          << result.first_divergence->replayed;
    }
  }
}

TEST(ReplayProgress, IsToldAsLongAsTheReplayGoesOn) {
  const std::string path = temporary_path("long.mcap");
  constexpr std::uint64_t kAll = 2 * kProgressInterval + kProgressInterval / 2;
  record_touch(path, InputKind::joint_angles, {}, touch_scene(), kAll);
  std::vector<std::uint64_t> told;
  ReplayOptions options;
  options.progress = [&](std::uint64_t done, std::uint64_t all) {
    told.push_back(done);
    EXPECT_EQ(all, kAll);
  };
  ReplayResult result;
  ASSERT_TRUE(replay_file(path, result, options).ok());
  EXPECT_FALSE(result.first_divergence.has_value());
  EXPECT_EQ(told, (std::vector<std::uint64_t>{kProgressInterval, 2 * kProgressInterval}));

  told.clear();
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  WhatIfResult changed;
  ASSERT_TRUE(what_if(reader, options, changed).ok());
  ASSERT_FALSE(told.empty());
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_EQ(told.back(), 2 * kProgressInterval);
}

TEST_P(Replay, NamesTheOneInputFieldThatWasAltered) {
  const auto expect_input = [&](std::uint64_t tick, const std::string& field,
                                const std::function<void(TickRecord&)>& edit) {
    expect_divergence(altered(tick, edit), tick, "input", field);
  };
  expect_input(17, "base.position.x", [](TickRecord& r) { r.device.base.position.x += 0.25; });
  expect_input(18, "base.position.z",
               [](TickRecord& r) { r.device.base.position.z = -r.device.base.position.z; });
  expect_input(0, "base.orientation.w", [](TickRecord& r) { r.device.base.orientation.w = 0.5; });
  expect_input(kTicks - 1, "kind", [](TickRecord& r) {
    const bool poses = r.device.kind == InputKind::joint_poses;
    r.device.kind = poses ? InputKind::joint_angles : InputKind::joint_poses;
  });
  expect_input(3, "flags", [](TickRecord& r) { r.device.flags ^= kTrackingLost; });
  expect_input(4, "valid", [](TickRecord& r) { r.device.valid ^= 1u << 25; });
  expect_input(5, "joint[7].position[1]", [](TickRecord& r) { r.device.joint[7].position[1] += 0.001f; });
  expect_input(6, "joint[25].orientation[3]", [](TickRecord& r) { r.device.joint[25].orientation[3] = -1; });
  expect_input(7, "angle[19]", [](TickRecord& r) { r.device.angle[19] += 1e-6f; });
  expect_input(8, "angle[0]", [](TickRecord& r) { r.device.angle[0] = -r.device.angle[0]; });
}

TEST_P(Replay, TellsTheOriginalValueExactly) {
  const double original = touch_frame(17, GetParam(), touch_scene().hand).base.position.z;
  const Divergence divergence = altered(17, [](TickRecord& r) { r.device.base.position.z = 0.1; });
  EXPECT_EQ(divergence.recorded, exact_text(original));
  EXPECT_EQ(divergence.replayed, "0.1");
}

TEST_P(Replay, NamesAnAlteredTickNumberByTheOriginalOne) {
  const Divergence divergence = altered(300, [](TickRecord& r) { r.output.tick = 303; });
  expect_divergence(divergence, 300, "input", "tick");
  EXPECT_EQ(divergence.recorded, "300");
  EXPECT_EQ(divergence.replayed, "303");
}

TEST_P(Replay, SaysSeveralWhereMoreThanOneInputFieldWasAltered) {
  const auto expect_several = [&](const std::function<void(TickRecord&)>& edit) {
    expect_divergence(altered(40, edit), 40, "input", "several");
  };
  expect_several([](TickRecord& r) { r.device.base.position = {1, 2, 3}; });
  // Two equal changes whose mean place is a third field, and two that cancel.
  expect_several([](TickRecord& r) {
    r.device.valid += 2;
    r.device.kind = static_cast<InputKind>(1 - static_cast<int>(r.device.kind));
  });
  expect_several([](TickRecord& r) {
    r.device.valid += 2;
    r.device.flags -= 2;
  });
  expect_several([](TickRecord& r) {
    r.device.joint[3].position = {1, 1, 1};
    r.device.joint[4].position = {1, 1, 1};
  });
}

TEST_P(Replay, NamesAlteredOutputsAndHashes) {
  const auto edited = [&](const std::string& stage, const std::string& field,
                          const std::function<void(TickRecord&)>& edit) {
    expect_divergence(altered(320, edit), 320, stage, field);
  };
  edited("output", "segment[3].force.x", [](TickRecord& r) { r.output.segment[3].force.x += 1; });
  edited("output", "joint_torque[15].z", [](TickRecord& r) { r.output.joint_torque[15].z += 1; });
  edited("output", "flexion_torque[0]", [](TickRecord& r) { r.output.flexion_torque[0] = -7; });
  edited("output", "flags", [](TickRecord& r) { r.output.flags ^= 512; });
  edited("output", "contact_count", [](TickRecord& r) { r.output.contact_count += 1; });
  for (int stage = 0; stage < kStageCount; ++stage)
    edited(std::string(stage_name(static_cast<Stage>(stage))), "hash",
           [&](TickRecord& r) { ++r.stage_hash[stage]; });
  edited("state", "hash", [](TickRecord& r) { r.state_hash = 0; });
  // The first of several.
  edited("broadphase", "segment[3].force.x", [](TickRecord& r) {
    ++r.stage_hash[4];
    ++r.stage_hash[2];
    r.output.segment[3].force.x += 1;
  });
}

TEST_P(Replay, NamesTheTickThatIsMissing) {
  const std::string copy = temporary_path("gap.mcap");
  ReplayResult result;
  const auto leave_out = [&](std::uint64_t from, std::uint64_t to) {
    alter_recording(path_, copy, [&](const TickRecord& record) {
      return record.output.tick < from || record.output.tick > to;
    });
    const std::string message = replay_file(copy, result).message();
    EXPECT_EQ(message.find(copy + ": tick " + std::to_string(from) + " is missing"), 0u) << message;
    EXPECT_EQ(message.find("--to-tick " + std::to_string(from)) != std::string::npos, from > 0) << message;
    EXPECT_NE(message.find("--from-tick"), std::string::npos) << message;
  };
  leave_out(57, 59);
  EXPECT_EQ(result.ticks, 58u);
  leave_out(0, 4);
}

TEST_P(Replay, GoesAsFarAsATornFileGoesAndRefusesADamagedOne) {
  const std::string copy = temporary_path("torn.mcap");
  std::vector<std::uint8_t> bytes = read_bytes(path_);
  InputFile file;
  Summary summary;
  bool present = false;
  ASSERT_TRUE(file.open(path_).ok());
  ASSERT_TRUE(read_summary(file, summary, present).ok());
  const mcap::ChunkIndex& second = summary.chunks.at(1);
  write_bytes(copy, std::span(bytes).first(second.offset + second.length + 10));
  ReplayResult result;
  Status status = replay_file(copy, result);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(result.ticks, 400u);
  EXPECT_FALSE(result.first_divergence.has_value());

  bytes[second.offset + second.length / 2] ^= 1;
  write_bytes(copy, bytes);
  status = replay_file(copy, result);
  EXPECT_NE(status.message().find(copy + ": byte " + std::to_string(second.offset)), std::string::npos)
      << status.message();

  write_recording(copy, touch_scene(), {});
  EXPECT_NE(replay_file(copy, result).message().find("holds no tick"), std::string::npos);
}

TEST(SessionMessage, HoldsMeshesAsAModelTurnsThem) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  const Mesh box = make_box({0.1, 0.1, 0.1}, 2);
  for (const Winding winding : {Winding::automatic, Winding::as_is, Winding::flip}) {
    SceneObject& object = scene.objects.emplace_back(SceneObject{"box", box, winding});
    for (Triangle& t : object.mesh.triangles) std::swap(t[1], t[2]);
  }
  Model model;
  ASSERT_TRUE(build_model(scene, {}, model).ok());
  std::vector<std::uint8_t> message, of_model;
  ASSERT_TRUE(encode_session(scene, message).ok());
  ASSERT_TRUE(encode_session(scene_of(model), of_model).ok());
  EXPECT_EQ(message, of_model);
  Scene read;
  ASSERT_TRUE(decode_session(message, read).ok());
  EXPECT_EQ(read.objects[0].mesh.triangles, box.triangles);
  EXPECT_EQ(read.objects[1].mesh.triangles, scene.objects[1].mesh.triangles);
}

}  // namespace
}  // namespace lumbrical::test
