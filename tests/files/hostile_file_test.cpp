// Files made to hang their reader, to fill its memory or to lead it elsewhere.
#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>

#include "flatbuffers/flatbuffers.h"
#include "lumbrical/device_profile.h"
#include "lumbrical/mesh.h"
#include "lumbrical/motion.h"
#include "lumbrical/scene_file.h"
#include "lumbrical/world.h"
#include "recording/recording_fixture.h"
#include "recording/state_message.h"
#include "recording_generated.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

std::string own_file(const std::string& name) {
  const fs::path folder = temporary_path("folder");
  fs::create_directories(folder);
  return (folder / name).string();
}

// A pipe nobody writes to, a device without an end, a folder, nothing. (A reader that waits runs into the
// test's time-out.)
TEST(HostileFile, WhatIsNoRegularFileIsRefusedByEveryReader) {
  const std::string pipe = own_file("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& path : {pipe, std::string("/dev/zero"), std::string("/"), own_file("nothing")}) {
    SCOPED_TRACE(path);
    RecordingInfo info;
    std::uint64_t recovered = 0, lost = 0;
    SceneFile scene;
    DeviceProfile profile;
    Mesh mesh;
    Motion motion;
    std::shared_ptr<const World> world;
    EXPECT_FALSE(RecordingReader().open(path).ok());
    EXPECT_FALSE(verify_recording(path, info).ok());
    EXPECT_FALSE(recover_recording(path, own_file("recovered.mcap"), recovered, lost).ok());
    EXPECT_FALSE(load_scene_file(path, scene).ok());
    EXPECT_FALSE(load_device_profile(path, profile).ok());
    EXPECT_FALSE(load_mesh(path, Unit::metre, mesh).ok());
    EXPECT_FALSE(load_motion(path, {}, motion).ok());
    EXPECT_FALSE(open_world(path, world).ok());
  }
  fs::remove_all(fs::path(pipe).parent_path());
}

/// A session whose list of objects names one object again and again: 4 bytes in the file, its mesh in memory.
Status decode_repeated(std::size_t count, std::size_t vertices) {
  std::vector<std::uint8_t> good;
  EXPECT_TRUE(encode_session(small_scene(), good).ok());
  Scene decoded;
  EXPECT_TRUE(decode_session(good, decoded).ok());
  flatbuffers::FlatBufferBuilder builder;
  const auto points = builder.CreateVectorOfStructs(std::vector<fb::Vec3>(vertices));
  const auto object = fb::CreateObject(builder, builder.CreateString(""), points);
  const auto objects = builder.CreateVector(std::vector(count, object));
  // Hand and settings come before the objects when it is decoded; they are those of a good session.
  const fb::Session& from = *flatbuffers::GetRoot<fb::Session>(good.data());
  std::vector<flatbuffers::Offset<fb::Finger>> fingers;
  for (const fb::Finger* const finger : *from.hand()->fingers()) {
    const auto lengths = builder.CreateVector(finger->bone_lengths()->data(), finger->bone_lengths()->size());
    const auto limits = builder.CreateVectorOfStructs(
        reinterpret_cast<const fb::AngleLimit*>(finger->limits()->Data()), finger->limits()->size());
    fingers.push_back(fb::CreateFinger(builder, finger->base(), lengths, limits));
  }
  const auto radii = builder.CreateVector(from.hand()->radii()->data(), from.hand()->radii()->size());
  const auto all_fingers = builder.CreateVector(fingers);
  const auto polygon =
      builder.CreateVectorOfStructs(reinterpret_cast<const fb::Vec3*>(from.hand()->palm_polygon()->Data()),
                                    from.hand()->palm_polygon()->size());
  const auto hand =
      fb::CreateHand(builder, from.hand()->side(), radii, all_fingers, polygon, from.hand()->palm_height(),
                     from.hand()->palm_thickness(), from.hand()->palm_joint());
  const fb::Settings& old = *from.settings();
  const auto laws = builder.CreateVectorScalarCast<fb::Law>(old.laws()->data(), old.laws()->size());
  const auto precisions = builder.CreateVector(old.precisions()->data(), old.precisions()->size());
  const auto settings =
      fb::CreateSettings(builder, laws, old.stiffness(), old.rate(), old.point_area(), old.max_force(),
                         old.fade_time(), old.max_candidates(), precisions, old.effort());
  builder.Finish(fb::CreateSession(builder, from.version(), hand, objects, settings));
  return decode_session({builder.GetBufferPointer(), builder.GetSize()}, decoded);
}

TEST(HostileFile, ASessionOfOneObjectAgainAndAgainIsRefused) {
  EXPECT_EQ(decode_repeated(1'000'000, 0).message(), "the session has more than 32768 objects");
  EXPECT_EQ(decode_repeated(1000, 1000).message(), "the session's objects overlap");
  EXPECT_TRUE(decode_repeated(1, 1000).ok());
}

