// The MCAP container: records there and back, files against the specification, and hostile sizes.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "recording/mcap_format.h"
#include "recording/mcap_reader.h"
#include "recording/mcap_writer.h"
#include "recording_fixture.h"

namespace lumbrical {
namespace {

using namespace mcap;
using test::read_bytes;
using test::temporary_path;
using test::write_bytes;

template <class Record>
Bytes content_of(const ByteWriter& out, Opcode opcode) {
  EXPECT_EQ(out.bytes()[0], static_cast<std::uint8_t>(opcode));
  ByteReader in(out.bytes().subspan(1));
  EXPECT_EQ(in.u64(), out.size() - kRecordHeaderSize);
  return out.bytes().subspan(kRecordHeaderSize);
}

// Every proper prefix of a record must be refused, except where the end of a record is its payload's end.
template <class Record>
Record there_and_back(const Record& record, Opcode opcode, bool open_ended = false) {
  ByteWriter out;
  append(out, record);
  const Bytes content = content_of<Record>(out, opcode);
  Record result;
  EXPECT_TRUE(parse(content, result));
  for (std::size_t size = 0; size < content.size() && !open_ended; ++size) {
    Record cut;
    EXPECT_FALSE(parse(content.first(size), cut)) << size;
  }
  return result;
}

TEST(McapFormat, ComputesTheChecksumOfZlib) {
  const std::string digits = "123456789";
  const Bytes bytes(reinterpret_cast<const std::uint8_t*>(digits.data()), digits.size());
  EXPECT_EQ(crc32(0, bytes), 0xcbf43926u);
  EXPECT_EQ(crc32(crc32(0, bytes.first(4)), bytes.subspan(4)), 0xcbf43926u);
  EXPECT_EQ(crc32(7, {}), 7u);
}

TEST(McapFormat, WritesRecordsAsTheSpecificationSays) {
  ByteWriter out;
  append(out, Header{"", "ab"});
  const std::vector<std::uint8_t> expected = {1, 10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 'a', 'b'};
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), out.bytes().begin(), out.bytes().end()));
}

TEST(McapFormat, BringsEveryRecordBackAndRefusesItCut) {
  const std::vector<std::uint8_t> payload = {9, 8, 7};
  EXPECT_EQ(there_and_back(Header{"p", "library"}, Opcode::header).library, "library");
  EXPECT_EQ(there_and_back(Footer{1, 2, 3}, Opcode::footer).summary_crc, 3u);
  EXPECT_EQ(there_and_back(Schema{1, "n", "e", payload}, Opcode::schema).data.size(), 3u);
  EXPECT_EQ(there_and_back(Channel{1, 2, "t", "e", {{"a", "b"}}}, Opcode::channel).metadata.at("a"), "b");
  EXPECT_EQ(there_and_back(Message{1, 2, 3, 4, payload}, Opcode::message, true).data.size(), 3u);
  EXPECT_EQ(there_and_back(Chunk{1, 2, 3, 4, "lz4", payload}, Opcode::chunk).compression, "lz4");
  EXPECT_EQ(there_and_back(MessageIndex{1, {{2, 3}, {4, 5}}}, Opcode::message_index).entries.size(), 2u);
  const ChunkIndex chunk{1, 2, 3, 4, {{5, 6}}, 7, "zstd", 8, 9};
  EXPECT_EQ(there_and_back(chunk, Opcode::chunk_index), chunk);
  const AttachmentIndex attachment{1, 2, 3, 4, 5, "name", "type"};
  EXPECT_EQ(there_and_back(attachment, Opcode::attachment_index), attachment);
  const Statistics statistics{1, 2, 3, 4, 5, 6, 7, 8, {{9, 10}}};
  EXPECT_EQ(there_and_back(statistics, Opcode::statistics), statistics);
  EXPECT_EQ(there_and_back(Metadata{"n", {{"k", "v"}}}, Opcode::metadata).metadata.at("k"), "v");
  const MetadataIndex metadata{1, 2, "n"};
  EXPECT_EQ(there_and_back(metadata, Opcode::metadata_index), metadata);
  const SummaryOffset offset{Opcode::chunk, 1, 2};
  EXPECT_EQ(there_and_back(offset, Opcode::summary_offset), offset);
}

