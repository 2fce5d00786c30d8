// Copies of recordings: trimmed, split, merged and compressed otherwise, no message is changed, and every
// part replays on its own.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "golden/golden_sessions.h"
#include "recording/mcap_reader.h"
#include "recording/state_message.h"
#include "recording_fixture.h"

namespace lumbrical::test {
namespace {

constexpr std::uint64_t kTicks = 1200;

/// A session that grasps, loses its hand at times, and is limited at others.
class Copied : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    path() = ::testing::TempDir() + "lumbrical_" + std::to_string(::getpid()) + "_copied.mcap";
    record(path(), 20);
  }
  static void TearDownTestSuite() { std::filesystem::remove(path()); }
  static std::string& path() {
    static std::string path;
    return path;
  }

  /// The hand is lost for so many ticks at the end of every 500.
  static void record(const std::string& file, std::size_t lost) {
    Scene scene = mug_scene(Law::field);
    scene.settings.max_force = 5;
    const Model model = model_of(scene);
    State state;
    Scratch scratch = make_scratch(model);
    std::vector<TickRecord> records;
    for (const DeviceFrame& frame : grasp_frames(scene.hand, kTicks)) {
      TickRecord record;
      record.device = frame;
      if (records.size() % 500 > 500 - lost) record.device.flags |= kTrackingLost;
      record.output = tick(model, state, scratch, record.device);
      take_results(state, scratch, record);
      records.push_back(record);
    }
    write_recording(file, scene, records);
  }

  static CopyResult copy(const std::vector<std::string>& inputs, const std::string& output,
                         const CopyOptions& options = {}) {
    CopyResult result;
    const Status status = copy_recordings(inputs, cleared(output), options, result);
    EXPECT_TRUE(status.ok()) << status.message();
    RecordingInfo info;
    const Status verdict = verify_recording(output, info);
    EXPECT_TRUE(verdict.ok()) << verdict.message();
    EXPECT_EQ(info.ticks, result.ticks);
    return result;
  }

  static ReplayResult replay_of(const std::string& file) {
    RecordingReader reader;
    ReplayResult result;
    Status status = reader.open(file);
    EXPECT_TRUE(status.ok()) << status.message();
    status = replay(reader, {}, result);
    EXPECT_TRUE(status.ok()) << status.message();
    return result;
  }

  /// Every message's bytes, from a tick on.
  static std::vector<std::vector<std::uint8_t>> messages(const std::string& file, std::uint64_t from = 0,
                                                         std::uint64_t to = kTicks) {
    RecordingReader reader;
    EXPECT_TRUE(reader.open(file).ok());
    EXPECT_TRUE(reader.seek(from).ok());
    std::vector<std::vector<std::uint8_t>> list;
    for (;;) {
      RecordedMessage message;
      bool end = false;
      EXPECT_TRUE(reader.next_message(message, end).ok());
      if (end || message.tick >= to) return list;
      list.emplace_back(message.bytes.begin(), message.bytes.end());
    }
  }
};

TEST_F(Copied, PartsReplayOnTheirOwnWhereverTheyBegin) {
  const std::string part = temporary_path("part.mcap");
  for (const std::uint64_t from : {0u, 1u, 7u, 250u, 490u, 505u, 700u, 1199u}) {
    const std::uint64_t to = std::min<std::uint64_t>(from + 60, kTicks);
    const CopyResult result = copy({path()}, part, {from, to, std::nullopt});
    EXPECT_EQ(result.ticks, to - from);
    EXPECT_TRUE(result.replayable) << from;
    EXPECT_EQ(messages(part), messages(path(), from, to)) << from;
    const ReplayResult replayed = replay_of(part);
    EXPECT_EQ(replayed.ticks, to - from);
    EXPECT_FALSE(replayed.first_divergence.has_value())
        << from << ' ' << replayed.first_divergence->stage << ' ' << replayed.first_divergence->field << ' '
        << replayed.first_divergence->recorded << ' ' << replayed.first_divergence->replayed;
    // A part of a part: its state is found behind the one it came with.
    if (to - from < 20) continue;
    const std::string inner = temporary_path("inner.mcap");
    EXPECT_TRUE(copy({part}, inner, {from + 3, to - 1, std::nullopt}).replayable) << from;
    EXPECT_FALSE(replay_of(inner).first_divergence.has_value()) << from;
  }
}

TEST_F(Copied, PartsPutTogetherAreTheFileTheyCameFrom) {
  std::vector<std::string> parts;
  for (std::uint64_t from = 0; from < kTicks; from += 333) {
    parts.push_back(temporary_path("part" + std::to_string(from)));
    copy({path()}, parts.back(), {from, from + 333, std::nullopt});
  }
  const std::string merged = temporary_path("merged.mcap");
  EXPECT_EQ(copy(parts, merged).ticks, kTicks);
  EXPECT_EQ(read_bytes(merged), read_bytes(path()));
}

