// Replay: the same bits again from the file alone, and the very field named where something was changed.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "lumbrical/shapes.h"
#include "lumbrical/tick.h"
#include "recording_fixture.h"
#include "tick/tick_trace.h"

namespace lumbrical {
namespace {

using test::alter_recording;
using test::temporary_path;

constexpr std::uint64_t kTicks = 600;

Scene touch_scene() {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"ball", make_sphere(0.04, 4)});
  return scene;
}

/// A hand, palm down, its middle fingers over the ball, comes down and goes up again, fingers slowly bending.
DeviceFrame touch_frame(std::uint64_t tick, InputKind kind, const Hand& hand) {
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

void record_touch(const std::string& path, InputKind kind, const Execution& execution = {},
                  const Scene& scene = touch_scene()) {
  Model model;
  Status status = build_model(scene, execution, model);
  ASSERT_TRUE(status.ok()) << status.message();
  Recorder recorder;
  status = recorder.open(path, scene, {});
  ASSERT_TRUE(status.ok()) << status.message();
  State state;
  Scratch scratch = make_scratch(model);
  std::uint64_t contacts = 0;
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    TickRecord record;
    record.device = touch_frame(i, kind, scene.hand);
    if (i == 450) record.device.flags = kTrackingLost;
    record.output = tick(model, state, scratch, record.device);
    record.stage_hash = scratch.stage_hash;
    record.state_hash = hash_state(state);
    record.duration_ns = static_cast<std::uint32_t>(i);
    contacts += record.output.contact_count;
    ASSERT_TRUE(recorder.record(record));
  }
  status = recorder.close();
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_GT(contacts, 0u) << "the hand never touches the ball";
}

Status replay_file(const std::string& path, ReplayResult& result, const ReplayOptions& options = {}) {
  RecordingReader reader;
  if (Status status = reader.open(path); !status.ok()) return status;
  return replay(reader, options, result);
}

