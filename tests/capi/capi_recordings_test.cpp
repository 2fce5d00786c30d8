// Recordings by lumbrical.h: written by a session, replayed, read tick by tick.
#include <gtest/gtest.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "capi_fixture.h"
#include "file_size_limit.h"
#include "files/world_file_fixture.h"
#include "lumbrical/recording.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

struct CloseReader {
  void operator()(lumbrical_reader* reader) const { lumbrical_reader_close(reader); }
};
using Reader = std::unique_ptr<lumbrical_reader, CloseReader>;

Reader opened(const std::string& path, std::int32_t side = LUMBRICAL_FIRST_HAND) {
  lumbrical_reader* reader = nullptr;
  EXPECT_EQ(lumbrical_reader_open(path.c_str(), side, &reader), LUMBRICAL_OK) << lumbrical_message();
  return Reader(reader);
}

TEST(CApiRecordings, ReplayIdenticalAndCanBeReadAgain) {
  const std::string path = (own_folder() / "touch.mcap").string();
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  std::vector<lumbrical_output> felt;
  ASSERT_EQ(lumbrical_session_record(c.session, path.c_str(), nullptr), LUMBRICAL_OK) << lumbrical_message();
  EXPECT_EQ(lumbrical_session_record(c.session, path.c_str(), nullptr), LUMBRICAL_BAD_ARGUMENT);
  for (std::size_t i = 0; i < 80; ++i) felt.push_back(c.step(i));
  std::uint64_t kept = 0;
  ASSERT_EQ(lumbrical_session_stop_recording(c.session, &kept), LUMBRICAL_OK) << lumbrical_message();
  EXPECT_EQ(kept, 80u);
  EXPECT_EQ(lumbrical_session_stop_recording(c.session, &kept), LUMBRICAL_BAD_ARGUMENT);
  EXPECT_EQ(lumbrical_session_record(c.session, path.c_str(), nullptr), LUMBRICAL_BAD_ARGUMENT)
      << "amid a session";

  auto result = sized<lumbrical_replay_result>();
  ASSERT_EQ(lumbrical_replay(path.c_str(), nullptr, nullptr, &result), LUMBRICAL_OK) << lumbrical_message();
  EXPECT_EQ(result.identical, 1);
  EXPECT_EQ(result.ticks, 80u);
  EXPECT_STREQ(result.damage, "");
  const std::string torn = (own_folder() / "torn.mcap").string();
  std::filesystem::copy_file(path, torn);
  std::filesystem::resize_file(torn, std::filesystem::file_size(torn) - 200);
  ASSERT_EQ(lumbrical_replay(torn.c_str(), nullptr, nullptr, &result), LUMBRICAL_OK) << lumbrical_message();
  EXPECT_STRNE(result.damage, "") << "identical as far as it can be read, and no whole file";

  lumbrical_reader* reader = nullptr;
  ASSERT_EQ(lumbrical_reader_open(path.c_str(), LUMBRICAL_FIRST_HAND, &reader), LUMBRICAL_OK);
  auto info = sized<lumbrical_recording_info>();
  ASSERT_EQ(lumbrical_reader_describe(reader, &info), LUMBRICAL_OK);
  EXPECT_EQ(info.ticks, 80u);
  EXPECT_EQ(info.complete, 1);
  EXPECT_EQ(info.side, LUMBRICAL_RIGHT);
  CSession again;
  ASSERT_EQ(lumbrical_reader_model(reader, nullptr, nullptr, &again.model), LUMBRICAL_OK)
      << lumbrical_message();
  ASSERT_EQ(lumbrical_session_create(again.model, &again.session), LUMBRICAL_OK);
  lumbrical_frame frame = new_frame();
  auto recorded = sized<lumbrical_output>();
  std::int32_t end = 0;
  for (std::size_t i = 0; i < 80; ++i) {
    ASSERT_EQ(lumbrical_reader_next(reader, &frame, &recorded, &end), LUMBRICAL_OK);
    ASSERT_EQ(end, 0);
    EXPECT_EQ(std::memcmp(&recorded, &felt[i], sizeof recorded), 0) << i;
    EXPECT_EQ(std::memcmp(&again.step(frame), &felt[i], sizeof recorded), 0) << i;
  }
  ASSERT_EQ(lumbrical_reader_next(reader, &frame, &recorded, &end), LUMBRICAL_OK);
  EXPECT_EQ(end, 1);
  ASSERT_EQ(lumbrical_reader_seek(reader, 33), LUMBRICAL_OK);
  ASSERT_EQ(lumbrical_reader_next(reader, nullptr, &recorded, nullptr), LUMBRICAL_OK);
  EXPECT_EQ(recorded.tick, 33u);
  lumbrical_reader_close(reader);
}

