// Export of recordings as CSV and JSON lines.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <new>
#include <sstream>

#include "files/text_output.h"
#include "recording/export_columns.h"
#include "recording_fixture.h"

namespace lumbrical {
namespace {

using test::temporary_path;

std::vector<std::string> lines_of(const std::string& path) {
  std::ifstream in(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

ExportOptions as(ExportFormat format) {
  ExportOptions options;
  options.format = format;
  return options;
}

std::vector<std::vector<std::string>> table_of(RecordingReader& reader, const ExportOptions& options) {
  const std::string output = temporary_path("table.csv");
  std::filesystem::remove(output);
  const Status status = export_recording(reader, options, output);
  EXPECT_TRUE(status.ok()) << status.message();
  std::vector<std::vector<std::string>> table;
  for (const std::string& line : lines_of(output)) table.push_back(cells_of(line));
  return table;
}

std::size_t column(const std::vector<std::vector<std::string>>& table, const std::string& name) {
  const auto found = std::find(table.at(0).begin(), table.at(0).end(), name);
  EXPECT_NE(found, table[0].end()) << name;
  return static_cast<std::size_t>(found - table[0].begin());
}

void open_random(RecordingReader& reader, std::size_t count) {
  const std::string path = temporary_path("a.mcap");
  std::vector<TickRecord> records = test::random_records(count, 1);
  for (TickRecord& record : records) record.device.base.position = {0.1, 1.0 / 3, 0.5};
  records[2].device.base.position.y = 0.1;
  test::write_recording(path, test::small_scene(), records);
  ASSERT_TRUE(reader.open(path).ok());
}

TEST(Export, WritesEveryNumberExactlyAsCsvWhereThatIsAsked) {
  RecordingReader reader;
  open_random(reader, 5);
  ExportOptions options;
  options.columns = {"all"};
  options.exact = true;
  const auto table = table_of(reader, options);
  ASSERT_EQ(table.size(), 6u);
  for (const auto& line : table) EXPECT_EQ(line.size(), table[0].size());
  EXPECT_EQ(table[3][column(table, "base.position.y [m]")], "0.1");
  EXPECT_EQ(table[2][column(table, "base.position.y [m]")], "0.3333333333333333");
  EXPECT_EQ(table[3][column(table, "tick")], "2");
  EXPECT_EQ(table[3][column(table, "time [s]")], "0.002");
  column(table, "palm.torque.z [N m]");
  column(table, "joint.index_tip.orientation.w");
  column(table, "angle.little.flexion_3 [rad]");
  column(table, "thumb_metacarpal.joint_torque.x [N m]");
  column(table, "ring_distal.flexion_torque [N m]");
  EXPECT_EQ(table[0].back(), "hash.state");
  // Every number has a name of its own.
  std::vector<std::string> names = table[0];
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

TEST(Export, HoldsOnlyColumnsThatVaryUnlessTheyAreAskedFor) {
  RecordingReader reader;
  open_random(reader, 5);
  const auto table = table_of(reader, {});
  EXPECT_EQ(table[0][0], "tick");
  EXPECT_EQ(table[0][1], "time [s]");
  EXPECT_EQ(std::count(table[0].begin(), table[0].end(), "base.position.x [m]"), 0);
  EXPECT_EQ(table[1][column(table, "base.position.y [m]")], "0.333333");
  column(table, "index_distal.force.x [N]");
  EXPECT_EQ(std::count(table[0].begin(), table[0].end(), "hash.state"), 0);
  ExportOptions options;
  options.columns = {"base.position"};
  EXPECT_EQ(table_of(reader, options)[0],
            (std::vector<std::string>{"tick", "time [s]", "base.position.x [m]", "base.position.y [m]",
                                      "base.position.z [m]"}));
  options.columns = {"force.z", "flags"};
  options.segments = {kPalmSegment, 5};
  EXPECT_EQ(table_of(reader, options)[0],
            (std::vector<std::string>{"tick", "time [s]", "device_flags", "flags", "index_distal.force.z [N]",
                                      "palm.force.z [N]"}));
  options.columns = {"colour"};
  EXPECT_NE(export_recording(reader, options, temporary_path("none.csv")).message().find("\"colour\""),
            std::string::npos);
}

TEST(Export, LeavesNoFileWhereItIsStopped) {
  RecordingReader reader;
  open_random(reader, 50);
  const std::string output = temporary_path("stopped");
  for (const ExportFormat format : {ExportFormat::csv, ExportFormat::json, ExportFormat::npz}) {
    for (const int most : {0, 20, 60}) {
      int asked = 0;
      ExportOptions options = as(format);
      options.stop = [&asked, most] { return ++asked > most; };
      if (format == ExportFormat::json && most > 50) continue;  // reads once
      const Status status = export_recording(reader, options, output);
      EXPECT_NE(status.message().find("stopped"), std::string::npos) << status.message();
      EXPECT_FALSE(std::filesystem::exists(output));
      EXPECT_FALSE(std::filesystem::exists(output + ".part"));
    }
  }
}

TEST(Export, TellsWhereObjectsAreAndWhatTheyFeel) {
  Scene scene = test::small_scene();
  SceneObject& mug = scene.objects.emplace_back(scene.objects[0]);
  mug.name = "a mug";
  mug.mechanism.mobility = Mobility::given;
  std::vector<TickRecord> records = test::random_records(3, 1);
  for (TickRecord& record : records) {
    record.object_count = 1;
    record.object[0].pose.position = {0.5, 0.25 * static_cast<double>(record.output.tick), 0};
    record.object[0].wrench.force.z = -2;
  }
  const std::string path = temporary_path("mug.mcap");
  test::write_recording(path, scene, records);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  auto table = table_of(reader, {});
  EXPECT_EQ(table[3][column(table, "object.a_mug.position.y [m]")], "0.5");
  EXPECT_EQ(std::count(table[0].begin(), table[0].end(), "object.a_mug.position.x [m]"), 0)
      << "does not vary";
  EXPECT_EQ(std::count(table[0].begin(), table[0].end(), "object.a_mug.wrench.force.z [N]"), 0);
  ExportOptions options;
  options.columns = {"a mug"};
  table = table_of(reader, options);
  EXPECT_EQ(table[0].size(), 2 + 7 + 6 + 1u);
  EXPECT_EQ(table[1][column(table, "object.a_mug.wrench.force.z [N]")], "-2");
  const std::string json = temporary_path("mug.json");
  std::filesystem::remove(json);
  ASSERT_TRUE(export_recording(reader, as(ExportFormat::json), json).ok());
  EXPECT_NE(lines_of(json).at(2).find(R"("objects":[{"pose":{"position":[0.5,0.5,0],)"), std::string::npos);
}

TEST(Export, GivesEachColumnANameOfItsOwnThatTablesAndArchivesCanHold) {
  ExportedSession session{{Side::right}, {}};
  session.objects = {"a,\"b\"\n",
                     "../c\\d",
                     "same",
                     "same",
                     "same_3",
                     "",
                     "Gr\xc3\xb6\xc3\x9f"
                     "e",
                     "same",
                     std::string(70000, 'x'),
                     std::string(70000, 'x')};
  std::vector<std::string> names;
  for (const ExportColumn& column : export_columns(session)) {
    EXPECT_EQ(column.name.find_first_of(",\"'\n/\\ "), std::string::npos) << column.name;
    EXPECT_LT(column.name.size(), 100u);
    names.push_back(column.name);
  }
  for (const char* const name : {"a__b__", ".._c_d", "same", "same_3", "same_3_4", "5", "Gr__e", "same_7"})
    EXPECT_EQ(std::count(names.begin(), names.end(), "object." + std::string(name) + ".position.x"), 1)
        << name;
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end()) << "a name twice";
  ExportOptions options;
  options.columns = {"../c\\d"};
  std::vector<ExportColumn> columns;
  ASSERT_TRUE(choose_columns(options, session, columns).ok());
  EXPECT_EQ(columns.size(), 2 + 7 + 6 + 1u) << "named as the object is";
}

TEST(Export, TakesARangeOfTicksAndEveryNth) {
  RecordingReader reader;
  open_random(reader, 50);
  ExportOptions options;
  options.first = 10;
  options.last = 30;
  options.step = 5;
  const auto table = table_of(reader, options);
  ASSERT_EQ(table.size(), 6u);
  for (std::size_t i = 1; i < table.size(); ++i) EXPECT_EQ(table[i][0], std::to_string(5 + 5 * i));
}

// Nothing varies in a single row, and its numbers are what was asked for.
TEST(Export, OfASingleTickHoldsWhatIsNotZeroAndOfNoneSaysWhichThereAre) {
  RecordingReader reader;
  open_random(reader, 50);
  ExportOptions options;
  const std::size_t columns = table_of(reader, options)[0].size();
  options.first = options.last = 30;
  const auto table = table_of(reader, options);
  ASSERT_EQ(table.size(), 2u);
  EXPECT_GT(table[0].size(), columns / 2);
  options.first = options.last = 70;
  const std::string output = temporary_path("none");
  for (const ExportFormat format : {ExportFormat::csv, ExportFormat::json, ExportFormat::npz}) {
    std::filesystem::remove(output);
    options.format = format;
    const Status none = export_recording(reader, options, output);
    ASSERT_FALSE(none.ok());
    EXPECT_NE(none.message().find("it holds 0 to 49"), std::string::npos) << none.message();
    EXPECT_FALSE(std::filesystem::exists(output));
  }
}

TEST(Export, WritesJsonLinesAndLeavesNothingHalfWritten) {
  const std::string path = temporary_path("a.mcap"), output = temporary_path("a.jsonl");
  test::write_recording(path, test::small_scene(), test::random_records(600, 1));
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  ASSERT_TRUE(export_recording(reader, as(ExportFormat::json), output).ok());
  const std::vector<std::string> lines = lines_of(output);
  ASSERT_EQ(lines.size(), 600u);
  for (const std::string& line : lines) {
    EXPECT_EQ(line.find("{\"tick\":"), 0u);
    EXPECT_EQ(line.back(), '}');
    EXPECT_EQ(std::count(line.begin(), line.end(), '{'), std::count(line.begin(), line.end(), '}'));
    EXPECT_EQ(line.find(",,"), std::string::npos);
  }

  std::vector<std::uint8_t> bytes = test::read_bytes(path);
  bytes[bytes.size() * 2 / 3] ^= 1;  // in the middle of a chunk
  const std::string damaged = temporary_path("damaged.mcap"), none = temporary_path("none.jsonl");
  test::write_bytes(damaged, bytes);
  RecordingReader damaged_reader;
  if (damaged_reader.open(damaged).ok()) {
    EXPECT_FALSE(export_recording(damaged_reader, as(ExportFormat::json), none).ok());
  }
  EXPECT_FALSE(std::filesystem::exists(none));
  EXPECT_FALSE(std::filesystem::exists(none + ".part"));
  EXPECT_FALSE(export_recording(reader, {}, path).ok()) << "over the recording itself";
  EXPECT_FALSE(export_recording(reader, {}, temporary_path("no/such.csv")).ok());
}

TEST(Export, OfAFileWhoseWritingFailsOrThrowsNothingIsLeft) {
  const std::string path = temporary_path("half.csv");
  const auto fails = [](TextOutput& file) {
    const Status status = file.line("tick");
    return status.ok() ? Status::error("no more") : status;
  };
  EXPECT_EQ(write_whole<TextOutput>(path, fails).message(), "no more");
  EXPECT_THROW((void)write_whole<TextOutput>(path, [](TextOutput&) -> Status { throw std::bad_alloc(); }),
               std::bad_alloc);
  EXPECT_FALSE(std::filesystem::exists(path) || std::filesystem::exists(path + kPartSuffix));
  EXPECT_TRUE(write_whole<TextOutput>(path, [](TextOutput& file) { return file.line("tick"); }).ok());
  EXPECT_EQ(lines_of(path), std::vector<std::string>{"tick"});
}

}  // namespace
}  // namespace lumbrical