class Replay : public ::testing::TestWithParam<InputKind> {
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

INSTANTIATE_TEST_SUITE_P(Inputs, Replay, ::testing::Values(InputKind::joint_poses, InputKind::joint_angles));

void expect_divergence(const Divergence& divergence, std::uint64_t tick, const std::string& stage,
                       const std::string& field) {
  EXPECT_EQ(divergence.tick, tick) << field;
  EXPECT_EQ(divergence.stage, stage) << field;
  EXPECT_EQ(divergence.field, field);
  EXPECT_NE(divergence.recorded, divergence.replayed) << field;
}

TEST_P(Replay, GivesEveryBitAgain) {
  std::uint64_t reported = 0;
  ReplayOptions options;
  options.progress = [&](std::uint64_t done, std::uint64_t all) {
    reported = done;
    EXPECT_EQ(all, kTicks);
  };
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
  EXPECT_LE(reported, kTicks);
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

TEST_P(Replay, AsksWhatIf) {
  ReplayOptions law, stiffness;
  law.law = Law::max_depth;
  stiffness.stiffness = 1e6;
  ReplayResult result;
  ASSERT_TRUE(replay_file(path_, result, law).ok());
  EXPECT_TRUE(result.first_divergence.has_value());
  ASSERT_TRUE(replay_file(path_, result, stiffness).ok());
  ASSERT_TRUE(result.first_divergence.has_value());
  EXPECT_GE(result.first_divergence->tick, 1u) << "nothing is touched at first";
  EXPECT_EQ(result.ticks, result.first_divergence->tick + 1);

  ReplayOptions bad;
  bad.stiffness = -1;
  const Status status = replay_file(path_, result, bad);
  EXPECT_NE(status.message().find("stiffness"), std::string::npos) << status.message();
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
  };
  leave_out(57, 59);
  EXPECT_EQ(result.ticks, 58u);
  leave_out(0, 4);
}

TEST_P(Replay, GoesAsFarAsATornFileGoesAndRefusesADamagedOne) {
  const std::string copy = temporary_path("torn.mcap");
  std::vector<std::uint8_t> bytes = test::read_bytes(path_);
  InputFile file;
  Summary summary;
  bool present = false;
  ASSERT_TRUE(file.open(path_).ok());
  ASSERT_TRUE(read_summary(file, summary, present).ok());
  const mcap::ChunkIndex& second = summary.chunks.at(1);
  test::write_bytes(copy, std::span(bytes).first(second.offset + second.length + 10));
  ReplayResult result;
  Status status = replay_file(copy, result);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(result.ticks, 500u);
  EXPECT_FALSE(result.first_divergence.has_value());

  bytes[second.offset + second.length / 2] ^= 1;
  test::write_bytes(copy, bytes);
  status = replay_file(copy, result);
  EXPECT_NE(status.message().find(copy + ": byte " + std::to_string(second.offset)), std::string::npos)
      << status.message();

  test::write_recording(copy, touch_scene(), {});
  EXPECT_NE(replay_file(copy, result).message().find("holds no tick"), std::string::npos);
}

// What a difference is about is told to the number where this machine can still compute what was recorded.
TEST_P(Replay, NamesPairFieldAndDistanceOfAResultThatDiffers) {
  ReplayOptions coarse;
  coarse.tolerance = 1e-2;  // single precision for some triangles
  ReplayResult result;
  ASSERT_TRUE(replay_file(path_, result, coarse).ok());
  ASSERT_TRUE(result.first_divergence.has_value());
  const Divergence& first = *result.first_divergence;
  EXPECT_EQ(first.stage, "narrowphase");
  ASSERT_TRUE(first.primitive && first.triangle && first.ulp);
  EXPECT_LT(*first.triangle, touch_scene().objects[0].mesh.triangles.size());
  EXPECT_GT(*first.ulp, 0u);
  EXPECT_NE(first.recorded, first.replayed);
  EXPECT_EQ(first.recorded_build, build_text());
  EXPECT_EQ(first.replayed_build, build_text());

  // The same tick by hand.
  const auto contact_of = [&](double tolerance) {
    Scene scene = touch_scene();
    scene.settings.tolerance = tolerance;
    Model model;
    EXPECT_TRUE(build_model(scene, {}, model).ok());
    State state;
    Scratch scratch = make_scratch(model);
    tick(model, state, scratch, touch_frame(first.tick, GetParam(), scene.hand));
    for (std::uint32_t i = 0; i < scratch.contact_count; ++i) {
      const Contact& contact = scratch.contacts[i];
      if (contact.primitive == *first.primitive && contact.triangle == *first.triangle) return contact;
    }
    ADD_FAILURE() << "no such contact";
    return Contact{};
  };
  const Contact exact = contact_of(0), rough = contact_of(1e-2);
  const std::map<std::string, double Contact::*> fields = {{"depth", &Contact::depth},
                                                           {"area", &Contact::area},
                                                           {"volume", &Contact::volume},
                                                           {"error", &Contact::error}};
  ASSERT_TRUE(fields.contains(first.field)) << first.field;
  EXPECT_EQ(first.recorded, exact_text(exact.*fields.at(first.field)));
  EXPECT_EQ(first.replayed, exact_text(rough.*fields.at(first.field)));
}

TEST(UlpDistance, CountsTheNumbersInBetween) {
  using Type = TraceValue::Type;
  const auto between = [](double a, double b) {
    return ulps_between(Type::real, std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b));
  };
  const double next = std::nextafter(1.5, 2.0), tiny = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(between(1.5, next), 1u);
  EXPECT_EQ(between(next, 1.5), 1u);
  EXPECT_EQ(between(1.0, 2.0), std::uint64_t{1} << 52);
  EXPECT_EQ(between(-0.0, 0.0), 1u);
  EXPECT_EQ(between(-tiny, tiny), 3u);
  EXPECT_EQ(between(2.0, 2.0), 0u);
  EXPECT_FALSE(between(NAN, 1.0).has_value());
  EXPECT_EQ(ulps_between(Type::real32, std::bit_cast<std::uint32_t>(1.0f),
                         std::bit_cast<std::uint32_t>(std::nextafter(1.0f, 2.0f))),
            1u);
  EXPECT_FALSE(ulps_between(Type::whole, 1, 2).has_value());
}

