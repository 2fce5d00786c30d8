// What another law, stiffness or mesh would have changed in a recorded session.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "touch_session.h"

namespace lumbrical::test {
namespace {

class WhatIf : public TouchReplay {};
INSTANTIATE_TEST_SUITE_P(Inputs, WhatIf, ::testing::Values(InputKind::joint_poses, InputKind::joint_angles),
                         testing::PrintToStringParamName());

TEST_P(WhatIf, FindsTheFirstTickThatChanges) {
  ReplayOptions law, stiffness;
  law.law = Law::max_depth;
  stiffness.stiffness = 1e6;
  ReplayResult result;
  ASSERT_TRUE(replay_file(path_, result, law).ok());
  EXPECT_TRUE(result.first_divergence.has_value());
  ASSERT_TRUE(replay_file(path_, result, stiffness).ok());
  ASSERT_TRUE(result.first_divergence.has_value());
  EXPECT_GE(result.first_divergence->tick, 1u) << "nothing is touched at first";
  EXPECT_EQ(result.ticks, result.first_divergence->tick + 1);

  ReplayOptions bad;
  bad.stiffness = -1;
  const Status status = replay_file(path_, result, bad);
  EXPECT_NE(status.message().find("stiffness"), std::string::npos) << status.message();
}

Status what_if_file(const std::string& path, const ReplayOptions& options, WhatIfResult& result) {
  RecordingReader reader;
  if (Status status = reader.open(path); !status.ok()) return status;
  return what_if(reader, options, result);
}

TEST_P(WhatIf, SaysHowMuchAStifferWorldWouldChange) {
  Scene unlimited = touch_scene();
  unlimited.settings.max_force = 1e6;
  record_touch(path_, GetParam(), {}, unlimited);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path_).ok());
  std::vector<TickRecord> records;
  ASSERT_TRUE(read_records(reader, records).ok());

  WhatIfResult same, stiffer;
  ASSERT_TRUE(what_if_file(path_, {}, same).ok());
  ReplayOptions options;
  options.stiffness = 1.5 * touch_scene().settings.stiffness;
  ASSERT_TRUE(what_if_file(path_, options, stiffer).ok());
  EXPECT_EQ(stiffer.ticks, kTicks);
  EXPECT_GT(stiffer.baseline_time, 0);
  EXPECT_GT(stiffer.changed_time, 0);
  int touched = 0;
  for (std::size_t finger = 0; finger < kFingerCount; ++finger) {
    EXPECT_EQ(same.force[finger].max, 0);
    double largest = 0, squares = 0, noticed = 0;
    for (const TickRecord& record : records) {
      Vec3 force;
      for (std::size_t s = 3 * finger; s < 3 * finger + 3; ++s) force += record.output.segment[s].force;
      const double change = 0.5 * norm(force);  // half as much again
      largest = std::fmax(largest, change);
      noticed = std::fmax(noticed, change / (0.07 * std::fmax(norm(force), 0.5)));
      squares += change * change;
    }
    EXPECT_NEAR(stiffer.force[finger].max, largest, 1e-9 + 1e-9 * largest);
    EXPECT_NEAR(stiffer.force[finger].rms, std::sqrt(squares / static_cast<double>(kTicks)), 1e-9);
    EXPECT_NEAR(stiffer.force_jnd[finger].max, noticed, 1e-6);
    touched += largest > 0.5 ? 1 : 0;
    EXPECT_EQ(stiffer.felt_ticks[finger] > 0, noticed > 1);
  }
  EXPECT_GE(touched, 1);
}

TEST_P(WhatIf, KeepsNoPartOfASessionThatCannotBeReadToItsEnd) {
  const std::string damaged = temporary_path("damaged.mcap"), kept = temporary_path("kept.mcap");
  std::vector<std::uint8_t> bytes = read_bytes(path_);
  bytes[bytes.size() / 2] ^= 1;  // in a chunk
  write_bytes(damaged, bytes);
  ReplayOptions options;
  options.stiffness = 1e6;
  options.record = kept;
  WhatIfResult result;
  EXPECT_FALSE(what_if_file(damaged, options, result).ok());
  EXPECT_FALSE(std::filesystem::exists(kept));
  EXPECT_FALSE(std::filesystem::exists(kept + kPartSuffix));
  const Status status = what_if_file(path_, options, result);
  EXPECT_TRUE(status.ok()) << status.message();
  RecordingInfo info;
  EXPECT_TRUE(verify_recording(kept, info).ok());
  EXPECT_EQ(info.ticks, kTicks);
}

