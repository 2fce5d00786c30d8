// Recordings that leave out forces: smaller, and still every bit of a session is checked.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "base/hash.h"
#include "recording_fixture.h"
#include "session.h"

namespace lumbrical::test {
namespace {

constexpr std::size_t kTicks = 400;

/// A grasp of a mug, recorded with the forces of every `interval`th tick.
void record_grasp(const std::string& path, std::uint32_t interval) {
  const Scene scene = mug_scene(Law::field);
  const Model model = model_of(scene);
  State state;
  Scratch scratch = make_scratch(model);
  RecorderOptions options;
  options.force_interval = interval;
  Recorder recorder;
  ASSERT_TRUE(recorder.open(path, scene, options).ok());
  TickRecord record;
  for (const DeviceFrame& frame : grasp_frames(scene.hand, kTicks)) {
    record.device = frame;
    record.output = tick(model, state, scratch, frame);
    take_results(state, scratch, record);
    ASSERT_TRUE(recorder.record(record));
  }
  ASSERT_TRUE(recorder.close().ok());
}

RecordingReader opened(const std::string& path) {
  RecordingReader reader;
  const Status status = reader.open(path);
  EXPECT_TRUE(status.ok()) << status.message();
  return reader;
}

std::vector<TickRecord> records_of(const std::string& path) {
  RecordingReader reader = opened(path);
  std::vector<TickRecord> records;
  EXPECT_TRUE(read_records(reader, records).ok());
  return records;
}

ReplayResult replayed(const std::string& path) {
  RecordingReader reader = opened(path);
  ReplayResult result;
  const Status status = replay(reader, {}, result);
  EXPECT_TRUE(status.ok()) << status.message();
  return result;
}

TEST(ForcesLeftOut, AreThoseBetweenEveryNthTick) {
  const std::string all = temporary_path("all.mcap"), some = temporary_path("some.mcap");
  record_grasp(all, 1);
  record_grasp(some, 10);
  const std::vector<TickRecord> full = records_of(all), sparse = records_of(some);
  ASSERT_EQ(sparse.size(), full.size());
  double felt = 0;
  for (std::size_t i = 0; i < full.size(); ++i) {
    ASSERT_EQ(sparse[i].has_forces, i % 10 == 0);
    TickRecord expected = full[i];
    expected.has_forces = i % 10 == 0;
    TickRecord found = sparse[i];
    if (!expected.has_forces) {
      EXPECT_TRUE(std::isnan(found.output.segment[0].force.x) &&
                  std::isnan(found.output.segment[15].torque.z) &&
                  std::isnan(found.output.joint_torque[3].y) && std::isnan(found.output.flexion_torque[14]));
      static_cast<HandForces&>(found.output) = static_cast<HandForces&>(expected.output) = {};
    }
    expect_same(found, expected);
    for (const Wrench& wrench : found.output.segment) felt += norm(wrench.force);
  }
  EXPECT_GT(felt, 1);
  EXPECT_FALSE(opened(all).info().metadata.contains("force_interval"));
  EXPECT_EQ(opened(some).info().metadata.at("force_interval"), "10");
  RecordingInfo info;
  const Status status = verify_recording(some, info);
  EXPECT_TRUE(status.ok()) << status.message();
}

TEST(ForcesLeftOut, AreReplayedIdenticalAndHalveTheFile) {
  const std::string all = temporary_path("all.mcap"), none = temporary_path("none.mcap");
  record_grasp(all, 1);
  record_grasp(none, 0);
  EXPECT_FALSE(replayed(none).first_divergence);
  EXPECT_EQ(replayed(none).ticks, kTicks);
  RecordingReader a = opened(all), b = opened(none);
  ReplayResult same;
  ASSERT_TRUE(diff_recordings(a, b, same).ok());
  EXPECT_FALSE(same.first_divergence);
  EXPECT_EQ(same.ticks, kTicks);
  const auto session_size = [](RecordingReader& reader) {
    std::vector<std::uint8_t> session;
    EXPECT_TRUE(encode_session(reader.scene(), session).ok());
    return session.size();
  };
  EXPECT_LT(2 * (std::filesystem::file_size(none) - session_size(b)),
            std::filesystem::file_size(all) - session_size(a));
}

TEST(ForcesLeftOut, StillBetrayAChangedBit) {
  const std::string none = temporary_path("none.mcap"), altered = temporary_path("altered.mcap");
  record_grasp(none, 0);
  constexpr std::uint64_t kAltered = 217;
  for (const bool state : {false, true}) {
    alter_recording(none, altered, [state](TickRecord& record) {
      if (record.output.tick != kAltered) return true;
      (state ? record.state_hash : record.stage_hash[kStageCount - 1]) ^= 1;
      return true;
    });
    const ReplayResult result = replayed(altered);
    ASSERT_TRUE(result.first_divergence);
    EXPECT_EQ(result.first_divergence->tick, kAltered);
    EXPECT_EQ(result.first_divergence->stage, state ? "state" : "limits");
    EXPECT_EQ(result.first_divergence->field, "hash");
    RecordingReader a = opened(none), b = opened(altered);
    ReplayResult compared;
    ASSERT_TRUE(diff_recordings(a, b, compared).ok());
    ASSERT_TRUE(compared.first_divergence);
    EXPECT_EQ(compared.first_divergence->tick, kAltered);
  }
}

TEST(ForcesLeftOut, WhatIfPutsTheComputedOnesInTheirPlace) {
  const std::string all = temporary_path("all.mcap"), some = temporary_path("some.mcap");
  const std::string altered = temporary_path("altered.mcap");
  record_grasp(all, 1);
  record_grasp(some, 7);
  ReplayOptions options;
  options.stiffness = 1e7;
  const auto ask = [&options](const std::string& path) {
    RecordingReader reader = opened(path);
    WhatIfResult result;
    const Status status = what_if(reader, options, result);
    EXPECT_TRUE(status.ok()) << status.message();
    return result;
  };
  const WhatIfResult full = ask(all), sparse = ask(some);
  EXPECT_EQ(sparse.ticks, kTicks);
  EXPECT_EQ(sparse.unlike_recorded, 0u);
  for (std::size_t part = 0; part < full.force.size(); ++part) {
    EXPECT_EQ(full.force[part].max, sparse.force[part].max);
    EXPECT_EQ(full.force[part].rms, sparse.force[part].rms);
    EXPECT_EQ(full.felt_ticks[part], sparse.felt_ticks[part]);
  }
  for (std::size_t s = 0; s < full.torque.size(); ++s) EXPECT_EQ(full.torque[s].rms, sparse.torque[s].rms);
  alter_recording(some, altered, [](TickRecord& record) {
    record.stage_hash[kStageCount - 1] ^= 1;
    return true;
  });
  EXPECT_EQ(ask(altered).unlike_recorded, kTicks - (kTicks + 6) / 7) << "those with forces need no hash";
}

TEST(ForcesLeftOut, PartsStillBeginInTheRightState) {
  const std::string none = temporary_path("none.mcap"), part = temporary_path("part.mcap");
  record_grasp(none, 0);
  CopyOptions options;
  options.from = 150;
  options.to = 300;
  CopyResult copied;
  const Status status = copy_recordings({none}, part, options, copied);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_TRUE(copied.replayable);
  EXPECT_EQ(opened(part).info().metadata.at("force_interval"), "0");
  EXPECT_FALSE(replayed(part).first_divergence);
  EXPECT_EQ(replayed(part).ticks, 150u);
}

TEST(ForcesLeftOut, AndThoseKeptMayBeOneFile) {
  const std::string all = temporary_path("all.mcap"), none = temporary_path("none.mcap");
  write_recording(all, small_scene(), random_records(20, 41));
  std::vector<TickRecord> later = random_records(40, 42);
  later.erase(later.begin(), later.begin() + 20);
  RecorderOptions options;
  options.force_interval = 0;
  write_recording(none, small_scene(), later, options);
  CopyResult copied;
  const std::string both = temporary_path("both.mcap");
  const Status status = copy_recordings({all, none}, both, {}, copied);
  ASSERT_TRUE(status.ok()) << status.message();
  for (const TickRecord& record : records_of(both)) EXPECT_EQ(record.has_forces, record.output.tick < 20);
}

TEST(ForcesLeftOut, AreEmptyInExports) {
  const std::string none = temporary_path("none.mcap"), text = temporary_path("text");
  RecorderOptions options;
  options.force_interval = 0;
  write_recording(none, small_scene(), random_records(3, 43), options);
  RecordingReader reader = opened(none);
  ExportOptions as_json, as_csv;
  as_json.format = ExportFormat::json;
  as_csv.columns = {"all"};
  ASSERT_TRUE(export_recording(reader, as_json, text).ok());
  const std::vector<std::uint8_t> json = read_bytes(text);
  EXPECT_NE(std::string(json.begin(), json.end()).find(R"("segment":null,"joint_torque":null)"),
            std::string::npos);
  ASSERT_TRUE(export_recording(reader, as_csv, cleared(text)).ok());
  const std::vector<std::uint8_t> csv = read_bytes(text);
  EXPECT_NE(std::string(csv.begin(), csv.end()).find(std::string(10 * kSegmentCount, ',') + ",0x"),
            std::string::npos);
}

}  // namespace
}  // namespace lumbrical::test
