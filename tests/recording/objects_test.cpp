// Objects that move and rub in recordings: what they are, where they are told to be, and what became of them.
#include <gtest/gtest.h>

#include <cmath>

#include "pads.h"
#include "random.h"
#include "recording/session_message.h"
#include "recording/state_message.h"
#include "recording_fixture.h"
#include "session.h"

namespace lumbrical {
namespace {

using test::Session;

constexpr double kRate = 500;
constexpr std::uint64_t kTicks = 600;

Scene scene_of_objects() {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.settings.rate = kRate;
  scene.settings.pad = {{{{0.3, 2}, {0.6, -1.5}}}, 3};
  scene.settings.felt_once = FeltOnce::always;
  scene.ground.emplace(Ground{{0, 0, 1}, -0.001, 0.4});
  SceneObject mug{"mug", make_mug({}), Winding::automatic, {}, {0.8, 0.6, 0.1, 1500}, {}};
  mug.mechanism.mobility = Mobility::free;
  mug.mechanism.body = {0.2, {0, 0, 0.04}, {3e-4, 3e-4, 2e-4, 0, 0, 0}};
  mug.surface = {0.6, {}, {{1, 2, {65535, 40000}}, 0.01, 0, 1}, {{2, 1, {0, 65535}}, 0.004, 0, 0.0002}};
  mug.surface.friction_factor.assign(mug.mesh.triangles.size(), 0.875);
  SceneObject told{"told", make_sphere(0.02, 8), Winding::automatic, {{-0.1, 0, 0.05}, {}}, {}, {}};
  told.mechanism.mobility = Mobility::given;
  scene.objects = {told, mug, {"table", make_plane(0.3, 10), Winding::as_is}};
  return scene;
}

// Where the given object is told to be.
ObjectFrame frame_at(std::uint64_t tick) {
  return {{{-0.1, 0.02 * std::sin(0.01 * static_cast<double>(tick)), 0.05}, {}}};
}

// Of tick 500 a state may be kept that no tick has left.
std::string recorded_session(double proxy_stiffness = 0, bool forged = false) {
  const std::string path = test::cleared(test::temporary_path("objects.mcap"));
  Scene scene = scene_of_objects();
  scene.settings.proxy_stiffness = proxy_stiffness;
  const Model model = test::model_of(scene);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  const Motion motion = make_grasp(scene.hand, 0.037, 0.095, 1.2, 0.03);
  Recorder recorder;
  EXPECT_TRUE(recorder.open(path, scene, {}).ok());
  TickRecord record;
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    record.device = resample(motion, static_cast<double>(i) / kRate);
    record.given_count = 1;
    record.given[0] = frame_at(i);
    record.output = tick(model, state, scratch, record.device, given_of(record));
    take_results(state, scratch, record);
    State kept = state;
    if (forged && i == 500) {
      kept.objects.clear();
      kept.proxy.emplace();
      record.state_hash = hash_state(kept);
    }
    EXPECT_TRUE(recorder.record(record, &kept));
  }
  EXPECT_TRUE(recorder.close().ok());
  return path;
}

void expect_replay(const std::string& path, const Execution& execution) {
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  ReplayOptions options;
  options.execution = execution;
  ReplayResult result;
  const Status status = replay(reader, options, result);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(result.ticks, kTicks);
  EXPECT_FALSE(result.first_divergence)
      << result.first_divergence->stage << " " << result.first_divergence->field;
  EXPECT_EQ(result.damage, "");
}

Execution execution_of(Isa isa, std::uint32_t threads, Broadphase broadphase) {
  Execution execution;
  execution.isa = isa;
  execution.threads = threads;
  execution.broadphase = broadphase;
  return execution;
}

TEST(RecordedObjects, ReplayToTheLastBitHoweverTheWorkIsDone) {
  const std::string path = recorded_session();
  for (const Isa isa : {Isa::scalar, Isa::automatic})
    for (const std::uint32_t threads : {1u, 2u})
      for (const Broadphase broadphase : {Broadphase::tree, Broadphase::grid, Broadphase::brute})
        expect_replay(path, execution_of(isa, threads, broadphase));
}

TEST(RecordedObjects, ReplayToTheLastBitWithAProxyToo) {
  const std::string path = recorded_session(2000);
  expect_replay(path, execution_of(Isa::scalar, 2, Broadphase::grid));
  expect_replay(path, execution_of(Isa::automatic, 1, Broadphase::brute));
}

TEST(RecordedObjects, AreReadBackAsTheyWere) {
  RecordingReader reader;
  ASSERT_TRUE(reader.open(recorded_session()).ok());
  const Scene expected = scene_of_objects(), &found = reader.scene();
  ASSERT_EQ(found.objects.size(), expected.objects.size());
  for (std::size_t i = 0; i < found.objects.size(); ++i) {
    EXPECT_EQ(found.objects[i].name, expected.objects[i].name);
    EXPECT_EQ(found.objects[i].pose, expected.objects[i].pose);
    EXPECT_EQ(found.objects[i].material, expected.objects[i].material);
    EXPECT_EQ(found.objects[i].mechanism, expected.objects[i].mechanism);
    EXPECT_EQ(found.objects[i].surface, expected.objects[i].surface);
  }
  EXPECT_EQ(found.ground, expected.ground);
  EXPECT_EQ(found.gravity, expected.gravity);
  EXPECT_EQ(reader.scene().settings.pad, expected.settings.pad);
  EXPECT_EQ(reader.scene().settings.felt_once, FeltOnce::always);
  TickRecord record;
  bool end = false;
  double highest = 0;
  for (std::uint64_t i = 0; reader.next(record, end).ok() && !end; ++i) {
    ASSERT_EQ(record.object_count, 2u);
    EXPECT_EQ(record.given[0], frame_at(i));
    EXPECT_EQ(record.object[0].pose, frame_at(i).pose);
    highest = std::max(highest, record.object[1].pose.position.z);
  }
  EXPECT_GT(highest, 0.02);  // it was lifted
}

// Whoever looks at a tick amid a session goes on from the last state before it; the viewer's test does.
TEST(RecordedObjects, StateIsKeptBesideItsTickAndKnownByItsHash) {
  Scene scene = scene_of_objects();
  scene.settings.proxy_stiffness = 1000;
  scene.settings.pad.damping = 2;
  Session run(scene);
  const Motion motion = make_grasp(scene.hand, 0.037, 0.095, 1.2, 0.03);
  TickRecord record;
  for (std::uint64_t i = 0; i < 300; ++i) {
    record.device = resample(motion, static_cast<double>(i) / kRate);
    const ObjectFrame given = frame_at(i);
    run.step(record.device, {&given, 1});
  }
  record.output = run.output;
  record.state_hash = hash_state(run.state);
  flatbuffers::FlatBufferBuilder builder;
  const auto encoded = [&] {
    encode_tick(record, true, input_check_of(record), builder, encode_state(run.state));
    return std::span<const std::uint8_t>(builder.GetBufferPointer(), builder.GetSize());
  };
  std::optional<State> after;
  ASSERT_TRUE(decode_state_after(encoded(), after).ok());
  ASSERT_TRUE(after.has_value());
  EXPECT_EQ(hash_state(*after), record.state_hash);
  EXPECT_TRUE(after->proxy.has_value());
  EXPECT_TRUE(after->motion.has_value());
  record.state_hash ^= 1;
  EXPECT_FALSE(decode_state_after(encoded(), after).ok());
  EXPECT_FALSE(after.has_value());
}

TEST(RecordedObjects, ThatAreChangedAreNoticed) {
  const std::string path = recorded_session();
  for (const bool input : {true, false}) {
    const std::string changed = test::cleared(test::temporary_path("changed.mcap"));
    test::alter_recording(path, changed, [&](TickRecord& record) {
      if (record.output.tick == 300)
        (input ? record.given[0].pose : record.object[1].pose).position.x += 1e-9;
      return true;
    });
    RecordingInfo info;
    const Status status = verify_recording(changed, info);
    EXPECT_NE(status.message().find("tick 300"), std::string::npos) << status.message();
  }
}

TEST(RecordedObjects, APartOfASessionReplaysFromWhereItsObjectsWere) {
  const std::string path = recorded_session(), part = test::cleared(test::temporary_path("part.mcap"));
  CopyOptions options;
  options.from = 350;  // amid the lift
  CopyResult copied;
  ASSERT_TRUE(copy_recordings({path}, part, options, copied).ok());
  EXPECT_TRUE(copied.replayable);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(part).ok());
  ReplayResult result;
  const Status status = replay(reader, {}, result);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(result.ticks, kTicks - 350);
  EXPECT_FALSE(result.first_divergence);
}

