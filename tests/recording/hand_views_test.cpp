// Posed hands and contact points in a recording: they are what the ticks had, and everything that handles a
// recording keeps them.
#include "recording/hand_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "flatbuffers/reflection_generated.h"
#include "recorded_views.h"
#include "touch_session.h"

namespace lumbrical::test {
namespace {

constexpr std::uint32_t kPoseInterval = 10, kContactInterval = 20;

/// `see` is shown every record and the state its tick left.
template <class See>
void record_views(const std::string& path, const Scene& scene, See&& see) {
  Model model;
  ASSERT_TRUE(build_model(scene, {}, model).ok());
  RecorderOptions options;
  options.pose_interval = kPoseInterval;
  options.contact_interval = kContactInterval;
  options.models = {&model};
  Recorder recorder;
  Status status = recorder.open(cleared(path), scene, options);
  ASSERT_TRUE(status.ok()) << status.message();
  record_ticks(model, InputKind::joint_poses, recorder, see);
  status = recorder.close();
  ASSERT_TRUE(status.ok()) << status.message();
}

void record_views(const std::string& path) {
  record_views(path, touch_scene(), [](const TickRecord&, const State&) {});
}

std::size_t count_of(const std::vector<View>& views, MessageKind kind) {
  return static_cast<std::size_t>(
      std::count_if(views.begin(), views.end(), [kind](const View& view) { return view.kind == kind; }));
}

TEST(HandViews, StandAtTheirIntervalsAndChangeNoTick) {
  const std::string path = temporary_path("views.mcap"), plain = temporary_path("plain.mcap");
  record_views(path);
  const std::vector<View> views = views_of(path);
  EXPECT_EQ(count_of(views, MessageKind::pose), kTicks / kPoseInterval);
  EXPECT_EQ(count_of(views, MessageKind::contacts), kTicks / kContactInterval);
  for (const View& view : views)
    EXPECT_EQ(view.tick % (view.kind == MessageKind::pose ? kPoseInterval : kContactInterval), 0u);
  RecordingInfo info;
  EXPECT_TRUE(verify_recording(path, info).ok());
  EXPECT_EQ(info.ticks, kTicks);
  EXPECT_TRUE(info.has_poses);
  EXPECT_TRUE(info.has_contacts);
  ReplayResult result;
  EXPECT_TRUE(replay_file(path, result).ok());
  EXPECT_FALSE(result.first_divergence);
  record_touch(plain, InputKind::joint_poses);
  RecordingReader without;
  ASSERT_TRUE(without.open(plain).ok());
  EXPECT_FALSE(without.info().has_poses || without.info().has_contacts);
  EXPECT_TRUE(views_of(plain).empty());
}

TEST(HandViews, JointsAreWhereTheFramePutThem) {
  const std::string path = temporary_path("views.mcap");
  record_views(path);
  for (const View& view : views_of(path)) {
    if (view.kind != MessageKind::pose) continue;
    std::vector<Pose> joints;
    ASSERT_TRUE(decode_pose(view.bytes, joints).ok());
    const DeviceFrame frame = touch_frame(view.tick, InputKind::joint_poses, touch_scene().hand);
    for (std::size_t j = 0; j < kJointCount; ++j) {
      const auto& p = frame.joint[j].position;
      const Vec3 expected = frame.base.position + rotate(frame.base.orientation, Vec3{p[0], p[1], p[2]});
      EXPECT_LT(norm(joints[j].position - expected), 1e-9)
          << view.tick << ' ' << joint_name(static_cast<int>(j));
    }
  }
}

// Where nothing fades and no limit is near, contact points are the whole of a segment's force.
void expect_points_to_add_up(const Scene& scene) {
  const std::string path = temporary_path("views.mcap");
  std::vector<TickRecord> records;
  record_views(path, scene, [&](const TickRecord& record, const State&) { records.push_back(record); });
  std::size_t compared = 0;
  for (const View& view : views_of(path)) {
    if (view.kind != MessageKind::contacts) continue;
    std::vector<ContactPoint> points;
    ASSERT_TRUE(decode_contacts(view.bytes, points).ok());
    const ActuatorFrame& output = records[view.tick].output;
    EXPECT_EQ(points.size(), output.contact_count);
    if ((output.flags & (kFading | kForceLimited)) != 0) continue;
    std::array<Vec3, kSegmentCount> force{};
    for (const ContactPoint& point : points) {
      force[point.segment] += point.force;
      EXPECT_LT(norm(point.centre), 0.041) << "on the ball";
      EXPECT_GE(point.area, 0);
      EXPECT_EQ(point.object, 0u);
      EXPECT_LT(point.triangle, scene.objects[0].mesh.triangles.size());
    }
    for (std::size_t s = 0; s < kSegmentCount; ++s) {
      EXPECT_LT(norm(force[s] - output.segment[s].force), 2e-3) << view.tick << ' ' << s;
      compared += norm(force[s]) > 0.1 ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 5u);
}

TEST(HandViews, ContactPointsAddUpToTheForces) { expect_points_to_add_up(touch_scene()); }

TEST(HandViews, ContactPointsOfWhatRubsAreAmongThem) {
  Scene scene = touch_scene();
  scene.objects[0].material.static_friction = scene.objects[0].material.kinetic_friction = 1e-9;
  expect_points_to_add_up(scene);
}

// Drawn is the hand that is felt: the one that surfaces hold back.
TEST(HandViews, WithAProxyAreOfTheProxy) {
  const std::string path = temporary_path("views.mcap");
  Scene scene = touch_scene();
  scene.settings.proxy_stiffness = 3000;
  std::vector<ProxyState> proxies;
  std::vector<std::array<Vec3, kJointCount>> tracked;
  record_views(path, scene, [&](const TickRecord& record, const State& after) {
    proxies.push_back(after.proxy.value_or(ProxyState{}));
    const DeviceFrame& frame = record.device;
    for (auto& place = tracked.emplace_back(); const JointPose& joint : frame.joint) {
      const auto& p = joint.position;
      place[static_cast<std::size_t>(&joint - frame.joint.data())] =
          frame.base.position + rotate(frame.base.orientation, Vec3{p[0], p[1], p[2]});
    }
  });
  double held = 0;
  for (const View& view : views_of(path)) {
    if (view.kind != MessageKind::pose) continue;
    std::vector<Pose> joints;
    ASSERT_TRUE(decode_pose(view.bytes, joints).ok());
    for (std::size_t j = 0; j < kJointCount; ++j) {
      EXPECT_LT(norm(joints[j].position - proxies[view.tick].joint[j].position), 3e-8) << view.tick;
      held = std::max(held, norm(joints[j].position - tracked[view.tick][j]));
    }
  }
  EXPECT_EQ(count_of(views_of(path), MessageKind::contacts), kTicks / kContactInterval);
  EXPECT_GT(held, 0.005) << "nothing is held";
}

TEST(HandViews, AreOfSchemasThatAreInTheFileByTheirNames) {
  const auto schema = view_schema();
  flatbuffers::Verifier verifier(schema.data(), schema.size());
  ASSERT_TRUE(reflection::VerifySchemaBuffer(verifier));
  std::set<std::string> names;
  for (const reflection::Object* const object : *reflection::GetSchema(schema.data())->objects())
    names.insert(object->name()->str());
  EXPECT_TRUE(names.contains(std::string(kPoseSchemaName)));
  EXPECT_TRUE(names.contains(std::string(kContactsSchemaName)));
  const std::string path = temporary_path("views.mcap");
  record_views(path);
  InputFile file;
  ASSERT_TRUE(file.open(path).ok());
  Summary summary;
  bool present = false;
  ASSERT_TRUE(read_summary(file, summary, present).ok());
  std::set<std::string> topics;
  for (const mcap::Channel& channel : summary.channels) {
    topics.insert(channel.topic);
  }
  // The reader keeps no channel's metadata; outside its chunks a file is not compressed.
  const std::vector<std::uint8_t> bytes = read_bytes(path);
  const std::string text(bytes.begin(), bytes.end());
  for (const char* unit : {"segments.force N", "poses.position m", "force_x N"})
    EXPECT_NE(text.find(unit), std::string::npos) << unit;
  EXPECT_EQ(topics, (std::set<std::string>{"tick", "pose", "contacts"}));
  EXPECT_EQ(summary.schemas.size(), 3u);
}

TEST(HandViews, PartsAndWhatIsRecoveredKeepThem) {
  const std::string path = temporary_path("views.mcap"), part = temporary_path("part.mcap"),
                    torn = temporary_path("torn.mcap"), whole = temporary_path("whole.mcap"),
                    first = temporary_path("1.mcap"), second = temporary_path("2.mcap");
  record_views(path);
  CopyResult result;
  ASSERT_TRUE(copy_recordings({path}, part, {95, 300, Compression::zstd}, result).ok());
  const std::vector<View> views = views_of(part);
  EXPECT_EQ(count_of(views, MessageKind::pose), 20u);
  EXPECT_EQ(count_of(views, MessageKind::contacts), 10u);
  RecordingInfo info;
  EXPECT_TRUE(verify_recording(part, info).ok());
  ASSERT_TRUE(copy_recordings({path}, first, {0, 250, std::nullopt}, result).ok());
  ASSERT_TRUE(copy_recordings({path}, second, {250, kTicks, std::nullopt}, result).ok());
  ASSERT_TRUE(copy_recordings({first, second}, whole, {}, result).ok());
  EXPECT_EQ(read_bytes(whole), read_bytes(path));

  std::vector<std::uint8_t> bytes = read_bytes(path);
  bytes.resize(bytes.size() / 2);
  write_bytes(torn, bytes);
  std::uint64_t recovered = 0, lost = 0;
  ASSERT_TRUE(recover_recording(torn, cleared(whole), recovered, lost).ok());
  EXPECT_GE(count_of(views_of(whole), MessageKind::pose), recovered / kPoseInterval);
  EXPECT_TRUE(verify_recording(whole, info).ok());
}

TEST(HandViews, LeaveNoTableWhereItsExportIsStopped) {
  const std::string path = temporary_path("views.mcap"), table = temporary_path("table.csv");
  record_views(path);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  for (const MessageKind kind : {MessageKind::pose, MessageKind::contacts}) {
    int asked = 0;
    ExportOptions options;
    options.stop = [&asked] { return ++asked > 5; };
    EXPECT_NE(export_views({&reader, 1}, kind, options, table).message().find("stopped"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(table));
    EXPECT_FALSE(std::filesystem::exists(table + ".part"));
  }
}

TEST(HandViews, ComeOutAsTables) {
  const std::string path = temporary_path("views.mcap"), table = temporary_path("table.csv");
  record_views(path);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  ExportOptions options;
  options.first = 100;
  options.last = 199;
  ASSERT_TRUE(export_views({&reader, 1}, MessageKind::pose, options, table).ok());
  const auto lines_of = [&table] {
    std::ifstream in(table);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    std::filesystem::remove(table);
    return lines;
  };
  std::vector<std::string> lines = lines_of();
  ASSERT_EQ(lines.size(), 1 + 10 * kJointCount);
  EXPECT_EQ(lines[0].find("tick,time [s],hand,joint,x [m]"), 0u);
  EXPECT_EQ(lines[1].find("100,0.1,right,palm,"), 0u) << lines[1];
  options = {};
  ASSERT_TRUE(export_views({&reader, 1}, MessageKind::contacts, options, table).ok());
  std::size_t points = 0;
  for (const View& view : views_of(path)) {
    std::vector<ContactPoint> of_tick;
    if (view.kind == MessageKind::contacts && decode_contacts(view.bytes, of_tick).ok())
      points += of_tick.size();
  }
  lines = lines_of();
  EXPECT_EQ(lines.size(), 1 + points);
  EXPECT_GT(points, 100u);
  record_touch(path, InputKind::joint_poses);
  ASSERT_TRUE(reader.open(path).ok());
  EXPECT_NE(
      export_views({&reader, 1}, MessageKind::contacts, options, table).message().find("--record-contacts"),
      std::string::npos);
}

TEST(HandViews, OfARangeWithoutTicksAreNoTableButOfOneWithoutViewsAnEmptyOne) {
  const std::string path = temporary_path("views.mcap"), table = temporary_path("table");
  record_views(path);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  for (const ExportFormat format : {ExportFormat::csv, ExportFormat::json, ExportFormat::npz}) {
    ExportOptions options;
    options.format = format;
    options.first = kTicks;
    const Status none = export_views({&reader, 1}, MessageKind::pose, options, table);
    EXPECT_NE(none.message().find("it holds 0 to 599"), std::string::npos) << none.message();
    EXPECT_FALSE(std::filesystem::exists(table));
    options.first = 101;
    options.last = 109;
    EXPECT_TRUE(export_views({&reader, 1}, MessageKind::pose, options, table).ok());
    EXPECT_TRUE(std::filesystem::remove(table));
  }
}

TEST(HandViews, ThatAreDamagedAreToldByFileAndTick) {
  const std::string path = cleared(temporary_path("damaged.mcap"));
  std::vector<std::uint8_t> session;
  ASSERT_TRUE(encode_session(touch_scene(), session).ok());
  const std::vector<RecordingChannel> channels = channels_of({Side::right}, {MessageKind::contacts});
  McapWriter writer;
  ASSERT_TRUE(open_recording(path, 1000, session, {}, {}, {}, writer, channels).ok());
  ASSERT_TRUE(writer.message(20'000'000, 20, std::vector<std::uint8_t>(50), 1).ok());
  ASSERT_TRUE(writer.close().ok());
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  const Status status = export_views({&reader, 1}, MessageKind::contacts, {}, temporary_path("contacts.csv"));
  EXPECT_EQ(status.message(), path + ": tick 20: contact points do not fit their schema");
}

TEST(HandViews, WithoutModelsAreRefused) {
  RecorderOptions options;
  options.pose_interval = 1;
  Recorder recorder;
  EXPECT_NE(recorder.open(temporary_path("a.mcap"), touch_scene(), options).message().find("models"),
            std::string::npos);
}

TEST(HandViews, DamagedAnywhereAreErrorsOrNumbers) {
  const std::string path = temporary_path("views.mcap");
  record_views(path);
  for (const View& view : views_of(path)) {
    if (view.tick != 300) continue;
    std::vector<Pose> joints;
    std::vector<ContactPoint> points;
    const auto decode = [&](std::span<const std::uint8_t> bytes) {
      return view.kind == MessageKind::pose ? decode_pose(bytes, joints) : decode_contacts(bytes, points);
    };
    ASSERT_TRUE(decode(view.bytes).ok());
    for (std::size_t size = 0; size + 8 < view.bytes.size(); size += 7)  // the last may be padding
      EXPECT_FALSE(decode(std::span(view.bytes).first(size)).ok()) << size;
    std::vector<std::uint8_t> damaged = view.bytes;
    for (std::size_t i = 0; i < damaged.size(); ++i) {
      damaged[i] ^= 0xff;
      static_cast<void>(decode(damaged));  // whatever it says, it reads nothing beyond its bytes
      damaged[i] ^= 0xff;
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
