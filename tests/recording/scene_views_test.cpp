// The scene in a recording as other programs draw it: hand, forces and objects are where the ticks had them,
// and everything that handles a recording keeps them.
#include "recording/scene_views.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "foxglove_generated.h"
#include "recorded_views.h"
#include "touch_session.h"

namespace lumbrical::test {
namespace {

constexpr std::uint32_t kInterval = 20;
constexpr double kRate = 1000;

// The ball stands still; the other object is moved from outside.
Scene drawn_scene() {
  Scene scene = touch_scene();
  scene.settings.rate = kRate;
  SceneObject told{"", make_sphere(0.02, 3), Winding::automatic, {{-0.1, 0, 0.05}, {}}, {}, {}};
  told.mechanism.mobility = Mobility::given;
  scene.objects.insert(scene.objects.begin(), told);
  return scene;
}

Pose told_at(std::uint64_t tick) {
  const double angle = 0.001 * static_cast<double>(tick);
  return {{-0.1, 0.02 * angle, 0.05}, {std::cos(angle), std::sin(angle), 0, 0}};
}

DeviceFrame device_frame(std::uint64_t tick, const Hand& hand) {
  DeviceFrame frame = touch_frame(tick, InputKind::joint_poses, hand);
  if (tick < 40) frame.valid = 0;  // nothing to place yet
  return frame;
}

std::string recorded_scene() {
  const std::string path = cleared(temporary_path("scene.mcap"));
  const Scene scene = drawn_scene();
  Model model;
  EXPECT_TRUE(build_model(scene, {}, model).ok());
  RecorderOptions options;
  options.scene_interval = kInterval;
  options.models = {&model};
  Recorder recorder;
  EXPECT_TRUE(recorder.open(path, scene, options).ok());
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  TickRecord record;
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    record.device = device_frame(i, scene.hand);
    record.given_count = 1;
    record.given[0] = {told_at(i)};
    record.output = tick(model, state, scratch, record.device, given_of(record));
    take_results(state, scratch, record);
    EXPECT_TRUE(recorder.record(record, &state));
  }
  EXPECT_TRUE(recorder.close().ok());
  return path;
}

const foxglove::SceneUpdate& update_of(const View& view) {
  return *flatbuffers::GetRoot<foxglove::SceneUpdate>(view.bytes.data());
}

std::map<MessageKind, int> count(const std::vector<View>& views) {
  std::map<MessageKind, int> counts;
  for (const View& view : views) ++counts[view.kind];
  return counts;
}

Vec3 vector_of(const foxglove::Vector3& v) { return {v.x(), v.y(), v.z()}; }
Quat quat_of(const foxglove::Quaternion& q) { return {q.w(), q.x(), q.y(), q.z()}; }
Pose pose_of(const foxglove::Pose& pose) {
  return {vector_of(*pose.position()), quat_of(*pose.orientation())};
}

const foxglove::SceneEntity* entity(const View& view, std::string_view id) {
  if (update_of(view).entities() != nullptr)
    for (const auto* const found : *update_of(view).entities())
      if (found->id()->string_view() == id) return found;
  return nullptr;
}

TEST(DrawnScene, StandsAtItsIntervalsAndChangesNoTick) {
  const std::string path = recorded_scene();
  const std::vector<View> views = views_of(path);
  EXPECT_EQ(count(views), (std::map<MessageKind, int>{{MessageKind::scene, kTicks / kInterval},
                                                      {MessageKind::objects, 1},
                                                      {MessageKind::transforms, kTicks / kInterval}}));
  for (const View& view : views) EXPECT_EQ(view.tick % kInterval, 0u);
  RecordingInfo info;
  EXPECT_TRUE(verify_recording(path, info).ok());
  EXPECT_EQ(info.ticks, kTicks);
  EXPECT_TRUE(info.has_scene);
  EXPECT_FALSE(info.has_poses || info.has_contacts);
  ReplayResult result;
  EXPECT_TRUE(replay_file(path, result).ok());
  EXPECT_FALSE(result.first_divergence);
}

// The ends of a cone and the spheres it joins touch: the rim of either end lies on a sphere about a joint.
void expect_cones_on_joints(const foxglove::SceneEntity& hand, const DeviceFrame& frame, const Hand& sizes) {
  std::array<Vec3, kJointCount> joint;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const auto& p = frame.joint[j].position;
    joint[j] = frame.base.position + rotate(frame.base.orientation, {p[0], p[1], p[2]});
  }
  ASSERT_EQ(hand.cylinders()->size(), kPhalanxCount + sizes.palm.polygon.size());
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    const auto* const cone = hand.cylinders()->Get(static_cast<flatbuffers::uoffset_t>(i));
    const Pose pose = pose_of(*cone->pose());
    const Vec3 half = rotate(pose.orientation, {0, 0, 0.5 * cone->size()->z()});
    for (const bool top : {false, true}) {
      const auto j = static_cast<std::size_t>(top ? kPhalanxJoints[i].tip : kPhalanxJoints[i].base);
      const Vec3 centre = pose.position + (top ? half : -half);
      const double rim = 0.5 * cone->size()->x() * (top ? cone->top_scale() : cone->bottom_scale());
      EXPECT_NEAR(std::hypot(norm(centre - joint[j]), rim), sizes.radius[j], 1e-9)
          << joint_name(static_cast<int>(j));
      EXPECT_LE(norm(centre - joint[j]), sizes.radius[j]);
    }
  }
}