TEST(McapFormat, IgnoresFieldsOfLaterVersions) {
  ByteWriter out;
  append(out, Footer{1, 2, 3});
  std::vector<std::uint8_t> content(out.bytes().begin() + 9, out.bytes().end());
  content.push_back(77);
  Footer footer;
  EXPECT_TRUE(parse(content, footer));
}

/// With so many channels of messages that nobody reads, the last of which ends a time.
Status open_channels(const std::string& path, std::size_t channels, McapWriter& writer,
                     Compression compression = Compression::lz4) {
  McapWriterOptions options;
  options.compression = compression;
  options.last_channel = channels - 1;
  McapWriter::Start start;
  const std::map<std::string, std::string> metadata;
  start.metadata = &metadata;
  start.channels.assign(channels, {"still", {}, "tick", {}});
  return writer.open(test::cleared(path), options, start);
}

Status load_chunks(const std::string& path, std::vector<LoadedChunk>& chunks) {
  InputFile file;
  Summary summary;
  bool whole = false;
  if (Status status = file.open(path); !status.ok()) return status;
  if (Status status = read_summary(file, summary, whole); !status.ok()) return status;
  std::vector<std::uint8_t> content;
  for (const ChunkIndex& index : summary.chunks) {
    RecordPlace place;
    if (Status status = find_record(file, index.offset, file.size(), place, whole); !status.ok())
      return status;
    if (Status status = load_chunk(file, place, content, chunks.emplace_back()); !status.ok()) return status;
  }
  return {};
}

/// What its reader finds in the chunks of a file that is closed with this.
std::vector<LoadedChunk> chunks_of(const std::string& path, McapWriter& writer) {
  std::vector<LoadedChunk> chunks;
  Status status = writer.close();
  if (status.ok()) status = load_chunks(path, chunks);
  EXPECT_TRUE(status.ok()) << status.message();
  return chunks;
}

class McapFile : public ::testing::TestWithParam<Compression> {};

// 700 ticks at 1 kHz, read back record by record.
TEST_P(McapFile, KeepsToTheSpecification) {
  const std::string path = temporary_path("a.mcap");
  RecorderOptions options;
  options.compression = GetParam();
  options.metadata = {{"operator", "test"}};
  test::write_recording(path, test::small_scene(), test::random_records(700, 1), options);

  InputFile file;
  ASSERT_TRUE(file.open(path).ok());
  Header header;
  std::uint64_t offset = 0;
  ASSERT_TRUE(read_start(file, header, offset).ok());
  EXPECT_EQ(header.profile, "");
  EXPECT_FALSE(header.library.empty());

  std::vector<Opcode> order;
  std::vector<std::uint8_t> content;
  std::uint64_t messages = 0;
  RecordPlace place;
  for (bool whole = true; place.opcode != Opcode::data_end; offset = place.end()) {
    ASSERT_TRUE(find_record(file, offset, file.size(), place, whole).ok());
    ASSERT_TRUE(whole);
    order.push_back(place.opcode);
    if (place.opcode != Opcode::chunk) continue;
    LoadedChunk chunk;
    ASSERT_TRUE(load_chunk(file, place, content, chunk).ok());
    EXPECT_LT(chunk.header.end_time - chunk.header.start_time, 200'000'000u);
    std::size_t at = 0;
    for (InnerRecord inner; at < chunk.records.size(); at = inner.end) {
      ASSERT_TRUE(find_inner_record(chunk.records, at, inner));
      ASSERT_EQ(inner.opcode, Opcode::message);
      Message message;
      ASSERT_TRUE(parse(inner.content, message));
      EXPECT_EQ(message.log_time, messages * 1'000'000);
      EXPECT_EQ(message.sequence, messages++);
    }
  }
  EXPECT_EQ(messages, 700u);
  const std::vector<Opcode> start = {Opcode::schema,     Opcode::channel, Opcode::metadata,
                                     Opcode::attachment, Opcode::chunk,   Opcode::message_index};
  ASSERT_GE(order.size(), start.size());
  EXPECT_TRUE(std::equal(start.begin(), start.end(), order.begin()));

  Summary summary;
  bool present = false;
  ASSERT_TRUE(read_summary(file, summary, present).ok());
  ASSERT_TRUE(present);
  EXPECT_EQ(summary.start, offset);
  ASSERT_TRUE(summary.statistics.has_value());
  EXPECT_EQ(summary.statistics->message_count, 700u);
  EXPECT_EQ(summary.statistics->start_time, 0u);
  EXPECT_EQ(summary.statistics->end_time, 699'000'000u);
  EXPECT_EQ(summary.statistics->chunk_count, summary.chunks.size());
  EXPECT_EQ(summary.chunks.size(), 4u);  // 200 + 200 + 200 + 100 ticks
  std::set<Opcode> groups;
  for (const SummaryOffset& group : summary.summary_offsets)
    EXPECT_TRUE(groups.insert(group.group).second) << "a group is told twice";
  EXPECT_EQ(groups.size(), 6u);
}