std::string without_comments(const std::string& path) {
  std::ifstream in(path);
  std::string text;
  for (std::string line; std::getline(in, line);)
    if (!line.starts_with('#')) text += line + '\n';
  return text;
}

TEST_P(Replay, TracesTheSameTextHoweverItIsComputed) {
  const std::string a = temporary_path("a.txt"), b = temporary_path("b.txt"), c = temporary_path("c.txt");
  ReplayOptions options;
  options.trace_tick = 330;
  ReplayResult result;
  options.trace = a;
  ASSERT_TRUE(replay_file(path_, result, options).ok());
  options.trace = b;
  options.execution = {.broadphase = Broadphase::brute, .threads = 2, .isa = Isa::scalar};
  ASSERT_TRUE(replay_file(path_, result, options).ok());
  const std::string text = without_comments(a);
  EXPECT_EQ(text, without_comments(b));
  for (const char* const part :
       {"330 input base.position.x ", "330 hand_pose primitive 0 end1.x ", "330 broadphase primitive ",
        " triangle ", "330 narrowphase primitive ", "330 contact_force segment[0].force.x ",
        "330 limits flags ", "330 state tick 331\n", "330 state held.segment[15].force.z "})
    EXPECT_NE(text.find(part), std::string::npos) << part;

  // Of a divergence, the stage that differs.
  ReplayOptions stiffer;
  stiffer.stiffness = 3e7;
  stiffer.trace = c;
  ASSERT_TRUE(replay_file(path_, result, stiffer).ok());
  ASSERT_TRUE(result.first_divergence.has_value());
  EXPECT_EQ(result.first_divergence->stage, "contact_force");
  const std::string tick = std::to_string(result.first_divergence->tick);
  EXPECT_EQ(without_comments(c).find(tick + " contact_force segment[0].force.x "), 0u);
  EXPECT_EQ(without_comments(c).find("narrowphase"), std::string::npos);

  options.trace_tick = kTicks;
  const Status status = replay_file(path_, result, options);
  EXPECT_NE(status.message().find("nothing was traced"), std::string::npos) << status.message();
}

Status what_if_file(const std::string& path, const ReplayOptions& options, WhatIfResult& result) {
  RecordingReader reader;
  if (Status status = reader.open(path); !status.ok()) return status;
  return what_if(reader, options, result);
}

TEST_P(Replay, SaysHowMuchAStifferWorldWouldChange) {
  Scene unlimited = touch_scene();
  unlimited.settings.max_force = 1e6;
  record_touch(path_, GetParam(), {}, unlimited);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path_).ok());
  std::vector<TickRecord> records;
  ASSERT_TRUE(test::read_records(reader, records).ok());

  WhatIfResult same, stiffer;
  ASSERT_TRUE(what_if_file(path_, {}, same).ok());
  ReplayOptions options;
  options.stiffness = 1.5 * touch_scene().settings.stiffness;
  ASSERT_TRUE(what_if_file(path_, options, stiffer).ok());
  EXPECT_EQ(stiffer.ticks, kTicks);
  EXPECT_GT(stiffer.baseline_time, 0);
  EXPECT_GT(stiffer.changed_time, 0);
  int touched = 0;
  for (std::size_t finger = 0; finger < kFingerCount; ++finger) {
    EXPECT_EQ(same.force[finger].max, 0);
    double largest = 0, squares = 0, noticed = 0;
    for (const TickRecord& record : records) {
      Vec3 force;
      for (std::size_t s = 3 * finger; s < 3 * finger + 3; ++s) force += record.output.segment[s].force;
      const double change = 0.5 * norm(force);  // half as much again
      largest = std::fmax(largest, change);
      noticed = std::fmax(noticed, change / (0.07 * std::fmax(norm(force), 0.5)));
      squares += change * change;
    }
    EXPECT_NEAR(stiffer.force[finger].max, largest, 1e-9 + 1e-9 * largest);
    EXPECT_NEAR(stiffer.force[finger].rms, std::sqrt(squares / static_cast<double>(kTicks)), 1e-9);
    EXPECT_NEAR(stiffer.force_jnd[finger].max, noticed, 1e-6);
    touched += largest > 0.5 ? 1 : 0;
    EXPECT_EQ(stiffer.felt_ticks[finger] > 0, noticed > 1);
  }
  EXPECT_GE(touched, 1);
}