TEST(DrawnScene, HandIsWhereTheFramePutItAndIsTakenAwayWhereItCouldNotBePlaced) {
  const Hand sizes = drawn_scene().hand;
  int placed = 0, gone = 0;
  for (const View& view : views_of(recorded_scene())) {
    if (view.kind != MessageKind::scene) continue;
    const auto* const hand = entity(view, "hand");
    if (hand == nullptr) {
      ASSERT_LT(view.tick, 40u);
      EXPECT_EQ(update_of(view).deletions()->Get(0)->type(), foxglove::SceneEntityDeletionType::ALL);
      ++gone;
      continue;
    }
    EXPECT_EQ(hand->frame_id()->string_view(), "world");
    EXPECT_EQ(hand->timestamp()->nsec(), view.tick * 1000000 % 1000000000);
    // Joints and fingertips, and the corners of the palm.
    EXPECT_EQ(hand->spheres()->size(), kPhalanxCount + kFingerCount + sizes.palm.polygon.size());
    expect_cones_on_joints(*hand, device_frame(view.tick, sizes), sizes);
    ++placed;
  }
  EXPECT_EQ(gone, 2);
  EXPECT_EQ(placed, 28);
}

TEST(DrawnScene, ArrowsAreTheForcesInTheirOrderAndBeginAtTheHand) {
  const std::string path = recorded_scene();
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  int arrows = 0;
  for (const View& view : views_of(path)) {
    const auto* const forces = view.kind == MessageKind::scene ? entity(view, "forces") : nullptr;
    if (forces == nullptr) continue;
    TickRecord record;
    bool end = true;
    ASSERT_TRUE(reader.seek(view.tick).ok());
    ASSERT_TRUE(reader.next(record, end).ok());
    flatbuffers::uoffset_t next = 0;
    for (std::size_t s = 0; s < kSegmentCount; ++s) {
      const Vec3 force = record.output.segment[s].force;
      if (norm(force) < 1e-3) continue;
      ASSERT_LT(next, forces->arrows()->size());
      const auto* const arrow = forces->arrows()->Get(next++);
      const Pose pose = pose_of(*arrow->pose());
      const double length = arrow->shaft_length() + arrow->head_length();
      EXPECT_LT(norm(rotate(pose.orientation, {length, 0, 0}) - 0.005 * force), 1e-9);
      const bool on_ball = norm(pose.position) < 0.041;
      EXPECT_TRUE(on_ball || norm(pose.position - told_at(view.tick).position) < 0.021) << view.tick;
      ++arrows;
    }
    EXPECT_EQ(next, forces->arrows()->size());
  }
  EXPECT_GT(arrows, 20);
}