TEST(CApiRecordings, ASessionThatGoesOnFromAPartIsNotRecorded) {
  const std::string whole = (own_folder() / "whole.mcap").string(),
                    part = (own_folder() / "part.mcap").string();
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  ASSERT_EQ(lumbrical_session_record(c.session, whole.c_str(), nullptr), LUMBRICAL_OK) << lumbrical_message();
  for (std::size_t i = 0; i < 40; ++i) c.step(i);
  ASSERT_EQ(lumbrical_session_stop_recording(c.session, nullptr), LUMBRICAL_OK) << lumbrical_message();
  CopyOptions options;
  options.from = 20;
  CopyResult result;
  ASSERT_TRUE(copy_recordings({whole}, part, options, result).ok());
  CSession on;
  ASSERT_EQ(lumbrical_reader_model(opened(part).get(), nullptr, nullptr, &on.model), LUMBRICAL_OK);
  ASSERT_EQ(lumbrical_session_create(on.model, &on.session), LUMBRICAL_OK);
  EXPECT_EQ(lumbrical_session_record(on.session, (part + ".again").c_str(), nullptr), LUMBRICAL_BAD_ARGUMENT);
  EXPECT_NE(std::string(lumbrical_message()).find("a part of a recording"), std::string::npos)
      << lumbrical_message();
}

// What is wrong stands at the text's end, behind the path.
TEST(CApiRecordings, DamageIsToldHoweverLongThePathIs) {
  const fs::path folder = own_folder() / std::string(150, 'a') / std::string(150, 'b');
  fs::create_directories(folder);
  const std::string path = (folder / "touch.mcap").string();
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  ASSERT_EQ(lumbrical_session_record(c.session, path.c_str(), nullptr), LUMBRICAL_OK) << lumbrical_message();
  for (std::size_t i = 0; i < 40; ++i) c.step(i);
  ASSERT_EQ(lumbrical_session_stop_recording(c.session, nullptr), LUMBRICAL_OK) << lumbrical_message();
  fs::resize_file(path, fs::file_size(path) - 200);
  auto result = sized<lumbrical_replay_result>();
  ASSERT_EQ(lumbrical_replay(path.c_str(), nullptr, nullptr, &result), LUMBRICAL_OK) << lumbrical_message();
  RecordingInfo info;
  const std::string damage = verify_recording(path, info).message();
  ASSERT_GT(damage.size(), sizeof result.damage);
  EXPECT_EQ(std::string(result.damage).size(), sizeof result.damage - 1);
  EXPECT_TRUE(damage.ends_with(std::string(result.damage).substr(sizeof result.damage / 2 + 5)))
      << result.damage;
}

/// A hand of each side over the ball, for a few ticks.
void record_two_hands(const std::string& path) {
  const Scene scene = ball_scene();
  const Hand second = default_hand(Side::left);
  RecorderOptions options;
  options.second_hand = second;
  Recorder recorder;
  ASSERT_TRUE(recorder.open(path, scene, options).ok());
  Model models[2];
  ASSERT_TRUE(build_model(scene, {}, models[0]).ok());
  ASSERT_TRUE(share_world(models[0], second, models[1]).ok());
  State states[] = {make_state(models[0]), make_state(models[1])};
  Scratch scratches[] = {make_scratch(models[0]), make_scratch(models[1])};
  for (std::size_t i = 0; i < 5; ++i) {
    for (const std::size_t hand : {0, 1}) {
      TickRecord record;
      record.hand = static_cast<std::uint8_t>(hand);
      record.device = touching_frame(40 + 10 * i + hand);
      record.output = tick(models[hand], states[hand], scratches[hand], record.device);
      take_results(states[hand], scratches[hand], record);
      ASSERT_TRUE(recorder.record(record));
    }
  }
  ASSERT_TRUE(recorder.close().ok());
}