TEST_P(Replay, SaysWhatAnotherMeshWouldChange) {
  ReplayOptions options;
  options.mesh["ball"] = touch_scene().objects[0].mesh;
  WhatIfResult result;
  ASSERT_TRUE(what_if_file(path_, options, result).ok());
  for (const Change& change : result.force) EXPECT_EQ(change.max, 0);
  for (Vec3& vertex : options.mesh["ball"].vertices) vertex.z += 0.002;
  ASSERT_TRUE(what_if_file(path_, options, result).ok());
  double largest = 0;
  for (const Change& change : result.force) largest = std::fmax(largest, change.max);
  EXPECT_GT(largest, 0.1);
  options.mesh = {{"bowl", options.mesh["ball"]}};
  const Status status = what_if_file(path_, options, result);
  EXPECT_NE(status.message().find("no object \"bowl\""), std::string::npos) << status.message();
}

class Diff : public ::testing::Test {
 protected:
  void SetUp() override {
    record_touch(a_, InputKind::joint_angles);
    record_touch(b_, InputKind::joint_angles, {.broadphase = Broadphase::brute});
  }
  ReplayResult diff(const std::string& a, const std::string& b) {
    RecordingReader reader_a, reader_b;
    EXPECT_TRUE(reader_a.open(a).ok());
    EXPECT_TRUE(reader_b.open(b).ok());
    ReplayResult result;
    const Status status = diff_recordings(reader_a, reader_b, result);
    EXPECT_TRUE(status.ok()) << status.message();
    return result;
  }
  std::string a_ = temporary_path("a.mcap"), b_ = temporary_path("b.mcap"), c_ = temporary_path("c.mcap");
};

TEST_F(Diff, FindsNoneBetweenRunsOfTheSameSession) {
  const ReplayResult result = diff(a_, b_);
  EXPECT_EQ(result.ticks, kTicks);
  EXPECT_FALSE(result.first_divergence.has_value());
}

TEST_F(Diff, NamesTheFirstFieldThatDiffers) {
  alter_recording(a_, c_, [](TickRecord& record) {
    if (record.output.tick >= 70) record.device.angle[3] = 1;
    if (record.output.tick >= 50) record.output.segment[2].torque.y = 1;
    record.duration_ns = 0;
    return true;
  });
  expect_divergence(*diff(a_, c_).first_divergence, 50, "output", "segment[2].torque.y");
  alter_recording(a_, c_, [](TickRecord& record) {
    if (record.output.tick >= 20) record.device.angle[3] = 1;
    return true;
  });
  expect_divergence(*diff(a_, c_).first_divergence, 20, "input", "angle[3]");
}

TEST_F(Diff, TellsWhereOneHasATickTheOtherHasNot) {
  alter_recording(a_, c_, [](TickRecord& record) { return record.output.tick < 550; });
  const Divergence shorter = *diff(a_, c_).first_divergence;
  expect_divergence(shorter, 550, "input", "tick");
  EXPECT_EQ(shorter.recorded, "550");
  EXPECT_EQ(shorter.replayed, "none");
  alter_recording(a_, c_, [](TickRecord& record) { return record.output.tick != 33; });
  const Divergence gap = *diff(a_, c_).first_divergence;
  expect_divergence(gap, 33, "input", "tick");
  EXPECT_EQ(gap.replayed, "34");
}

TEST_F(Diff, TellsWorldsApartThatWereTouchedAlike) {
  std::vector<TickRecord> records;
  RecordingReader reader;
  ASSERT_TRUE(reader.open(a_).ok());
  ASSERT_TRUE(test::read_records(reader, records).ok());
  Scene scene = touch_scene();
  scene.objects.front().mesh.vertices.front().x += 1e-6;
  test::write_recording(c_, scene, records);
  expect_divergence(*diff(a_, c_).first_divergence, 0, "scene", "hash");
}

}  // namespace
}  // namespace lumbrical
