// Recordings of two hands on one world: each hand is read, replayed and copied as if it were alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "touch_session.h"

namespace lumbrical::test {
namespace {

Hand left_hand() { return mirrored_hand(touch_scene().hand); }

// Mirrored in the yz-plane, where the ball is symmetric, and a little behind the right one.
DeviceFrame left_frame(std::uint64_t tick) {
  return touch_frame(tick > 40 ? tick - 40 : 0, InputKind::joint_angles, left_hand());
}

/// Both hands over the ball, tick by tick; records of the left one for which `keep` is false are left out.
template <class Keep>
void record_both(const std::string& path, Keep&& keep) {
  const Scene scene = touch_scene();
  std::array<Model, 2> models;
  ASSERT_TRUE(build_model(scene, {}, models[0]).ok());
  ASSERT_TRUE(share_world(models[0], left_hand(), models[1]).ok());
  RecorderOptions options;
  options.second_hand = left_hand();
  Recorder recorder;
  Status status = recorder.open(cleared(path), scene, options);
  ASSERT_TRUE(status.ok()) << status.message();
  std::array<State, 2> states;
  std::array<Scratch, 2> scratches = {make_scratch(models[0]), make_scratch(models[1])};
  std::array<std::uint64_t, 2> contacts{};
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    for (std::uint8_t hand = 0; hand < 2; ++hand) {
      TickRecord record;
      record.hand = hand;
      record.device = hand == 0 ? touch_frame(i, InputKind::joint_poses, scene.hand) : left_frame(i);
      record.output = tick(models[hand], states[hand], scratches[hand], record.device);
      take_results(states[hand], scratches[hand], record);
      contacts[hand] += record.output.contact_count;
      if (hand == 0 || keep(record)) {
        ASSERT_TRUE(recorder.record(record));
      }
    }
  }
  status = recorder.close();
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_GT(contacts[0], 0u);
  EXPECT_GT(contacts[1], 0u);
}

void record_both(const std::string& path) {
  record_both(path, [](const TickRecord&) { return true; });
}

RecordingReader opened(const std::string& path, Side side) {
  RecordingReader reader;
  const Status status = reader.open(path, side);
  EXPECT_TRUE(status.ok()) << status.message();
  return reader;
}

void expect_identical(const std::string& path, std::uint64_t ticks) {
  for (const Side side : {Side::left, Side::right}) {
    RecordingReader reader = opened(path, side);
    EXPECT_EQ(reader.scene().hand.side, side);
    EXPECT_EQ(reader.info().ticks, ticks);
    ReplayResult result;
    const Status status = replay(reader, {}, result);
    EXPECT_TRUE(status.ok()) << side_name(side) << ": " << status.message();
    EXPECT_EQ(result.ticks, ticks);
    EXPECT_FALSE(result.first_divergence) << side_name(side) << ", tick " << result.first_divergence->tick;
    EXPECT_EQ(result.damage, "");
  }
}

TEST(TwoHands, EachReplaysBitForBitFromOneFile) {
  const std::string path = temporary_path("both.mcap");
  record_both(path);
  expect_identical(path, kTicks);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  EXPECT_EQ(reader.scene().hand.side, Side::right) << "the session's first";
  EXPECT_EQ(reader.info().hands, (std::vector<Side>{Side::right, Side::left}));
  ASSERT_TRUE(reader.other_hand());
  EXPECT_EQ(reader.other_hand()->side, Side::left);
  RecordingInfo info;
  EXPECT_TRUE(verify_recording(path, info).ok());
  EXPECT_EQ(info.ticks, kTicks);
}

TEST(TwoHands, AreReplayedBothUpToTheFirstThatDiverges) {
  const std::string path = temporary_path("both.mcap");
  record_both(path);
  ReplayResult result;
  ASSERT_TRUE(replay_hands(path, {}, result).ok());
  EXPECT_FALSE(result.first_divergence);
  EXPECT_EQ(result.ticks, 2 * kTicks);
  record_both(path, [](TickRecord& record) {
    if (record.output.tick == 300) record.output.segment[5].force.x += 1e-9;
    return true;
  });
  ASSERT_TRUE(replay_hands(path, {}, result).ok());
  ASSERT_TRUE(result.first_divergence);
  EXPECT_EQ(result.first_divergence->tick, 300u);
}

TEST(TwoHands, MessagesOfBothComeInTheOrderOfTheirTicks) {
  const std::string path = temporary_path("both.mcap");
  record_both(path);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  for (std::uint64_t i = 0; i < 2 * kTicks; ++i) {
    RecordedMessage message;
    bool end = true;
    ASSERT_TRUE(reader.next_message(message, end).ok());
    ASSERT_FALSE(end);
    EXPECT_EQ(message.tick, i / 2);
    EXPECT_EQ(message.hand, i % 2);
  }
}

TEST(TwoHands, AHandThatIsNotThereIsRefused) {
  const std::string path = temporary_path("one.mcap");
  record_touch(path, InputKind::joint_angles);
  RecordingReader reader;
  EXPECT_NE(reader.open(path, Side::left).message().find("no left hand"), std::string::npos);
  RecorderOptions options;
  options.second_hand = touch_scene().hand;
  Recorder recorder;
  EXPECT_NE(recorder.open(temporary_path("same.mcap"), touch_scene(), options).message().find("both hands"),
            std::string::npos);
}

TEST(TwoHands, OfBothSidesOrTheSessionIsRefused) {
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(encode_session(touch_scene(), bytes, touch_scene().hand).ok());
  Scene scene;
  EXPECT_NE(decode_session(bytes, scene).message().find("both hands"), std::string::npos);
}

TEST(TwoHands, PartsOfASessionReplayOnTheirOwn) {
  const std::string path = temporary_path("both.mcap"), part = temporary_path("part.mcap");
  record_both(path);
  for (const std::uint64_t from : {0u, 1u, 333u}) {
    CopyResult result;
    const Status status =
        copy_recordings({path}, cleared(part), {from, from + 100, Compression::zstd}, result);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_TRUE(result.replayable);
    EXPECT_EQ(result.ticks, 100u);
    expect_identical(part, 100);
    std::filesystem::remove(part);
  }
}

TEST(TwoHands, PartsPutTogetherAreTheWholeByteForByte) {
  const std::string path = temporary_path("both.mcap"), first = temporary_path("1.mcap"),
                    second = temporary_path("2.mcap"), merged = temporary_path("merged.mcap");
  record_both(path);
  CopyResult result;
  ASSERT_TRUE(copy_recordings({path}, first, {0, 250, std::nullopt}, result).ok());
  ASSERT_TRUE(copy_recordings({path}, second, {250, kTicks, std::nullopt}, result).ok());
  ASSERT_TRUE(copy_recordings({first, second}, merged, {}, result).ok());
  EXPECT_EQ(read_bytes(merged), read_bytes(path));
}

TEST(TwoHands, MissingTicksOfEitherAreTold) {
  const std::string path = temporary_path("gap.mcap");
  record_both(path,
              [](const TickRecord& record) { return record.output.tick != 77 && record.output.tick < 590; });
  RecordingInfo info;
  std::vector<TickRange> missing;
  ASSERT_TRUE(verify_recording(path, info, &missing).ok());
  EXPECT_EQ(missing, (std::vector<TickRange>{{77, 77}, {590, kTicks - 1}}));
  std::vector<TickRange> lacking;
  std::uint64_t recovered = 0, lost = 0;
  ASSERT_TRUE(recover_recording(path, cleared(temporary_path("whole.mcap")), recovered, lost, &lacking).ok());
  EXPECT_EQ(lacking, missing);
  EXPECT_EQ(opened(path, Side::left).info().last_tick, 589u);
  EXPECT_EQ(opened(path, Side::right).info().last_tick, kTicks - 1);
  ReplayResult result;
  RecordingReader left = opened(path, Side::left), right = opened(path, Side::right);
  EXPECT_NE(replay(left, {}, result).message().find("tick 77 is missing"), std::string::npos);
  EXPECT_TRUE(replay(right, {}, result).ok());
}

TEST(TwoHands, AKilledRecordingComesBackWithBoth) {
  const std::string path = temporary_path("both.mcap"), torn = temporary_path("torn.mcap"),
                    whole = temporary_path("whole.mcap");
  record_both(path);
  std::vector<std::uint8_t> bytes = read_bytes(path);
  bytes.resize(bytes.size() / 2);
  write_bytes(torn, bytes);
  std::uint64_t recovered = 0, lost = 0;
  ASSERT_TRUE(recover_recording(torn, cleared(whole), recovered, lost).ok());
  EXPECT_EQ(lost, 0u);
  EXPECT_GT(recovered, 100u);
  EXPECT_EQ(recovered % 2, 0u);
  expect_identical(whole, recovered / 2);
}

/// Where the channel record of a topic has it: the schema's comments name topics too.
std::size_t topic_in_record(const std::vector<std::uint8_t>& file, const std::string& topic) {
  mcap::ByteWriter text;
  text.text(topic);
  const auto found = std::search(file.begin(), file.end(), text.bytes().begin(), text.bytes().end());
  return static_cast<std::size_t>(found - file.begin()) + sizeof(std::uint32_t);
}

// Channel records are covered by no checksum: what the index repeats of them stands in for them, or the
// recorder's numbering.
TEST(TwoHands, ComeBackFromAFileWhoseChannelRecordsAreDamaged) {
  const std::string path = temporary_path("both.mcap"), damaged = temporary_path("damaged.mcap"),
                    whole = temporary_path("whole.mcap");
  record_both(path);
  const std::vector<std::uint8_t> bytes = read_bytes(path);
  constexpr std::size_t kIdToTopic = 8;  // two numbers and a length
  for (const std::string topic : {"left/tick", "right/tick"})
    for (const std::size_t torn : {0, 1000}) {
      const std::size_t at = topic_in_record(bytes, topic);
      ASSERT_LT(at, bytes.size());
      // Another topic, a number that no channel has, the number of the other hand's.
      for (const auto& [place, bits] : {std::pair(at, 0x20), {at - kIdToTopic, 8}, {at - kIdToTopic, 3}}) {
        std::vector<std::uint8_t> changed = bytes;
        changed.resize(bytes.size() - torn);
        changed[place] = static_cast<std::uint8_t>(changed[place] ^ bits);
        write_bytes(damaged, changed);
        std::uint64_t recovered = 0, lost = 0;
        ASSERT_TRUE(recover_recording(damaged, cleared(whole), recovered, lost).ok());
        EXPECT_EQ(recovered, 2 * kTicks) << topic << ' ' << torn << ' ' << bits;
        EXPECT_EQ(lost, 0u) << topic << ' ' << torn << ' ' << bits;
        expect_identical(whole, kTicks);
      }
    }
}

TEST(TwoHands, ATickOnTheOtherHandsChannelIsFound) {
  const std::string path = temporary_path("both.mcap"), swapped = temporary_path("swapped.mcap");
  record_both(path);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  std::vector<std::uint8_t> session;
  ASSERT_TRUE(encode_session(reader.scene(), session, reader.other_hand()).ok());
  McapWriter writer;
  ASSERT_TRUE(
      open_recording(swapped, 1000, session, {}, {}, {}, writer, channels_of(reader.info().hands)).ok());
  RecordedMessage message;
  for (bool end = false; !end;) {
    ASSERT_TRUE(reader.next_message(message, end).ok());
    if (end) break;
    const std::size_t channel = message.tick == 300 ? 1u - message.hand : message.hand;
    ASSERT_TRUE(writer
                    .message(tick_time(message.tick, 1e6), static_cast<std::uint32_t>(message.tick),
                             message.bytes, channel)
                    .ok());
  }
  ASSERT_TRUE(writer.close().ok());
  RecordingReader right = opened(swapped, Side::right);
  ReplayResult result;
  ASSERT_TRUE(replay(right, {}, result).ok());
  ASSERT_TRUE(result.first_divergence);
  EXPECT_EQ(result.first_divergence->tick, 300u);
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

TEST(TwoHands, StandSideBySideInATable) {
  const std::string path = temporary_path("gap.mcap"), table = temporary_path("table.csv");
  record_both(path, [](const TickRecord& record) { return record.output.tick != 77; });
  std::vector<RecordingReader> readers;
  ASSERT_TRUE(open_hands(path, readers).ok());
  ASSERT_EQ(readers.size(), 2u);
  ExportOptions options;
  options.columns = {"contact_count"};
  ASSERT_TRUE(export_recording(readers, options, table).ok());
  std::ifstream in(table);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "tick,time [s],right.contact_count,left.contact_count");
  std::array<TickRecord, 2> records;
  for (RecordingReader& reader : readers) ASSERT_TRUE(reader.seek(0).ok());
  for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
    bool end = false;
    ASSERT_TRUE(readers[0].next(records[0], end).ok());
    if (tick != 77) {
      ASSERT_TRUE(readers[1].next(records[1], end).ok());
    }
    ASSERT_TRUE(std::getline(in, line));
    std::vector<std::string> cells = cells_of(line);
    cells.resize(4);
    EXPECT_EQ(cells[0], std::to_string(tick));
    EXPECT_EQ(cells[2], std::to_string(records[0].output.contact_count));
    EXPECT_EQ(cells[3], tick == 77 ? "" : std::to_string(records[1].output.contact_count));
  }
  EXPECT_FALSE(std::getline(in, line));
}

}  // namespace
}  // namespace lumbrical::test