TEST(CApiRecordings, OfTwoHandsEachIsRead) {
  const std::string path = (own_folder() / "two.mcap").string();
  record_two_hands(path);
  for (const int side : {LUMBRICAL_LEFT, LUMBRICAL_RIGHT}) {
    const Reader reader = opened(path, side);
    auto info = sized<lumbrical_recording_info>();
    ASSERT_EQ(lumbrical_reader_describe(reader.get(), &info), LUMBRICAL_OK);
    EXPECT_EQ(info.side, side);
    EXPECT_EQ(info.hands, 2);
    lumbrical_frame frame = new_frame();
    ASSERT_EQ(lumbrical_reader_next(reader.get(), &frame, nullptr, nullptr), LUMBRICAL_OK);
    EXPECT_EQ(frame.base.position[2], touching_frame(side == LUMBRICAL_LEFT ? 41 : 40).base.position.z);
  }
  lumbrical_reader* none = nullptr;
  EXPECT_EQ(lumbrical_reader_open(path.c_str(), 2, &none), LUMBRICAL_BAD_ARGUMENT);
  EXPECT_EQ(none, nullptr);
}

TEST(CApiRecordings, TellWhereObjectsWere) {
  const std::string path = (own_folder() / "given.mcap").string();
  MeshObject floor(make_plane(0.3, 2)), ball(make_sphere(0.04, 4));
  ball.object.mobility = LUMBRICAL_GIVEN;
  CSession c;
  c.create();
  ASSERT_EQ(lumbrical_scene_add_object(c.scene, &floor.object), LUMBRICAL_OK);
  ASSERT_EQ(lumbrical_scene_add_object(c.scene, &ball.object), LUMBRICAL_OK);
  c.start();
  ASSERT_EQ(lumbrical_session_record(c.session, path.c_str(), nullptr), LUMBRICAL_OK);
  std::vector<lumbrical_object_output> told;
  for (std::size_t i = 0; i < 20; ++i) {
    const lumbrical_pose pose = {{0, 0, 0.001 * static_cast<double>(i)}, {0, 0, 0, 1}};
    const lumbrical_frame frame = touching_frame_c(60);
    ASSERT_EQ(lumbrical_session_tick(c.session, &frame, &pose, 1, &c.output), LUMBRICAL_OK);
    auto object = sized<lumbrical_object_output>();
    std::size_t count = 0;
    ASSERT_EQ(lumbrical_session_objects(c.session, &object, 1, &count), LUMBRICAL_OK);
    told.push_back(object);
  }
  ASSERT_EQ(lumbrical_session_stop_recording(c.session, nullptr), LUMBRICAL_OK);
  const Reader reader = opened(path);
  std::size_t count = 9;
  for (const lumbrical_object_output& expected : told) {
    auto object = sized<lumbrical_object_output>();
    ASSERT_EQ(lumbrical_reader_next(reader.get(), nullptr, nullptr, nullptr), LUMBRICAL_OK);
    EXPECT_EQ(lumbrical_reader_objects(reader.get(), nullptr, 0, &count), LUMBRICAL_TOO_SMALL);
    ASSERT_EQ(lumbrical_reader_objects(reader.get(), &object, 1, &count), LUMBRICAL_OK)
        << lumbrical_message();
    EXPECT_EQ(object.object, 1u);
    EXPECT_EQ(std::memcmp(&object, &expected, sizeof object), 0);
  }
}