TEST(DrawnScene, ObjectsStandInTheirFramesAndFramesMoveAsTheTicksTold) {
  const Scene scene = drawn_scene();
  for (const View& view : views_of(recorded_scene())) {
    if (view.kind == MessageKind::transforms) {
      const auto& transforms = *flatbuffers::GetRoot<foxglove::FrameTransforms>(view.bytes.data());
      ASSERT_EQ(transforms.transforms()->size(), 1u);
      const auto* const told = transforms.transforms()->Get(0);
      EXPECT_EQ(told->parent_frame_id()->string_view(), "world");
      EXPECT_EQ(told->child_frame_id()->string_view(), "object 0");
      EXPECT_EQ(vector_of(*told->translation()), told_at(view.tick).position);
      EXPECT_NEAR(dot(quat_of(*told->rotation()), told_at(view.tick).orientation), 1, 1e-12);
    }
    if (view.kind != MessageKind::objects) continue;
    EXPECT_EQ(view.tick, 0u);
    for (const auto& [number, id, frame, moves] :
         {std::tuple(0u, "0", "object 0", true), std::tuple(1u, "1 ball", "world", false)}) {
      const auto* const object = entity(view, id);
      ASSERT_NE(object, nullptr) << id;
      EXPECT_EQ(object->frame_id()->string_view(), frame);
      EXPECT_EQ(object->frame_locked(), moves);
      const Mesh& mesh = scene.objects[number].mesh;
      const auto* const list = object->triangles()->Get(0);
      ASSERT_EQ(list->points()->size(), mesh.vertices.size());
      ASSERT_EQ(list->indices()->size(), 3 * mesh.triangles.size());
      for (flatbuffers::uoffset_t i = 0; i < list->indices()->size(); ++i) {
        const auto* const point = list->points()->Get(list->indices()->Get(i));
        EXPECT_EQ((Vec3{point->x(), point->y(), point->z()}), mesh.vertices[mesh.triangles[i / 3][i % 3]]);
      }
    }
  }
}

TEST(DrawnScene, PartsBeginWithTheObjectsAndPutTogetherAreTheWhole) {
  const std::string path = recorded_scene(), first = temporary_path("1.mcap"),
                    second = temporary_path("2.mcap"), whole = temporary_path("whole.mcap");
  CopyResult result;
  ASSERT_TRUE(copy_recordings({path}, first, {0, 250, std::nullopt}, result).ok());
  ASSERT_TRUE(copy_recordings({path}, second, {250, kTicks, std::nullopt}, result).ok());
  const std::vector<View> views = views_of(second);
  ASSERT_EQ(count(views)[MessageKind::objects], 1);
  EXPECT_EQ(views.front().kind, MessageKind::objects);
  EXPECT_EQ(views.front().tick, 250u);
  RecordingInfo info;
  EXPECT_TRUE(verify_recording(second, info).ok());
  ASSERT_TRUE(copy_recordings({first, second}, whole, {}, result).ok());
  EXPECT_EQ(read_bytes(whole), read_bytes(path));
}

TEST(DrawnScene, ComesBackFromARecordingThatWasKilled) {
  const std::string path = recorded_scene(), torn = temporary_path("torn.mcap"),
                    whole = temporary_path("whole.mcap");
  const std::vector<std::uint8_t> bytes = read_bytes(path);
  for (const std::size_t cut : {0, 1000}) {  // of the summary
    write_bytes(torn, std::span(bytes).first(bytes.size() - cut));
    std::uint64_t recovered = 0, lost = 0;
    ASSERT_TRUE(recover_recording(torn, cleared(whole), recovered, lost).ok());
    EXPECT_EQ(read_bytes(whole), bytes) << cut;
  }
}

