// Export of recordings as CSV and JSON lines.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

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

TEST(Export, WritesEveryNumberExactlyAsCsv) {
  const std::string path = temporary_path("a.mcap"), output = temporary_path("a.csv");
  std::vector<TickRecord> records = test::random_records(5, 1);
  records[2].device.base.position.y = 0.1;
  test::write_recording(path, test::small_scene(), records);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  ASSERT_TRUE(export_recording(reader, ExportFormat::csv, output).ok());
  const std::vector<std::string> lines = lines_of(output);
  ASSERT_EQ(lines.size(), 6u);
  const std::vector<std::string> header = cells_of(lines[0]);
  const auto column = [&](const char* name) {
    return std::find(header.begin(), header.end(), name) - header.begin();
  };
  for (const std::string& line : lines) EXPECT_EQ(cells_of(line).size(), header.size());
  const auto y = static_cast<std::size_t>(column("device.base.position.y [m]"));
  ASSERT_LT(y, header.size());
  EXPECT_EQ(cells_of(lines[3])[y], "0.1");
  EXPECT_EQ(cells_of(lines[3])[0], "2");
  EXPECT_LT(static_cast<std::size_t>(column("output.segment[15].torque.z [N m]")), header.size());
  EXPECT_EQ(header.back(), "hash.state");
}

TEST(Export, WritesJsonLinesAndLeavesNothingHalfWritten) {
  const std::string path = temporary_path("a.mcap"), output = temporary_path("a.jsonl");
  test::write_recording(path, test::small_scene(), test::random_records(600, 1));
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  ASSERT_TRUE(export_recording(reader, ExportFormat::json, output).ok());
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
    EXPECT_FALSE(export_recording(damaged_reader, ExportFormat::json, none).ok());
  }
  EXPECT_FALSE(std::filesystem::exists(none));
  EXPECT_FALSE(std::filesystem::exists(none + ".part"));
  EXPECT_FALSE(export_recording(reader, ExportFormat::csv, path).ok()) << "over the recording itself";
  EXPECT_FALSE(export_recording(reader, ExportFormat::csv, temporary_path("no/such.csv")).ok());
}

}  // namespace
}  // namespace lumbrical