TEST_F(Copied, CompressionChangesNoMessageAndTheWayBackNoByte) {
  const std::string zstd = temporary_path("z.mcap"), plain = temporary_path("n.mcap"),
                    back = temporary_path("b.mcap");
  CopyOptions options;
  options.compression = Compression::zstd;
  copy({path()}, zstd, options);
  EXPECT_EQ(messages(zstd), messages(path()));
  EXPECT_LT(std::filesystem::file_size(zstd), std::filesystem::file_size(path()));
  options.compression = Compression::none;
  copy({zstd}, plain, options);
  EXPECT_EQ(messages(plain), messages(path()));
  options.compression = Compression::lz4;
  copy({plain}, back, options);
  EXPECT_EQ(read_bytes(back), read_bytes(path()));
}

TEST_F(Copied, PartBehindAGapIsNotSaidToReplay) {
  const std::string gap = temporary_path("gap.mcap"), part = temporary_path("part.mcap");
  alter_recording(path(), gap, [](const TickRecord& record) {
    return record.output.tick < 300 || record.output.tick > 330;
  });
  CopyResult result = copy({gap}, part, {320, 360, std::nullopt});
  EXPECT_EQ(result.ticks, 29u);  // 331 .. 359
  EXPECT_FALSE(result.replayable);
  EXPECT_EQ(messages(part), messages(path(), 331, 360));
  // The state before a tick that is missing is known, but not what that tick did.
  EXPECT_FALSE(copy({gap}, part, {300, 360, std::nullopt}).replayable);
  EXPECT_FALSE(copy({gap}, part).replayable);
  EXPECT_TRUE(copy({gap}, part, {0, 300, std::nullopt}).replayable);
}

TEST_F(Copied, PartBehindAGapAsLongAsNumbersAllowIsMade) {
  const std::string file = temporary_path("gap.mcap");
  Scene scene = small_scene();
  scene.settings.proxy_stiffness = 1000;  // else no state is looked for that was kept before
  RandomBits random(1);
  const std::uint64_t last = UINT64_MAX - 1;
  write_recording(file, scene, {random_record(random, 0), random_record(random, last)});
  CopyResult result;
  ASSERT_TRUE(
      copy_recordings({file}, temporary_path("part.mcap"), {last, last + 1, std::nullopt}, result).ok());
  EXPECT_EQ(result.ticks, 1u);
  EXPECT_FALSE(result.replayable);
}

TEST_F(Copied, PartOfASceneThatNoModelIsMadeOfIsNotSaidToReplay) {
  const std::string file = temporary_path("scene.mcap");
  Scene scene = small_scene();
  scene.objects[0].winding = Winding::as_is;
  scene.objects[0].mesh.triangles[0][1] = 7;  // a corner that is not there
  write_recording(file, scene, random_records(50, 3));
  const CopyResult result = copy({file}, temporary_path("part.mcap"), {20, 30, std::nullopt});
  EXPECT_EQ(result.ticks, 10u);
  EXPECT_FALSE(result.replayable);
}

TEST_F(Copied, PartsThatDoNotMeetAreNotSaidToReplay) {
  const std::string first = temporary_path("1.mcap"), second = temporary_path("2.mcap"),
                    merged = temporary_path("merged.mcap");
  EXPECT_TRUE(copy({path()}, first, {0, 100, std::nullopt}).replayable);
  EXPECT_TRUE(copy({path()}, second, {200, 300, std::nullopt}).replayable);
  EXPECT_FALSE(copy({first, second}, merged).replayable);
  copy({path()}, second, {100, 300, std::nullopt});
  EXPECT_TRUE(copy({first, second}, merged).replayable);
  EXPECT_EQ(replay_of(merged).ticks, 300u);
}

TEST_F(Copied, PartsOfTwoSessionsInOneSceneAreNotPutTogether) {
  const std::string other = temporary_path("other.mcap"), first = temporary_path("1.mcap"),
                    second = temporary_path("2.mcap"), merged = temporary_path("merged.mcap");
  record(other, 30);
  copy({path()}, first, {0, 490, std::nullopt});
  copy({other}, second, {490, 600, std::nullopt});
  CopyResult result;
  const Status status = copy_recordings({first, second}, merged, {}, result);
  EXPECT_NE(status.message().find("recordings of one session"), std::string::npos) << status.message();
  EXPECT_FALSE(std::filesystem::exists(merged));
}