// Zeros that take no memory.
TEST(HostileFile, AMessageOfTwoGibibytesIsRefused) {
  constexpr std::size_t kSize = std::size_t{1} << 31;
  void* const zeros = ::mmap(nullptr, kSize, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  ASSERT_NE(zeros, MAP_FAILED);
  const std::span bytes(static_cast<const std::uint8_t*>(zeros), kSize);
  Scene scene;
  State state;
  EXPECT_FALSE(decode_session(bytes, scene).ok());
  EXPECT_FALSE(decode_state(bytes, state).ok());
  ::munmap(zeros, kSize);
}

/// A number of /proc/self/status [bytes].
std::uint64_t memory(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kilobytes = 0;
    if (word == name + ":" && status >> kilobytes) return 1024 * kilobytes;
  }
  return 0;
}

/// [bytes] by which this process grows at most meanwhile.
template <class Work>
std::uint64_t memory_taken(Work&& work) {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";  // the peak begins anew
  const std::uint64_t before = memory("VmRSS");
  work();
  return memory("VmHWM") - std::min(memory("VmHWM"), before);
}

double processor_seconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

/// A file of `size` bytes: a good session, then the same chunk over and over.
std::vector<std::uint8_t> file_of_chunks(const mcap::Chunk& chunk, std::size_t size) {
  const std::string path = temporary_path("start.mcap");
  write_recording(path, small_scene(), {});
  InputFile file;
  Summary summary;
  bool present = false;
  EXPECT_TRUE(file.open(path).ok() && read_summary(file, summary, present).ok());
  std::vector<std::uint8_t> bytes = read_bytes(path);
  bytes.resize(summary.attachments.at(0).offset + summary.attachments.at(0).length);
  mcap::ByteWriter out;
  append(out, chunk);
  while (bytes.size() < size) bytes.insert(bytes.end(), out.bytes().begin(), out.bytes().end());
  return bytes;
}

// Zeros and foreign messages, compressed as far as they go: each chunk costs a thousand times its bytes.
TEST(HostileFile, AMegabyteOfBombsIsReadWithinASecondOfProcessorTime) {
  const std::vector<std::uint8_t> zeros(16u << 20, 0);
  std::vector<std::uint8_t> packed(ZSTD_compressBound(zeros.size()));
  packed.resize(ZSTD_compress(packed.data(), packed.size(), zeros.data(), zeros.size(), 1));
  for (const std::uint64_t claimed : {std::uint64_t{16u << 20}, mcap::kLargestRatio * packed.size()}) {
    const mcap::Chunk bomb{0, 0, claimed, 0, "zstd", packed};
    const std::string path = temporary_path("bomb.mcap");
    write_bytes(path, file_of_chunks(bomb, 1'000'000));
    const double before = processor_seconds();
    RecordingReader reader;
    EXPECT_NE(reader.open(path).message().find("byte"), std::string::npos);
    RecordingInfo info;
    EXPECT_FALSE(verify_recording(path, info).ok());
    const double read = processor_seconds();
    std::uint64_t recovered = 0, lost = 0;
    EXPECT_TRUE(recover_recording(path, cleared(temporary_path("recovered.mcap")), recovered, lost).ok());
    EXPECT_LT(read - before, 1) << "read and verified";
    EXPECT_LT(processor_seconds() - read, 1) << "recovered";
  }
}

/// The start of a good file, and all that a writer puts between a summary's beginning and the end.
std::vector<std::uint8_t> file_with_summary(
    const std::function<void(mcap::ByteWriter&, const Summary&)>& put) {
  const std::string path = temporary_path("summary.mcap");
  write_recording(cleared(path), small_scene(), random_records(5, 91));
  InputFile file;
  Summary summary;
  bool present = false;
  EXPECT_TRUE(file.open(path).ok() && read_summary(file, summary, present).ok());
  std::vector<std::uint8_t> bytes = read_bytes(path);
  bytes.resize(summary.start);
  mcap::ByteWriter out;
  put(out, summary);
  append(out, mcap::Footer{summary.start, 0, 0});
  out.raw(mcap::kMagic);
  bytes.insert(bytes.end(), out.bytes().begin(), out.bytes().end());
  return bytes;
}

/// A map of as many short texts as fit.
std::map<std::string, std::string> short_texts(std::size_t count) {
  std::map<std::string, std::string> map;
  for (std::size_t i = 0; i < count; ++i) map[std::to_string(i)];
  return map;
}

Scene scene_of_objects(std::size_t count) {
  Scene scene = small_scene();
  scene.objects.assign(count, {"", scene.objects[0].mesh});
  return scene;
}

