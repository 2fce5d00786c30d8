// A session's device as its recording tells it: one event per change, whatever lies between.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "files.h"
#include "recording_fixture.h"

namespace lumbrical::test {
namespace {

class Device : public ::testing::Test {
 protected:
  /// A tick with one command of that state, flags, answer and delay [ms].
  void add(SafetyState state, std::uint32_t flags, bool answered, double delay) {
    TickRecord record;
    record.output.tick = records_.size();
    seal(record);
    record.sent_count = 1;
    SentCommand& sent = record.sent[0];
    sent.cycle = records_.size() + 1;
    sent.sent = 1000;
    sent.acknowledged = answered ? 2000 : 0;
    sent.loop_delay = static_cast<std::int64_t>(1e6 * delay);
    sent.state = state;
    sent.flags = flags;
    records_.push_back(record);
  }
  void SetUp() override {
    for (int i = 0; i < 3; ++i) add(SafetyState::idle, 0, true, 2);
    add(SafetyState::armed, kDeadManReleased, true, 2.1);
    add(SafetyState::active, kSoftStart, true, 2.2);
    add(SafetyState::active, kSoftStart | kClamped, true, 21);
    for (int i = 0; i < 4; ++i) add(SafetyState::active, kAnswerLost, false, 0);
    records_.back().timing = {0.002, 0.001, 0.021};
    add(SafetyState::active, 0, true, 3);
    add(SafetyState::fault, kStopPressed | kTickStopped, false, 0);
    write_recording(path_, small_scene(), records_);
    ASSERT_TRUE(reader_.open(path_).ok());
  }