// What nobody moves is the same over and over: the more of it, the further it can be compressed.
TEST_P(McapFile, WritesNothingThatItsReaderTakesForABomb) {
  const std::string path = temporary_path("still.mcap");
  McapWriter writer;
  ASSERT_TRUE(open_channels(path, 1, writer, GetParam()).ok());
  const std::vector<std::uint8_t> still(10'000, 0);
  for (std::uint32_t i = 0; i < 100; ++i) ASSERT_TRUE(writer.message(0, 0, still).ok());
  const std::vector<LoadedChunk> chunks = chunks_of(path, writer);
  ASSERT_EQ(chunks.size(), 1u);
  EXPECT_GT(chunks[0].records.size(), 100 * still.size());
}

INSTANTIATE_TEST_SUITE_P(Compressions, McapFile,
                         ::testing::Values(Compression::none, Compression::lz4, Compression::zstd),
                         testing::PrintToStringParamName());

TEST(McapWriter, EndsAChunkThatIsFullThoughItsLastChannelIsSilent) {
  const std::string path = temporary_path("one.mcap");
  McapWriter writer;
  ASSERT_TRUE(open_channels(path, 2, writer).ok());
  const std::vector<std::uint8_t> large(300'000, 7);
  for (std::uint32_t i = 0; i < 100; ++i) ASSERT_TRUE(writer.message(1'000'000 * i, i, large).ok());
  for (const LoadedChunk& chunk : chunks_of(path, writer)) EXPECT_LT(chunk.records.size(), 5 * large.size());
}

TEST(McapWriter, MessagesOfOneTimeShareAChunkAsLongAsItCanBeRead) {
  const std::string path = temporary_path("large.mcap");
  McapWriter writer;
  ASSERT_TRUE(open_channels(path, 3, writer).ok());
  const std::vector<std::uint8_t> large(7u << 20, 7);
  for (const std::size_t channel : {0, 1, 2}) ASSERT_TRUE(writer.message(5, 5, large, channel).ok());
  const std::vector<LoadedChunk> chunks = chunks_of(path, writer);
  ASSERT_EQ(chunks.size(), 2u);
  EXPECT_GT(chunks[0].records.size(), 2 * large.size());
}

TEST(McapWriter, RefusesAMessageThatCouldNotBeReadAndKeepsThoseBeforeIt) {
  const std::string path = temporary_path("large.mcap");
  McapWriter writer;
  ASSERT_TRUE(open_channels(path, 2, writer).ok());
  const auto write = [&](std::uint32_t tick, std::size_t size) {
    return writer.message(tick, tick, std::vector<std::uint8_t>(size));
  };
  ASSERT_TRUE(write(5, 100).ok());
  ASSERT_TRUE(write(6, kLargestMessage).ok());
  ASSERT_TRUE(write(7, 100).ok());
  const Status refused = write(7, kLargestMessage + 1);
  EXPECT_NE(refused.message().find("larger than the 16 MiB"), std::string::npos) << refused.message();
  EXPECT_EQ(writer.written_messages(), 3u);
  EXPECT_EQ(chunks_of(path, writer).size(), 3u);
}

// A file with one chunk record of our making behind a header.
std::string file_with_chunk(const Chunk& chunk) {
  ByteWriter out;
  out.raw(kMagic);
  append(out, Header{"", "test"});
  append(out, chunk);
  const std::string path = temporary_path("chunk.mcap");
  write_bytes(path, out.bytes());
  return path;
}

Status load_only_chunk(const std::string& path, LoadedChunk& chunk) {
  InputFile file;
  if (Status status = file.open(path); !status.ok()) return status;
  Header header;
  std::uint64_t offset = 0;
  if (Status status = read_start(file, header, offset); !status.ok()) return status;
  RecordPlace place;
  bool whole = false;
  if (Status status = find_record(file, offset, file.size(), place, whole); !status.ok()) return status;
  std::vector<std::uint8_t> content;
  return load_chunk(file, place, content, chunk);
}

TEST(McapReader, RefusesAChunkThatDeclaresMoreThanItHolds) {
  const std::vector<std::uint8_t> records(100, 1);
  LoadedChunk chunk;
  for (const char* const compression : {"", "lz4", "zstd"}) {
    const Status huge = load_only_chunk(file_with_chunk({0, 0, 1ull << 40, 0, compression, records}), chunk);
    EXPECT_NE(huge.message().find("at most 16 MiB"), std::string::npos) << huge.message();
    EXPECT_LT(chunk.records.capacity(), 1u << 20);
    const Status wrong = load_only_chunk(file_with_chunk({0, 0, 101, 0, compression, records}), chunk);
    EXPECT_NE(wrong.message().find("cannot be decompressed"), std::string::npos) << wrong.message();
  }
}

TEST(McapReader, RefusesAnUnknownCompressionAndAWrongChecksum) {
  const std::vector<std::uint8_t> records(100, 1);
  LoadedChunk chunk;
  const Status unknown = load_only_chunk(file_with_chunk({0, 0, 100, 0, "brotli", records}), chunk);
  EXPECT_NE(unknown.message().find("compression is unknown"), std::string::npos) << unknown.message();
  const Status wrong = load_only_chunk(file_with_chunk({0, 0, 100, 1, "", records}), chunk);
  EXPECT_NE(wrong.message().find("checksum is wrong"), std::string::npos) << wrong.message();
  EXPECT_TRUE(load_only_chunk(file_with_chunk({0, 0, 100, 0, "", records}), chunk).ok());
}

TEST(McapReader, NamesTheFileThatItCouldNotOpen) {
  const std::string path = temporary_path("a.mcap"), part = path + kPartSuffix;
  InputFile file;
  EXPECT_EQ(file.open(path).message().find(path + ": there is no such file"), 0u);
  std::filesystem::create_symlink(part, part);
  EXPECT_EQ(file.open(path).message().find(part + ": can't be read"), 0u);
}

TEST(McapReader, NamesTheByteOfARecordThatIsNotWhole) {
  const std::string path = temporary_path("no.mcap");
  for (const std::string& text : {std::string(), std::string("MCAP"), std::string(20, 'x')}) {
    write_bytes(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    InputFile file;
    ASSERT_TRUE(file.open(path).ok());
    Header header;
    std::uint64_t offset = 0;
    const Status status = read_start(file, header, offset);
    EXPECT_EQ(status.message().find(path + ": byte 0: "), 0u) << status.message();
  }
}

}  // namespace
}  // namespace lumbrical