TEST(DrawnScene, WithoutModelsOrWithObjectsThatFillNoMessageIsRefused) {
  RecorderOptions options;
  options.scene_interval = 1;
  Recorder recorder;
  EXPECT_NE(recorder.open(temporary_path("a.mcap"), touch_scene(), options).message().find("models"),
            std::string::npos);
  EXPECT_TRUE(check_drawable(touch_scene()).ok());
  EXPECT_NE(check_drawable(touch_scene(), 1000).message().find("too large"), std::string::npos);
}

/// One object of as many points as may be drawn.
Scene largest_drawable() {
  Scene scene = touch_scene();
  Mesh& mesh = scene.objects[0].mesh;
  const std::size_t more = 480'000;
  mesh.vertices.resize(more);
  while (!check_drawable(scene).ok()) mesh.vertices.resize(mesh.vertices.size() - 100);
  EXPECT_LT(mesh.vertices.size(), more);
  return scene;
}

TEST(DrawnScene, WhateverMayBeDrawnIsReadBack) {
  const std::string path = cleared(temporary_path("large.mcap"));
  const Scene scene = largest_drawable();
  flatbuffers::FlatBufferBuilder builder;
  draw_objects(scene, 0, builder);
  const std::vector<RecordingChannel> channels = channels_of({Side::right}, {MessageKind::objects});
  std::vector<std::uint8_t> session, tick;
  ASSERT_TRUE(encode_session(touch_scene(), session).ok());
  TickRecord record;
  seal(record);
  tick_message(record, tick);
  McapWriter writer;
  ASSERT_TRUE(open_recording(path, kRate, session, {}, {}, {}, writer, channels).ok());
  ASSERT_TRUE(writer.message(0, 0, {builder.GetBufferPointer(), builder.GetSize()}, 1).ok());
  ASSERT_TRUE(writer.message(0, 0, tick).ok());
  ASSERT_TRUE(writer.close().ok());
  RecordingInfo info;
  const Status status = verify_recording(path, info);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(info.ticks, 1u);
}

TEST(DrawnScene, MessagesOfObjectsAreNoLargerThanTheirCheckAllows) {
  Scene many = touch_scene(), named = touch_scene();
  many.objects.assign(300, {"", {}});
  named.objects.assign(10, {std::string(10'000, 'x'), touch_scene().objects[0].mesh});
  for (const Scene& scene : {touch_scene(), drawn_scene(), many, named}) {
    flatbuffers::FlatBufferBuilder builder;
    draw_objects(scene, 0, builder);
    EXPECT_FALSE(check_drawable(scene, builder.GetSize() - 1).ok());
  }
}

TEST(DrawnScene, DamagedAnywhereIsAnErrorOrCanBeDrawn) {
  for (const View& view : views_of(recorded_scene())) {
    if (view.tick != 300 && view.kind != MessageKind::objects) continue;
    const auto check = [&](std::span<const std::uint8_t> bytes) {
      return view.kind == MessageKind::transforms ? check_transforms(bytes) : check_scene(bytes);
    };
    ASSERT_TRUE(check(view.bytes).ok());
    for (std::size_t size = 0; size + 8 < view.bytes.size(); size += 97)
      EXPECT_FALSE(check(std::span(view.bytes).first(size)).ok()) << size;
    std::vector<std::uint8_t> damaged = view.bytes;
    for (std::size_t i = 0; i<damaged.size(); i += damaged.size()> 10000 ? 37 : 1) {
      damaged[i] ^= 0xff;
      static_cast<void>(check(damaged));  // whatever it says, it reads nothing beyond its bytes
      damaged[i] ^= 0xff;
    }
  }
}

TEST(DrawnScene, ATriangleWhoseCornerIsNotThereIsAnError) {
  flatbuffers::FlatBufferBuilder builder;
  Scene scene = touch_scene();
  scene.objects[0].mesh.triangles[5][1] = static_cast<std::uint32_t>(scene.objects[0].mesh.vertices.size());
  draw_objects(scene, 0, builder);
  EXPECT_FALSE(check_scene({builder.GetBufferPointer(), builder.GetSize()}).ok());
}

}  // namespace
}  // namespace lumbrical::test
