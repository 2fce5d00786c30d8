// What the recording tests share: small scenes, ticks, files, and a way to alter a file and mend its
// checksums.
#pragma once

#include <gtest/gtest.h>
#include <cmath>

#include <bit>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "files.h"
#include "files/output_file.h"
#include "flatbuffers/flatbuffers.h"
#include "lumbrical/recording.h"
#include "lumbrical/shapes.h"
#include "names.h"
#include "recording/mcap_reader.h"
#include "recording/record_fields.h"
#include "recording/recorder.h"
#include "recording/session_message.h"
#include "recording/tick_message.h"

namespace lumbrical::test {

/// A file of that name in the running test's own folder.
inline std::string temporary_path(const std::string& name) { return (own_folder() / name).string(); }

/// The path, where nothing is any more: no recording is written over another.
inline const std::string& cleared(const std::string& path) {
  std::remove(path.c_str());
  std::remove((path + kPartSuffix).c_str());
  return path;
}

inline std::vector<std::uint8_t> read_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write_bytes(const std::string& path, std::span<const std::uint8_t> bytes) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// A hand over one triangle: the smallest scene, for tests that go through a file byte by byte.
inline Scene small_scene() {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"triangle", {{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}}, {{0, 1, 2}}}});
  return scene;
}

/// Numbers of any kind: all bit patterns, with zeros of both signs, infinities and NaNs more often than
/// chance has it.
class RandomBits {
 public:
  explicit RandomBits(std::uint64_t seed) : engine_(seed) {}
  std::uint64_t word() { return engine_(); }
  bool coin() { return (word() & 1) != 0; }
  double real() {
    constexpr std::uint64_t kSpecial[] = {
        0, std::uint64_t{1} << 63, 0x7ff0000000000000u, 0xfff8000000001234u, 0x7ff0000000000001u, 1};
    return std::bit_cast<double>(coin() ? word() : kSpecial[word() % std::size(kSpecial)]);
  }
  float real32() {
    constexpr std::uint32_t kSpecial[] = {0, 0x80000000u, 0x7f800000u, 0xffc01234u, 0x7f800001u, 1};
    return std::bit_cast<float>(coin() ? static_cast<std::uint32_t>(word())
                                       : kSpecial[word() % std::size(kSpecial)]);
  }
  Vec3 vector() { return {real(), real(), real()}; }

 private:
  std::mt19937_64 engine_;
};

template <class T>
void fill(T& value, RandomBits& random) {
  walk(value, [&random]<class N>(const FieldName&, N& number) {
    if constexpr (std::is_same_v<N, double>) {
      number = random.real();
    } else if constexpr (std::is_same_v<N, float>) {
      number = random.real32();
    } else if constexpr (std::is_same_v<N, InputKind>) {
      number = random.coin() ? InputKind::joint_poses : InputKind::joint_angles;
    } else {
      number = static_cast<N>(random.word());
    }
  });
}

/// Makes the hashes of input and output those of what is in the record, as verify wants them.
inline void seal(TickRecord& record) {
  record.stage_hash[static_cast<std::size_t>(Stage::input)] = hash_fields(record.device);
  record.stage_hash[static_cast<std::size_t>(Stage::limits)] = hash_fields(record.output);
}

/// A tick of the given number in which any field may hold anything, or its default.
inline TickRecord random_record(RandomBits& random, std::uint64_t tick) {
  TickRecord record;
  const auto fill_some = [&random](const char*, const char*, auto& field) {
    if (random.coin()) fill(field, random);
  };
  list_fields(record.device, fill_some);
  list_fields(record.output, fill_some);
  if (random.coin()) record.device.joint[random.word() % kJointCount].position[0] = -0.0f;
  if (random.coin()) record.output.segment[random.word() % kSegmentCount] = {};
  record.output.tick = tick;
  // The one number in a table's field: its -0, which no sum of bounds is, would come back as +0.
  record.output.force_error = std::fabs(record.output.force_error);
  for (std::uint64_t& hash : record.stage_hash) hash = random.coin() ? random.word() : 0;
  seal(record);
  record.state_hash = random.word();
  record.duration_ns = static_cast<std::uint32_t>(random.word());
  if (random.word() % 16 == 0) {
    record.sent_count = static_cast<std::uint32_t>(random.word() % (kMaxSentPerTick + 1));
  }
  if (random.word() % 16 == 0) record.timing = {random.real(), random.real(), random.real()};
  for (std::uint32_t i = 0; i < record.sent_count; ++i) {
    SentCommand& sent = record.sent[i];
    sent.cycle = random.word();
    sent.tick = random.word();
    sent.sent = static_cast<std::int64_t>(random.word());
    sent.acknowledged = static_cast<std::int64_t>(random.word());
    sent.loop_delay = static_cast<std::int64_t>(random.word());
    sent.state = static_cast<SafetyState>(random.word() % 5);
    sent.flags = static_cast<std::uint32_t>(random.word());
    sent.actuator_count = static_cast<std::uint32_t>(random.word() % (kMaxActuators + 1));
    for (std::uint32_t k = 0; k < sent.actuator_count; ++k) sent.value[k] = random.real();
  }
  return record;
}