std::string part_of(const std::vector<std::string>& paths, const std::string& name, std::uint64_t from,
                    std::uint64_t to, bool& replayable) {
  const std::string part = test::cleared(test::temporary_path(name));
  CopyResult copied;
  const Status status = copy_recordings(paths, part, {from, to, {}}, copied);
  EXPECT_TRUE(status.ok()) << status.message();
  replayable = copied.replayable;
  return part;
}

// The state beside tick 500 tells of all that was before, whatever is missing there.
TEST(RecordedObjects, APartBehindAGapReplaysFromAStateThatIsKept) {
  const std::string path = recorded_session(2000);
  bool replayable = false;
  const std::string before = part_of({path}, "before.mcap", 0, 300, replayable);
  const std::string behind = part_of({path}, "behind.mcap", 310, kTicks, replayable);
  const std::string gap = part_of({before, behind}, "gap.mcap", 0, kTicks, replayable);
  EXPECT_FALSE(replayable);
  for (const std::uint64_t from : {501u, 502u, 590u}) {
    const std::string part = part_of({gap}, "part.mcap", from, kTicks, replayable);
    EXPECT_TRUE(replayable) << from;
    RecordingReader reader;
    ASSERT_TRUE(reader.open(part).ok());
    ReplayResult result;
    const Status status = replay(reader, {}, result);
    EXPECT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(result.ticks, kTicks - from);
    EXPECT_FALSE(result.first_divergence);
  }
  part_of({gap}, "part.mcap", 400, kTicks, replayable);  // the last state is from before the gap
  EXPECT_FALSE(replayable);
}