  std::vector<TickRecord> records_;
  std::string path_ = temporary_path("a.mcap");
  RecordingReader reader_;
};

TEST_F(Device, EveryChangeIsAnEventAtItsTick) {
  DeviceHistory history;
  ASSERT_TRUE(read_device_history({&reader_, 1}, history).ok());
  std::vector<std::string> events;
  for (const DeviceEvent& event : history.events) {
    EXPECT_DOUBLE_EQ(event.time, 1e-3 * static_cast<double>(event.tick));
    events.push_back(std::to_string(event.tick) + " " + event.kind + ": " + event.text);
  }
  const std::vector<std::string> expected = {
      "0 state: idle",
      "0 delay: 2 ms from reading angles to the reply",
      "3 state: idle -> armed",
      "3 flags: dead-man switch released",
      "4 state: armed -> active",
      "4 flags: soft start",
      "4 flags: no longer dead-man switch released",
      "5 flags: command clamped",
      "5 delay: 21 ms from reading angles to the reply",
      "6 flags: answer lost",
      "6 flags: no longer command clamped, soft start",
      "6 commands: command 7 not acknowledged",
      "9 certificate: renewed for a period of 2 ms, 1 ms of jitter, a delay of 21 ms",
      "10 flags: no longer answer lost",
      "10 commands: acknowledged again after 4 that were not",
      "11 state: active -> fault",
      "11 flags: stop pressed, tick stopped",
      "11 commands: command 12 not acknowledged",
      "11 commands: 1 not acknowledged at the end"};
  EXPECT_EQ(events, expected);
  EXPECT_EQ(history.commands, 12u);
  EXPECT_EQ(history.acknowledged, 7u);
  EXPECT_DOUBLE_EQ(history.largest_delay, 0.021);
  EXPECT_NEAR(history.mean_delay, (3 * 2 + 2.1 + 2.2 + 21 + 3) * 1e-3 / 7, 1e-12);
}

TEST_F(Device, WhatWasNotSentIsNoCommandButItsStateIsAnEvent) {
  add(SafetyState::disconnected, kAnswerLost, false, 0);
  records_.back().sent[0].sent = 0;
  write_recording(path_, small_scene(), records_);
  ASSERT_TRUE(reader_.open(path_).ok());
  DeviceHistory history;
  ASSERT_TRUE(read_device_history({&reader_, 1}, history).ok());
  EXPECT_EQ(history.commands, 12u);
  ASSERT_FALSE(history.events.empty());
  EXPECT_EQ(history.events.back().text, "1 not acknowledged at the end");
  EXPECT_TRUE(std::any_of(history.events.begin(), history.events.end(), [](const DeviceEvent& event) {
    return event.tick == 12 && event.text == "fault -> disconnected";
  }));
}

TEST_F(Device, OfTwoHandsTheOneThatItDroveHasTheHistory) {
  const std::string undriven = temporary_path("undriven.mcap");
  TickRecord record;
  seal(record);
  write_recording(undriven, small_scene(), {record});
  std::vector<RecordingReader> hands(2);
  for (const bool first : {true, false}) {
    ASSERT_TRUE(hands[first ? 0 : 1].open(path_).ok());
    ASSERT_TRUE(hands[first ? 1 : 0].open(undriven).ok());
    DeviceHistory history;
    ASSERT_TRUE(read_device_history(hands, history).ok());
    EXPECT_EQ(history.commands, 12u);
  }
}

TEST_F(Device, EventsAreExportedOneALine) {
  const std::string csv = temporary_path("events.csv"), json = temporary_path("events.json");
  ASSERT_TRUE(export_device_events({&reader_, 1}, {}, csv).ok());
  const std::string text = read_file(csv);
  EXPECT_EQ(text.find("tick,time [s],kind,text\n0,0,state,\"idle\"\n"), 0u) << text;
  EXPECT_NE(text.find("\n6,0.006,commands,\"command 7 not acknowledged\"\n"), std::string::npos) << text;
  ExportOptions as_json;
  as_json.format = ExportFormat::json;
  ASSERT_TRUE(export_device_events({&reader_, 1}, as_json, json).ok());
  EXPECT_NE(read_file(json).find(R"({"tick":3,"time":0.003,"kind":"state","text":"idle -> armed"})"),
            std::string::npos);
}

// Of two hands the first is looked through for commands before.
TEST_F(Device, EventsLeaveNoFileWhereTheirExportIsStopped) {
  const std::string csv = temporary_path("events.csv");
  RecordingReader hands[2];
  for (RecordingReader& hand : hands) ASSERT_TRUE(hand.open(path_).ok());
  for (const int most : {0, 2, 5}) {
    int asked = 0;
    ExportOptions options;
    options.stop = [&asked, most] { return ++asked > most; };
    EXPECT_NE(export_device_events(hands, options, csv).message().find("stopped"), std::string::npos);
    EXPECT_LE(asked, most + 2);
    EXPECT_FALSE(std::filesystem::exists(csv));
    EXPECT_FALSE(std::filesystem::exists(csv + ".part"));
  }
}

TEST_F(Device, OfEventsTicksCanBeChosenAndNothingElse) {
  const std::string csv = temporary_path("events.csv");
  ExportOptions options;
  options.first = 3;
  options.last = 5;
  options.step = 2;
  ASSERT_TRUE(export_device_events({&reader_, 1}, options, csv).ok());
  const std::string text = read_file(csv);
  EXPECT_NE(text.find("\n3,0.003,state,\"idle -> armed\"\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\n5,0.005,flags,\"command clamped\"\n"), std::string::npos) << text;
  for (const char* const other : {"\n0,", "\n4,", "\n6,", "\n11,"})
    EXPECT_EQ(text.find(other), std::string::npos) << other;
  options.first = options.last = 1000000;
  EXPECT_NE(export_device_events({&reader_, 1}, options, csv).message().find("no tick is in that range"),
            std::string::npos);
  ExportOptions columns, segments, exact;
  columns.columns = {"force"};
  segments.segments = {2};
  exact.exact = true;
  for (const ExportOptions& refused : {columns, segments, exact})
    EXPECT_NE(export_device_events({&reader_, 1}, refused, csv).message().find("of events"),
              std::string::npos);
}

}  // namespace
}  // namespace lumbrical::test