/// Every field, by its bits.
inline void expect_same(const TickRecord& a, const TickRecord& b) {
  EXPECT_EQ(input_fields(a), input_fields(b));
  EXPECT_EQ(output_fields(a.output), output_fields(b.output));
  EXPECT_EQ(a.output.tick, b.output.tick);
  EXPECT_EQ(a.has_forces, b.has_forces);
  EXPECT_EQ(a.stage_hash, b.stage_hash);
  EXPECT_EQ(a.state_hash, b.state_hash);
  EXPECT_EQ(a.duration_ns, b.duration_ns);
  ASSERT_EQ(a.timing.has_value(), b.timing.has_value());
  if (a.timing) {
    for (double LoopTiming::*const number : {&LoopTiming::period, &LoopTiming::jitter, &LoopTiming::delay})
      EXPECT_EQ(std::bit_cast<std::uint64_t>(*a.timing.*number),
                std::bit_cast<std::uint64_t>(*b.timing.*number));
  }
  ASSERT_EQ(a.sent_count, b.sent_count);
  for (std::uint32_t i = 0; i < a.sent_count; ++i) {
    const SentCommand &x = a.sent[i], &y = b.sent[i];
    EXPECT_EQ(
        std::tie(x.cycle, x.tick, x.sent, x.acknowledged, x.loop_delay, x.state, x.flags, x.actuator_count),
        std::tie(y.cycle, y.tick, y.sent, y.acknowledged, y.loop_delay, y.state, y.flags, y.actuator_count));
    for (std::uint32_t k = 0; k < x.actuator_count; ++k) {
      EXPECT_EQ(std::bit_cast<std::uint64_t>(x.value[k]), std::bit_cast<std::uint64_t>(y.value[k]));
    }
  }
}

inline bool is_same(const TickRecord& a, const TickRecord& b) {
  return input_fields(a) == input_fields(b) && output_fields(a.output) == output_fields(b.output) &&
         a.stage_hash == b.stage_hash && a.state_hash == b.state_hash && a.duration_ns == b.duration_ns;
}

inline std::vector<TickRecord> random_records(std::uint64_t count, std::uint64_t seed) {
  RandomBits random(seed);
  std::vector<TickRecord> records;
  for (std::uint64_t tick = 0; tick < count; ++tick) records.push_back(random_record(random, tick));
  return records;
}

inline void write_recording(const std::string& path, const Scene& scene,
                            const std::vector<TickRecord>& records, const RecorderOptions& options = {}) {
  Recorder recorder;
  Status status = recorder.open(cleared(path), scene, options);
  ASSERT_TRUE(status.ok()) << status.message();
  for (const TickRecord& record : records) ASSERT_TRUE(recorder.record(record));
  status = recorder.close();
  ASSERT_TRUE(status.ok()) << status.message();
}

/// All records up to the end or the first error.
inline Status read_records(RecordingReader& reader, std::vector<TickRecord>& records) {
  for (;;) {
    TickRecord record;
    bool end = false;
    if (Status status = reader.next(record, end); !status.ok()) return status;
    if (end) return {};
    records.push_back(record);
  }
}

/// Copies a recording, giving every tick to `edit` on the way (false: leave it out). The container's
/// checksums are right again, the messages' own input checks are those of the original.
inline void alter_recording(const std::string& from, const std::string& to,
                            const std::function<bool(TickRecord&)>& edit) {
  RecordingReader reader;
  ASSERT_TRUE(reader.open(from).ok());
  std::vector<std::uint8_t> session;
  ASSERT_TRUE(encode_session(reader.scene(), session).ok());
  McapWriter writer;
  const double rate = reader.scene().settings.rate;
  Status status = open_recording(cleared(to), rate, session, {}, reader.info().metadata, {}, writer);
  ASSERT_TRUE(status.ok()) << status.message();
  flatbuffers::FlatBufferBuilder builder;
  for (;;) {
    TickRecord record;
    bool end = false;
    ASSERT_TRUE(reader.next(record, end).ok());
    if (end) break;
    const std::uint64_t tick = record.output.tick;
    const InputCheck check = input_check_of(record);
    if (!edit(record)) continue;
    encode_tick(record, record.has_forces, check, builder);
    status = writer.message(tick_time(tick, 1e9 / rate), static_cast<std::uint32_t>(tick),
                            {builder.GetBufferPointer(), builder.GetSize()});
    ASSERT_TRUE(status.ok()) << status.message();
  }
  status = writer.close();
  ASSERT_TRUE(status.ok()) << status.message();
}

}  // namespace lumbrical::test