TEST_F(Copied, MistakesAreNamedAndLeaveNothingBehind) {
  const std::string a = temporary_path("a.mcap"), b = temporary_path("b.mcap"),
                    other = temporary_path("other.mcap"), out = temporary_path("out.mcap");
  copy({path()}, a, {0, 100, std::nullopt});
  copy({path()}, b, {100, 200, std::nullopt});
  write_recording(other, small_scene(), random_records(5, 3));
  const auto message = [&](const std::vector<std::string>& inputs, const std::string& output) {
    CopyResult result;
    return copy_recordings(inputs, output, {}, result).message();
  };
  EXPECT_NE(message({b, a}, out).find("does not follow"), std::string::npos);
  EXPECT_NE(message({a, a}, out).find("does not follow"), std::string::npos);
  EXPECT_NE(message({a, other}, out).find("is not that of the first"), std::string::npos);
  EXPECT_NE(message({a, b}, b).find("is there already"), std::string::npos);
  EXPECT_NE(message({}, out).find("at least one"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_FALSE(std::filesystem::exists(out + ".part"));
  RecordingInfo info;
  EXPECT_TRUE(verify_recording(b, info).ok());
}

// From tick 700 on, the state before which is found by running ticks before it.
TEST_F(Copied, LeavesNoFileWhereItIsStopped) {
  const std::string output = temporary_path("stopped.mcap");
  for (const int most : {0, 3, 40, 400}) {
    int asked = 0;
    const auto stop = [&asked, most] { return ++asked > most; };
    const auto copied = [&] {
      CopyResult result;
      CopyOptions options{700, kTicks, std::nullopt};
      options.stop = stop;
      return copy_recordings({path()}, output, options, result);
    };
    const auto recovered = [&] {
      std::uint64_t kept = 0, lost = 0;
      return recover_recording(path(), output, kept, lost, nullptr, stop);
    };
    const auto changed = [&] {
      RecordingReader reader;
      EXPECT_TRUE(reader.open(path()).ok());
      ReplayOptions options;
      options.stiffness = 1e7;
      options.record = output;
      options.stop = stop;
      WhatIfResult result;
      return what_if(reader, options, result);
    };
    const std::vector<std::function<Status()>> writers = {copied, recovered, changed};
    for (std::size_t i = 0; i < writers.size(); ++i) {
      if (i == 1 && most > 3) continue;  // asks with every chunk
      asked = 0;
      EXPECT_NE(writers[i]().message().find("stopped"), std::string::npos) << i << " " << most;
      EXPECT_FALSE(std::filesystem::exists(output)) << i << " " << most;
      EXPECT_FALSE(std::filesystem::exists(output + ".part")) << i << " " << most;
    }
  }
}

TEST_F(Copied, PartTornAfterwardsKeepsItsStateWhenRecovered) {
  const std::string part = temporary_path("part.mcap"), recovered = temporary_path("recovered.mcap");
  copy({path()}, part, {200, 1100, std::nullopt});
  const std::vector<std::uint8_t> bytes = read_bytes(part);
  write_bytes(part, std::span(bytes).first(bytes.size() * 3 / 4));
  std::uint64_t kept = 0, lost = 0;
  ASSERT_TRUE(recover_recording(part, recovered, kept, lost).ok());
  EXPECT_GT(kept, 200u);
  EXPECT_EQ(replay_of(recovered).ticks, kept);
}

TEST(StateMessage, WithJointsThatNoHandHasIsRefused) {
  for (const double joints : {-1.0, 0.5, 1.0 * (1u << kJointCount), 1e300}) {
    State proxied, moving, decoded;
    proxied.proxy.emplace().valid = joints;
    moving.motion.emplace().valid = joints;
    EXPECT_FALSE(decode_state(encode_state(proxied), decoded).ok()) << joints;
    EXPECT_FALSE(decode_state(encode_state(moving), decoded).ok()) << joints;
  }
}

TEST(StateMessage, BringsEveryBitBackAndSurvivesAnyDamage) {
  State state;
  state.tick = 0x123456789abcdefu;
  state.rise = 0.25;
  state.fall = 1;
  state.joints = 5;
  state.ends[3].y = -0.0;
  state.last.segment[3].force = {-0.0, 1e-310, 3};
  state.held.flexion_torque[15] = -7.5;
  const std::vector<std::uint8_t> bytes = encode_state(state);
  State decoded;
  ASSERT_TRUE(decode_state(bytes, decoded).ok());
  EXPECT_EQ(hash_state(decoded), hash_state(state));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(decode_state(std::span(bytes).first(size), decoded).ok()) << size;
  for (std::size_t i = 0; i < 8 * bytes.size(); ++i) {
    std::vector<std::uint8_t> damaged = bytes;
    damaged[i / 8] ^= static_cast<std::uint8_t>(1u << (i % 8));
    const bool taken = decode_state(damaged, decoded).ok();
    EXPECT_TRUE(!taken || (decoded.rise >= 0 && decoded.rise <= 1));
  }
}

}  // namespace
}  // namespace lumbrical::test
