// Recordings of worlds in files: the world stays outside, is known by its content, and replays the same.
#include <filesystem>
#include <vector>

#include "lumbrical/recording.h"
#include "lumbrical/tick.h"
#include "pressed_hand.h"
#include "recording/session_message.h"
#include "world_file_fixture.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

Scene field_scene() {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"field", make_height_field(0.4, 60, 0.002, 0.04)});
  return scene;
}

void record(const Scene& scene, const std::string& path, std::uint32_t force_interval = 1) {
  const Model model = built(scene);
  Recorder recorder;
  RecorderOptions options;
  options.force_interval = force_interval;
  fs::remove(path);
  const Status status = recorder.open(path, scene_of(model), options);
  ASSERT_TRUE(status.ok()) << status.message();
  State state;
  Scratch scratch = make_scratch(model);
  for (int i = 0; i < 60; ++i) {
    TickRecord record;
    record.device = pressed_frame(scene.hand, 0.002, i / 60.0);
    record.output = tick(model, state, scratch, record.device);
    take_results(state, scratch, record);
    ASSERT_TRUE(recorder.record(record));
  }
  ASSERT_TRUE(recorder.close().ok());
}

Status replayed(const std::string& path, const std::string& world, ReplayResult& result) {
  RecordingReader reader;
  if (Status status = reader.open(path); !status.ok()) return status;
  ReplayOptions options;
  options.world = world;
  return replay(reader, options, result);
}

void expect_identical(const std::string& path, const std::string& world) {
  ReplayResult result;
  const Status status = replayed(path, world, result);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(result.ticks, 60u);
  EXPECT_FALSE(result.first_divergence);
  EXPECT_EQ(result.broadphase, Broadphase::grid);
}

TEST(WorldRecording, NamesItsWorldAndReplaysFromWhereverThatIs) {
  const fs::path folder = own_folder(), other = folder / "other", third = folder / "third";
  fs::create_directories(other);
  fs::create_directories(third);
  const std::string world = (folder / "field.world").string(), path = (other / "a.mcap").string();
  for (const std::uint32_t force_interval : {1u, 7u}) {
    record(in_world(field_scene(), {}, world), path, force_interval);
    RecordingReader reader;
    ASSERT_TRUE(reader.open(path).ok());
    ASSERT_TRUE(reader.scene().world);
    EXPECT_EQ(reader.scene().world->path, "field.world");
    EXPECT_FALSE(reader.scene().world->bytes);
    RecordingInfo info;
    EXPECT_TRUE(verify_recording(path, info).ok());
    expect_identical(path, world);  // where it was
    fs::rename(world, other / "field.world");
    expect_identical(path, "");  // beside the recording
    fs::rename(other / "field.world", third / "renamed.world");
    expect_identical(path, (third / "renamed.world").string());
  }
  EXPECT_LT(fs::file_size(path), 80'000u);  // the meshes take more than twice that
}

TEST(WorldRecording, IsNotReplayedWithoutItsWorld) {
  const fs::path folder = own_folder();
  const std::string world = (folder / "field.world").string(), path = (folder / "a.mcap").string();
  const std::string another = (folder / "another.world").string();
  record(in_world(field_scene(), {}, world), path);
  Scene changed = field_scene();
  changed.objects[0].mesh.vertices[3].z += 1e-9;
  ASSERT_TRUE(write_world(changed, {}, another).ok());
  ReplayResult result;
  EXPECT_NE(replayed(path, another, result).message().find("another world"), std::string::npos);
  fs::remove(world);
  const Status missing = replayed(path, "", result);
  EXPECT_NE(missing.message().find(path), std::string::npos);
  EXPECT_NE(missing.message().find("--world FILE"), std::string::npos);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  Model model;
  EXPECT_NE(build_model(reader.scene(), {}, model).message().find("only named"), std::string::npos);
  CopyResult copied;
  const std::string part = (folder / "part.mcap").string();
  EXPECT_TRUE(copy_recordings({path}, part, {20, 40, {}}, copied).ok());
  EXPECT_EQ(copied.ticks, 20u);
  EXPECT_FALSE(copied.replayable) << "nobody knows the state before it";
  fs::remove(part);
  EXPECT_NE(copy_recordings({path}, part, {20, 40, {}, another}, copied).message().find("another world"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(part));
}

TEST(WorldRecording, IsCutAndAskedWhatIf) {
  const fs::path folder = own_folder();
  const std::string world = (folder / "field.world").string(), path = (folder / "a.mcap").string();
  record(in_world(field_scene(), {}, world), path);
  const std::string part = (folder / "part.mcap").string();
  CopyResult copied;
  const Status status = copy_recordings({path}, part, {20, 40, {}}, copied);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_TRUE(copied.replayable);
  ReplayResult result;
  ASSERT_TRUE(replayed(part, "", result).ok());
  EXPECT_EQ(result.ticks, 20u);
  EXPECT_FALSE(result.first_divergence);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  ReplayOptions options;
  options.stiffness = 1e7;
  WhatIfResult changes;
  ASSERT_TRUE(what_if(reader, options, changes).ok());
  EXPECT_EQ(changes.ticks, 60u);
  options.mesh["field"] = make_plane(0.4, 3, 0);
  EXPECT_NE(what_if(reader, options, changes).message().find("no object can be replaced"), std::string::npos);
}

TEST(WorldRecording, SessionsAreEitherWithMeshesOrWithAWorld) {
  Scene scene = in_world(field_scene(), {}, (own_folder() / "field.world").string());
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(encode_session(scene, bytes).ok());
  Scene decoded;
  ASSERT_TRUE(decode_session(bytes, decoded).ok());
  EXPECT_EQ(decoded.world->content, scene.world->content);
  EXPECT_EQ(decoded.world->byte_count, scene.world->byte_count);
  scene.objects = field_scene().objects;
  ASSERT_TRUE(encode_session(scene, bytes).ok());
  EXPECT_FALSE(decode_session(bytes, decoded).ok());
}

}  // namespace
}  // namespace lumbrical::test