/// A ball that goes its way into the hand, but for every third tick in which nobody says where it is.
std::vector<lumbrical_output> record_a_given_ball(const std::string& path) {
  MeshObject ball(make_sphere(0.04, 4));
  ball.object.mobility = LUMBRICAL_GIVEN;
  ball.object.static_friction = 0.5;
  CSession c(ball.object);
  EXPECT_EQ(lumbrical_session_record(c.session, path.c_str(), nullptr), LUMBRICAL_OK) << lumbrical_message();
  std::vector<lumbrical_output> felt;
  const lumbrical_frame frame = touching_frame_c(60);
  for (std::size_t i = 0; i < 20; ++i) {
    const lumbrical_pose pose = {{0, 0, 0.0005 * static_cast<double>(i)}, {0, 0, 0, 1}};
    EXPECT_EQ(lumbrical_session_tick(c.session, &frame, &pose, i % 3 == 2 ? 0 : 1, &c.output), LUMBRICAL_OK);
    felt.push_back(c.output);
  }
  EXPECT_EQ(lumbrical_session_stop_recording(c.session, nullptr), LUMBRICAL_OK) << lumbrical_message();
  return felt;
}

TEST(CApiRecordings, OfGivenObjectsCanBeFeltAgain) {
  const std::string path = (own_folder() / "given.mcap").string();
  const std::vector<lumbrical_output> felt = record_a_given_ball(path);
  EXPECT_GT(felt.back().hand_force[2], 0);
  const Reader reader = opened(path);
  CSession again;
  ASSERT_EQ(lumbrical_reader_model(reader.get(), nullptr, nullptr, &again.model), LUMBRICAL_OK);
  ASSERT_EQ(lumbrical_session_create(again.model, &again.session), LUMBRICAL_OK);
  lumbrical_pose given;
  std::size_t count = 9;
  EXPECT_EQ(lumbrical_reader_given(reader.get(), &given, 1, &count), LUMBRICAL_BAD_ARGUMENT);
  EXPECT_EQ(count, 9u) << "no tick was read";
  for (std::size_t i = 0; i < felt.size(); ++i) {
    lumbrical_frame frame = new_frame();
    ASSERT_EQ(lumbrical_reader_next(reader.get(), &frame, nullptr, nullptr), LUMBRICAL_OK);
    ASSERT_EQ(lumbrical_reader_given(reader.get(), &given, 1, &count), LUMBRICAL_OK) << lumbrical_message();
    EXPECT_EQ(count, i % 3 == 2 ? 0u : 1u);
    ASSERT_EQ(lumbrical_session_tick(again.session, &frame, &given, count, &again.output), LUMBRICAL_OK);
    EXPECT_EQ(std::memcmp(&again.output, &felt[i], sizeof again.output), 0) << i;
  }
  EXPECT_EQ(lumbrical_reader_given(reader.get(), nullptr, 1, &count), LUMBRICAL_BAD_ARGUMENT);
}

// Of what comes next nothing is told, nor of what could not be read.
TEST(CApiRecordings, ObjectsAreThoseOfTheTickThatWasHandedOut) {
  const std::string path = (own_folder() / "given.mcap").string();
  record_a_given_ball(path);
  const Reader reader = opened(path);
  auto object = sized<lumbrical_object_output>();
  std::size_t count = 9;
  const auto height = [&] {
    EXPECT_EQ(lumbrical_reader_objects(reader.get(), &object, 1, &count), LUMBRICAL_OK)
        << lumbrical_message();
    return object.pose.position[2];
  };
  EXPECT_EQ(lumbrical_reader_objects(reader.get(), &object, 1, &count), LUMBRICAL_BAD_ARGUMENT);
  EXPECT_NE(std::string(lumbrical_message()).find("no tick has been read yet"), std::string::npos);
  ASSERT_EQ(lumbrical_reader_seek(reader.get(), 3), LUMBRICAL_OK);
  ASSERT_EQ(lumbrical_reader_next(reader.get(), nullptr, nullptr, nullptr), LUMBRICAL_OK);
  EXPECT_EQ(height(), 0.0015);
  for (const std::uint64_t elsewhere : {10, 1000}) {
    ASSERT_EQ(lumbrical_reader_seek(reader.get(), elsewhere), LUMBRICAL_OK);
    EXPECT_EQ(height(), 0.0015);
  }
  std::int32_t end = 0;
  ASSERT_EQ(lumbrical_reader_next(reader.get(), nullptr, nullptr, &end), LUMBRICAL_OK);
  EXPECT_EQ(end, 1);
  EXPECT_EQ(height(), 0.0015);
}