Scene scene_of_triangles(std::size_t count) {
  Scene scene = small_scene();
  scene.objects[0].mesh.triangles.assign(count, {0, 1, 2});
  return scene;
}

std::vector<std::uint8_t> recording_of(const Scene& scene) {
  const std::string path = temporary_path("scene.mcap");
  write_recording(cleared(path), scene, {});
  return read_bytes(path);
}

// Whether it is refused or not: whoever looks at a file needs at most four times its size, or 64 MB.
TEST(HostileFile, TakesNoMoreMemoryThanFourTimesItsSizeOr64MB) {
#ifdef LUMBRICAL_SANITIZED
  GTEST_SKIP() << "a sanitizer's memory is its own";
#endif
  const std::vector<std::uint8_t> zeros(16u << 20, 0);
  std::vector<std::uint8_t> packed(ZSTD_compressBound(zeros.size()));
  packed.resize(ZSTD_compress(packed.data(), packed.size(), zeros.data(), zeros.size(), 1));
  struct Made {
    const char* name;
    std::vector<std::uint8_t> bytes;
  };
  std::vector<Made> files;
  files.push_back({"zeros", file_of_chunks({0, 0, zeros.size(), 0, "zstd", packed}, 1'000'000)});
  files.push_back({"an index of chunks", file_with_summary([](mcap::ByteWriter& out, const Summary& good) {
                     for (const mcap::Channel& channel : good.channels) append(out, channel);
                     mcap::ChunkIndex chunk = good.chunks.at(0);
                     chunk.message_index_offsets.clear();
                     for (; out.size() < 20'000'000; chunk.offset += 100) append(out, chunk);
                   })});
  files.push_back(
      {"channels of short texts", file_with_summary([](mcap::ByteWriter& out, const Summary& good) {
         mcap::Channel channel = good.channels.at(0);
         channel.metadata = short_texts(250'000);
         while (out.size() < 20'000'000) append(out, channel), ++channel.id;
       })});
  files.push_back({"metadata of short texts", file_with_summary([](mcap::ByteWriter& out, const Summary&) {
                     while (out.size() < 20'000'000)
                       append(out, mcap::Metadata{"lumbrical", short_texts(250'000)});
                   })});
  files.push_back({"objects", recording_of(scene_of_objects(kMostSceneObjects))});
  files.push_back({"more objects than may be", recording_of(scene_of_objects(100'000))});
  files.push_back({"triangles", recording_of(scene_of_triangles(1'700'000))});
  for (const Made& made : files) {
    SCOPED_TRACE(made.name);
    const std::string path = temporary_path("made.mcap");
    write_bytes(path, made.bytes);
    const double most = std::max(64e6, 4 * static_cast<double>(made.bytes.size()));
    EXPECT_LE(
        static_cast<double>(memory_taken([&] { static_cast<void>(RecordingReader().open(path).ok()); })),
        most)
        << "opened";
    EXPECT_LE(static_cast<double>(memory_taken([&] {
                RecordingInfo info;
                static_cast<void>(verify_recording(path, info).ok());
              })),
              most)
        << "verified";
    EXPECT_LE(static_cast<double>(memory_taken([&] {
                std::uint64_t recovered = 0, lost = 0;
                static_cast<void>(
                    recover_recording(path, cleared(temporary_path("recovered.mcap")), recovered, lost).ok());
              })),
              most)
        << "recovered";
  }
}

// Of a glTF file that names itself in each of its buffers.
TEST(HostileFile, AFileIsHeldOnceHoweverOftenAMeshNamesIt) {
  const std::string path = own_file("a.gltf");
  std::string buffers, views, accessors, primitives;
  for (int i = 0; i < 300; ++i) {
    const std::string comma = i > 0 ? "," : "", number = std::to_string(i);
    buffers += comma + R"({"uri":")" + (i % 2 == 0 ? "" : "./") + R"(a.gltf"})";
    views += comma + R"({"buffer":)" + number + R"(,"byteLength":0})";
    accessors += comma + R"({"bufferView":)" + number + R"(,"componentType":5126,"count":0,"type":"VEC3"})";
    primitives += comma + R"({"attributes":{"POSITION":)" + number + "}}";
  }
  std::ofstream(path) << R"({"asset":{"version":"2.0"},"meshes":[{"primitives":[)" + primitives +
                             R"(]}],"buffers":[)" + buffers + R"(],"bufferViews":[)" + views +
                             R"(],"accessors":[)" + accessors + "]}" + std::string(1'000'000, ' ');
  Status status;
  EXPECT_LE(memory_taken([&] {
              Mesh mesh;
              status = load_mesh(path, Unit::metre, mesh);
            }),
            64'000'000u);
  EXPECT_NE(status.message().find("no triangles"), std::string::npos) << status.message();
  fs::remove_all(fs::path(path).parent_path());
}

// Every packed record names its values by the same text.
TEST(HostileFile, ACaptureThatNamesThousandsOfRecordsByALongTextTakesLittleMemory) {
  std::string text =
      R"({"frames":[["timestamp",{"hands":[[")" + std::string(200'000, 'K') + R"("]]}],[0,[[0])";
  for (int i = 1; i < 2000; ++i) text += ",[0]";
  text += "]]]}";
  Status status;
  EXPECT_LE(memory_taken([&] {
              Motion motion;
              status = parse_motion(text, "a.json", {}, motion);
            }),
            64'000'000u);
  EXPECT_NE(status.message().find("no frame shows a whole hand"), std::string::npos) << status.message();
}

TEST(HostileFile, ADeviceOfThousandsOfSensorsIsRefusedWithinASecondOfProcessorTime) {
  const std::string path = own_file("device.json");
  std::string sensors = R"({"joint":"index distal"})";
  for (int i = 1; i < 40'000; ++i) sensors += R"(,{"joint":"index distal"})";
  std::ofstream(path) << R"({"name":"x","transport":{"kind":"memory"},"actuators":[{"name":"m","upper":1,)"
                      << R"("joints":[{"joint":"index distal"}]}],"sensors":[)" << sensors << "]}";
  const double before = processor_seconds();
  DeviceProfile profile;
  const Status status = load_device_profile(path, profile);
  EXPECT_LT(processor_seconds() - before, 1);
  EXPECT_NE(status.message().find("sensors[1].joint is measured twice"), std::string::npos)
      << status.message();
  fs::remove_all(fs::path(path).parent_path());
}

// Thousands of entries of the index for one large record.
TEST(HostileFile, AnIndexThatNamesARecordTwiceIsRefused) {
  const std::string path = temporary_path("twice.mcap");
  write_bytes(path, file_with_summary([](mcap::ByteWriter& out, const Summary& good) {
                for (const mcap::Channel& channel : good.channels) append(out, channel);
                for (const mcap::ChunkIndex& chunk : good.chunks) append(out, chunk);
                for (int i = 0; i < 1000; ++i) append(out, good.attachments.at(0));
              }));
  const Status status = RecordingReader().open(path);
  EXPECT_NE(status.message().find("twice"), std::string::npos) << status.message();
}

/// A good session whose world's name is this one.
std::vector<std::uint8_t> session_in_world(const std::string& name) {
  Scene scene = small_scene();
  scene.objects.clear();
  auto world = std::make_shared<World>();
  world->path = std::string(name.size(), 'x');
  scene.world = world;
  std::vector<std::uint8_t> session;
  EXPECT_TRUE(encode_session(scene, session).ok());
  const auto at = std::search(session.begin(), session.end(), world->path.begin(), world->path.end());
  std::copy(name.begin(), name.end(), at);
  return session;
}

TEST(HostileFile, ARecordingNamesNoWorldButOneBesideIt) {
  for (const char* const name : {"/etc/passwd", "../up.world", "folder/a.world", "..", ".", "a/.."}) {
    Scene scene;
    EXPECT_NE(decode_session(session_in_world(name), scene).message().find("not a file beside"),
              std::string::npos)
        << name;
  }
  Scene scene;
  EXPECT_TRUE(decode_session(session_in_world("a.world"), scene).ok());
  // What is recorded of a path is its name.
  auto world = std::make_shared<World>();
  world->path = "/some/where/b.world";
  scene.world = world;
  std::vector<std::uint8_t> session;
  ASSERT_TRUE(encode_session(scene, session).ok());
  ASSERT_TRUE(decode_session(session, scene).ok());
  EXPECT_EQ(scene.world->path, "b.world");
}

TEST(HostileFile, NoLinkBesideARecordingLeadsElsewhere) {
  const std::string path = own_file("a.mcap"), beside = own_file("a.world"),
                    elsewhere = temporary_path("elsewhere");
  McapWriter writer;
  ASSERT_TRUE(open_recording(path, 1000, session_in_world("a.world"), {}, {}, {}, writer).ok());
  ASSERT_TRUE(writer.close().ok());
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  write_bytes(elsewhere, {});
  fs::create_symlink(elsewhere, beside);
  EXPECT_NE(reader.find_world("").message().find("no regular file beside it"), std::string::npos);
  fs::remove(beside);
  ASSERT_EQ(::mkfifo(beside.c_str(), 0600), 0);
  EXPECT_NE(reader.find_world("").message().find("no regular file beside it"), std::string::npos);
  fs::remove(beside);
  EXPECT_NE(reader.find_world("").message().find("not beside it"), std::string::npos);
  EXPECT_NE(reader.find_world(elsewhere).message().find(elsewhere), std::string::npos)
      << "what --world says is read";
  fs::remove_all(fs::path(path).parent_path());
}

}  // namespace
}  // namespace lumbrical::test