TEST(RecordedObjects, AKeptStateOfAnotherModelIsPassedOver) {
  const std::string path = recorded_session(0, true);
  bool replayable = false;
  part_of({path}, "part.mcap", 505, kTicks, replayable);
  EXPECT_TRUE(replayable) << "from the beginning";
}

// What a forged file may take in memory is bounded by its size; this is the most that a true one takes.
TEST(RecordedObjects, MayBeManyOfATriangleEach) {
  Scene scene = scene_of_objects(), found;
  const SceneObject chip{"", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, Winding::as_is};
  scene.objects.assign(1000, chip);
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(encode_session(scene, bytes, {}).ok());
  const Status status = decode_session(bytes, found, nullptr);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(found.objects.size(), 1000u);
}

TEST(RecordedObjects, ASceneOfAModelIsTheSceneItWasBuiltFrom) {
  const Model model = test::model_of(scene_of_objects());
  const Scene scene = scene_of(model);
  ASSERT_EQ(scene.objects.size(), 3u);
  EXPECT_EQ(scene.objects[0].name, "told");
  EXPECT_EQ(scene.objects[1].name, "mug");
  EXPECT_EQ(scene.objects[2].name, "table");
  EXPECT_EQ(test::hash_run(test::model_of(scene), test::grasp_frames(scene.hand, 30)),
            test::hash_run(model, test::grasp_frames(scene.hand, 30)));
}

// What a scene file says is normalized when it is read, when a model is built of it, and when one is built of
// that model's recording.
TEST(RecordedObjects, HoweverTheyAreTurnedStandWhereTheyStoodWhenTheyAreReadAgain) {
  test::Random random(3);
  for (int i = 0; i < 300; ++i) {
    const auto any = [&] { return random.between(-2, 2); };
    const Pose turned{{}, normalized({any(), any(), any(), any()})};
    Scene scene;
    scene.hand = default_hand(Side::right);
    scene.objects = {{"rubbing", make_sphere(0.02, 2), Winding::automatic, turned, {0.5, 0.5, 0, 1000}, {}}};
    const Model model = test::model_of(scene);
    ASSERT_EQ(test::model_of(scene_of(model)).apart[0].start, model.apart[0].start);
  }
}

// They were recorded before build_model refused them.
TEST(RecordedObjects, OfASessionDropWhatDoesNotActOnThem) {
  Scene scene = scene_of_objects();
  scene.objects[1].mechanism.spring = 5;
  scene.objects[2].mechanism.damping = 1;
  Model model;
  EXPECT_FALSE(build_model(scene, {}, model).ok());
  std::vector<std::uint8_t> session;
  ASSERT_TRUE(encode_session(scene, session).ok());
  Scene decoded;
  std::optional<Hand> second;
  ASSERT_TRUE(decode_session(session, decoded, &second).ok());
  EXPECT_EQ(decoded.objects[1].mechanism, scene_of_objects().objects[1].mechanism);
  EXPECT_EQ(decoded.objects[2].mechanism, Mechanism{});
  const Status status = build_model(decoded, {}, model);
  EXPECT_TRUE(status.ok()) << status.message();
}

}  // namespace
}  // namespace lumbrical