// Where programs start with the signals that a shell gives them: SIGXFSZ ends them.
TEST(CApiRecordings, AFileThatMayNotGrowIsAnErrorAndNoSignal) {
  const std::string path = (own_folder() / "touch.mcap").string();
  const auto recorded = [&](std::size_t ticks) {
    auto c = std::make_unique<CSession>(MeshObject(ball_scene().objects[0].mesh).object);
    EXPECT_EQ(lumbrical_session_record(c->session, path.c_str(), nullptr), LUMBRICAL_OK);
    for (std::size_t i = 0; i < ticks; ++i) c->step(i);
    return c;
  };
  {
    const auto c = recorded(0);
    int status = LUMBRICAL_OK;
    std::uint64_t kept = 0;
    const FileSizeLimit limit(50'000);
    std::signal(SIGXFSZ, SIG_DFL);
    const lumbrical_frame frame = touching_frame_c(60);
    for (std::size_t i = 0; i < 100'000 && status == LUMBRICAL_OK; ++i)
      status = lumbrical_session_tick(c->session, &frame, nullptr, 0, &c->output);
    EXPECT_EQ(status, LUMBRICAL_NOT_RECORDED) << "the recorder's thread wrote";
    EXPECT_EQ(lumbrical_session_stop_recording(c->session, &kept), LUMBRICAL_BAD_DATA);
  }
  fs::remove(path + ".part");
  const auto c = recorded(20);
  const FileSizeLimit limit(fs::file_size(path + ".part") + 10);
  std::signal(SIGXFSZ, SIG_DFL);
  EXPECT_EQ(lumbrical_session_stop_recording(c->session, nullptr), LUMBRICAL_BAD_DATA) << "this one did";
  const CSession other(MeshObject(ball_scene().objects[0].mesh).object);
  const FileSizeLimit shorter(10);
  std::signal(SIGXFSZ, SIG_DFL);
  EXPECT_EQ(lumbrical_session_record(other.session, (path + ".2").c_str(), nullptr), LUMBRICAL_BAD_DATA);
}

TEST(CApiRecordings, NameAWorldFileThatMayHaveMoved) {
  const fs::path folder = own_folder();
  const std::string path = (folder / "session.mcap").string(),
                    moved = (folder / "else" / "ball.world").string();
  ASSERT_TRUE(write_world(ball_scene(), {}, (folder / "ball.world").string()).ok());
  std::ofstream(folder / "scene.json") << R"({"world": "ball.world", "motion": {"grasp": {}}})";
  CSession c;
  ASSERT_EQ(lumbrical_scene_load((folder / "scene.json").c_str(), &c.scene), LUMBRICAL_OK)
      << lumbrical_message();
  c.start();
  ASSERT_EQ(lumbrical_session_record(c.session, path.c_str(), nullptr), LUMBRICAL_OK);
  for (std::size_t i = 50; i < 60; ++i) c.step(i);
  ASSERT_EQ(lumbrical_session_stop_recording(c.session, nullptr), LUMBRICAL_OK);
  fs::create_directory(folder / "else");
  fs::rename(folder / "ball.world", moved);

  auto result = sized<lumbrical_replay_result>();
  EXPECT_EQ(lumbrical_replay(path.c_str(), nullptr, nullptr, &result), LUMBRICAL_BAD_DATA);
  ASSERT_EQ(lumbrical_replay(path.c_str(), moved.c_str(), nullptr, &result), LUMBRICAL_OK)
      << lumbrical_message();
  EXPECT_EQ(result.identical, 1);
  const Reader reader = opened(path);
  CSession again;
  EXPECT_EQ(lumbrical_reader_model(reader.get(), nullptr, nullptr, &again.model), LUMBRICAL_BAD_DATA);
  ASSERT_EQ(lumbrical_reader_model(reader.get(), moved.c_str(), nullptr, &again.model), LUMBRICAL_OK)
      << lumbrical_message();
  ASSERT_EQ(lumbrical_session_create(again.model, &again.session), LUMBRICAL_OK);
  for (std::size_t i = 50; i < 59; ++i) again.step(i);
  EXPECT_EQ(std::memcmp(&again.step(59), &c.output, sizeof c.output), 0);
}

}  // namespace
}  // namespace lumbrical::test