TEST_P(WhatIf, SaysWhatAnotherMeshWouldChange) {
  ReplayOptions options;
  options.mesh["ball"] = touch_scene().objects[0].mesh;
  WhatIfResult result;
  ASSERT_TRUE(what_if_file(path_, options, result).ok());
  for (const Change& change : result.force) EXPECT_EQ(change.max, 0);
  for (Vec3& vertex : options.mesh["ball"].vertices) vertex.z += 0.002;
  ASSERT_TRUE(what_if_file(path_, options, result).ok());
  double largest = 0;
  for (const Change& change : result.force) largest = std::fmax(largest, change.max);
  EXPECT_GT(largest, 0.1);
  options.mesh = {{"bowl", options.mesh["ball"]}};
  const Status status = what_if_file(path_, options, result);
  EXPECT_NE(status.message().find("no object \"bowl\""), std::string::npos) << status.message();
}

constexpr Pose kAskew{{0.004, -0.003, 0.01}, {0.8, 0.6, 0, 0}};

// The ball in the world frame stands for itself, inside out.
Mesh ball_in_the_world(const Mesh& own) {
  Mesh mesh = own;
  place_mesh(kAskew, mesh);
  for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

std::vector<SceneObject> balls_of_all_kinds() {
  const Mesh mesh = make_sphere(0.04, 4);
  SceneObject still{"still", mesh}, rubbing{"rubbing", mesh}, slider{"slider", mesh};
  place_mesh(kAskew, still.mesh);
  rubbing.material = {0.5, 0.4, 0, 1000};
  slider.mechanism.mobility = Mobility::slider;
  slider.mechanism.body = {0.2, {}, {1e-4, 1e-4, 1e-4, 0, 0, 0}};
  slider.mechanism.axis = {0, 1, 0};
  slider.mechanism.spring = 500;
  rubbing.pose = slider.pose = kAskew;
  return {still, rubbing, slider};
}

void record_ball(const std::string& path, const SceneObject& ball) {
  Scene scene = touch_scene();
  scene.objects = {ball};
  Model model;
  ASSERT_TRUE(build_model(scene, {}, model).ok());
  Recorder recorder;
  ASSERT_TRUE(recorder.open(cleared(path), scene_of(model), {}).ok());
  record_ticks(model, InputKind::joint_angles, recorder, [](const TickRecord&, const State&) {});
  ASSERT_TRUE(recorder.close().ok());
}

TEST(WhatIfMesh, StandsInTheWorldAndFacesOutwardsWhateverItStandsFor) {
  const std::string path = temporary_path("ball.mcap");
  for (const SceneObject& ball : balls_of_all_kinds()) {
    record_ball(path, ball);
    ReplayOptions options;
    options.mesh[ball.name] = ball_in_the_world(make_sphere(0.04, 4));
    WhatIfResult same, higher;
    const Status status = what_if_file(path, options, same);
    ASSERT_TRUE(status.ok()) << status.message();
    for (Vec3& vertex : options.mesh[ball.name].vertices) vertex.z += 0.002;
    ASSERT_TRUE(what_if_file(path, options, higher).ok());
    double rounding = 0, largest = 0;
    for (const Change& change : same.force) rounding = std::fmax(rounding, change.max);
    for (const Change& change : higher.force) largest = std::fmax(largest, change.max);
    EXPECT_LT(rounding, 1e-6) << ball.name;
    EXPECT_GT(largest, 0.1) << ball.name;
    ASSERT_EQ(same.replaced.size(), 1u);
    EXPECT_EQ(same.replaced[0].name, ball.name);
    EXPECT_EQ(same.replaced[0].winding.turned_parts, 1u);
  }
}

TEST(WhatIfMesh, OfAnObjectWithFrictionFactorsHasAsManyTriangles) {
  const std::string path = temporary_path("factors.mcap");
  SceneObject ball = balls_of_all_kinds()[1];
  ball.surface.friction_factor.assign(ball.mesh.triangles.size(), 0.5);
  record_ball(path, ball);
  ReplayOptions options;
  options.mesh["rubbing"] = ball_in_the_world(ball.mesh);
  WhatIfResult result;
  ASSERT_TRUE(what_if_file(path, options, result).ok());
  options.mesh["rubbing"].triangles.pop_back();
  const Status status = what_if_file(path, options, result);
  EXPECT_NE(status.message().find("object \"rubbing\" has a friction factor for each"), std::string::npos)
      << status.message();
}

TEST(WhatIfMesh, IsOfOneObjectOrOfNone) {
  const std::string path = temporary_path("twins.mcap");
  Scene scene = touch_scene();
  scene.objects.push_back(scene.objects[0]);
  record_touch(path, InputKind::joint_angles, {}, scene);
  ReplayOptions options;
  options.mesh["ball"] = scene.objects[0].mesh;
  WhatIfResult result;
  const Status status = what_if_file(path, options, result);
  EXPECT_NE(status.message().find("several objects \"ball\""), std::string::npos) << status.message();
}

}  // namespace
}  // namespace lumbrical::test
