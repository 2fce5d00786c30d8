// What callers of lumbrical.h do wrong, and in whose axes they do it.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "capi/boundary.h"
#include "capi_fixture.h"

namespace lumbrical::test {
namespace {

void expect_refused(int status, int expected, const std::string& word) {
  EXPECT_EQ(status, expected) << lumbrical_message();
  EXPECT_NE(std::string(lumbrical_message()).find(word), std::string::npos)
      << "\"" << lumbrical_message() << "\" does not say \"" << word << "\"";
}

void expect_mistake(int status, const std::string& word) {
  expect_refused(status, LUMBRICAL_BAD_ARGUMENT, word);
}

TEST(CApiMistakes, NullPointersAreToldByName) {
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  const lumbrical_frame frame = touching_frame_c(0);
  std::size_t count = 0;
  expect_mistake(lumbrical_scene_create(LUMBRICAL_RIGHT, 0.19, nullptr), "scene is null");
  expect_mistake(lumbrical_scene_load(nullptr, &c.scene), "path is null");
  expect_mistake(lumbrical_scene_add_object(nullptr, nullptr), "scene is null");
  expect_mistake(lumbrical_scene_add_object(c.scene, nullptr), "object is null");
  expect_mistake(lumbrical_scene_set_radii(c.scene, nullptr), "radii is null");
  expect_mistake(lumbrical_scene_fit_hand(c.scene, nullptr), "is null");
  expect_mistake(lumbrical_model_build(c.scene, nullptr, nullptr), "model is null");
  expect_mistake(lumbrical_model_describe(nullptr, nullptr), "model is null");
  expect_mistake(lumbrical_session_create(nullptr, &c.session), "model is null");
  expect_mistake(lumbrical_session_tick(nullptr, &frame, nullptr, 0, &c.output), "session is null");
  expect_mistake(lumbrical_session_tick(c.session, nullptr, nullptr, 0, &c.output), "frame is null");
  expect_mistake(lumbrical_session_tick(c.session, &frame, nullptr, 0, nullptr), "output is null");
  expect_mistake(lumbrical_session_contacts(c.session, nullptr, 5, &count), "contacts is null");
  expect_mistake(lumbrical_session_save(c.session, nullptr, 5, &count), "bytes is null");
  expect_mistake(lumbrical_session_restore(c.session, nullptr, 5), "bytes is null");
  expect_mistake(lumbrical_session_record(c.session, nullptr, nullptr), "path is null");
  expect_mistake(lumbrical_reader_open(nullptr, LUMBRICAL_FIRST_HAND, nullptr), "path is null");
  expect_mistake(lumbrical_replay("x", nullptr, nullptr, nullptr), "result is null");
  expect_mistake(lumbrical_convert_poses(0, 1, nullptr, 2), "poses is null");
  expect_mistake(lumbrical_frame_from_openxr(nullptr, nullptr), "is null");
  EXPECT_EQ(lumbrical_scene_destroy(nullptr), LUMBRICAL_OK);
  EXPECT_EQ(lumbrical_model_destroy(nullptr), LUMBRICAL_OK);
  EXPECT_EQ(lumbrical_session_destroy(nullptr), LUMBRICAL_OK);
  EXPECT_EQ(lumbrical_reader_close(nullptr), LUMBRICAL_OK);
}

TEST(CApiMistakes, WhatDoesNotActOnWhatMovesSoIsRefusedInAnyAxes) {
  for (const std::int32_t mobility : {LUMBRICAL_FIXED, LUMBRICAL_FREE, LUMBRICAL_BALL}) {
    MeshObject ball(ball_scene().objects[0].mesh);
    ball.object.mobility = mobility;
    ball.object.convention = LUMBRICAL_UNITY;
    if (mobility != LUMBRICAL_FIXED) ball.object.mass = 0.1;
    lumbrical_scene* scene = nullptr;
    lumbrical_model* model = nullptr;
    ASSERT_EQ(lumbrical_scene_create(LUMBRICAL_RIGHT, 0.19, &scene), LUMBRICAL_OK);
    ASSERT_EQ(lumbrical_scene_add_object(scene, &ball.object), LUMBRICAL_OK) << lumbrical_message();
    EXPECT_EQ(lumbrical_model_build(scene, nullptr, &model), LUMBRICAL_OK) << lumbrical_message();
    lumbrical_model_destroy(model);
    ball.object.spring = 1;
    ASSERT_EQ(lumbrical_scene_add_object(scene, &ball.object), LUMBRICAL_OK) << lumbrical_message();
    expect_refused(lumbrical_model_build(scene, nullptr, &model), LUMBRICAL_BAD_DATA, "spring acts on");
    lumbrical_scene_destroy(scene);
  }
}

TEST(CApiMistakes, WhatActsOnNothingIsRefused) {
  CSession c;
  c.create();
  const auto refuse = [&](const char* told, const auto& edit) {
    MeshObject ball(ball_scene().objects[0].mesh);
    edit(ball.object);
    expect_mistake(lumbrical_scene_add_object(c.scene, &ball.object), told);
  };
  for (const std::int32_t mobility : {LUMBRICAL_FIXED, LUMBRICAL_GIVEN, LUMBRICAL_FREE})
    for (const double x : {0.1, std::nan("")})
      refuse("object->pivot acts on a hinge, slider or ball only", [&](lumbrical_object& object) {
        object.mobility = mobility;
        object.mass = mobility == LUMBRICAL_FREE ? 1 : 0;
        object.pivot[1] = x;
      });
  refuse("set has_latch", [](lumbrical_object& object) { object.latch_opens = 0.5; });
  refuse("set has_latch", [](lumbrical_object& object) { object.latch_object = 1; });
  refuse("object->unit is of a mesh_file",
         [](lumbrical_object& object) { object.unit = LUMBRICAL_MILLIMETRE; });
}

TEST(CApiMistakes, StructsOfAnotherSizeAreRefused) {
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  lumbrical_frame frame = touching_frame_c(0);
  for (const std::uint32_t size : {0u, 4u, static_cast<std::uint32_t>(sizeof frame) + 8, ~0u}) {
    frame.size = size;
    expect_mistake(lumbrical_session_tick(c.session, &frame, nullptr, 0, &c.output), "frame->size");
  }
  lumbrical_output output{};
  frame = touching_frame_c(0);
  expect_mistake(lumbrical_session_tick(c.session, &frame, nullptr, 0, &output), "output->size is 0");
  c.step(0);
  std::size_t count = 0;
  lumbrical_contact contact{};
  expect_mistake(lumbrical_session_contacts(c.session, &contact, 1, &count), "contacts->size");
  lumbrical_settings settings{};
  expect_mistake(lumbrical_scene_settings(c.scene, &settings), "settings->size");
  lumbrical_execution execution{};
  expect_mistake(lumbrical_model_build(c.scene, &execution, &c.model), "execution->size");
}

TEST(CApiMistakes, NumbersThatAreNoValueOfTheirEnumerationAreRefused) {
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  lumbrical_frame frame = touching_frame_c(0);
  frame.kind = 2;
  expect_mistake(lumbrical_session_tick(c.session, &frame, nullptr, 0, &c.output), "frame->kind is 2");
  expect_mistake(lumbrical_scene_create(-1, 0.19, &c.scene), "side is -1");
  MeshObject ball(ball_scene().objects[0].mesh);
  for (std::int32_t* const field :
       {&ball.object.mobility, &ball.object.convention, &ball.object.unit, &ball.object.winding}) {
    *field = 77;
    expect_mistake(lumbrical_scene_add_object(c.scene, &ball.object), "is 77");
    *field = 0;
  }
  auto settings = sized<lumbrical_settings>();
  ASSERT_EQ(lumbrical_scene_settings(c.scene, &settings), LUMBRICAL_OK);
  settings.law[7] = 5;
  expect_mistake(lumbrical_scene_set_settings(c.scene, &settings), "settings->law[7] is 5");
  lumbrical_execution execution;
  ASSERT_EQ(lumbrical_execution_init(&execution), LUMBRICAL_OK);
  execution.broadphase = 9;
  expect_mistake(lumbrical_model_build(c.scene, &execution, &c.model), "broadphase is 9");
  double v[3] = {};
  expect_mistake(lumbrical_convert_vectors(0, 3, 0, v, 1), "to is 3");
  expect_mistake(lumbrical_convert_vectors(0, 1, 3, v, 1), "quantity is 3");
  EXPECT_EQ(lumbrical_segment_name(16), nullptr);
  EXPECT_EQ(lumbrical_joint_name(-1), nullptr);
  EXPECT_STREQ(lumbrical_segment_name(15), "palm");
}

TEST(CApiMistakes, APrecisionOutOfRangeIsToldWithItsSegment) {
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  auto settings = sized<lumbrical_settings>();
  ASSERT_EQ(lumbrical_scene_settings(c.scene, &settings), LUMBRICAL_OK);
  settings.precision[5] = std::numeric_limits<double>::quiet_NaN();
  ASSERT_EQ(lumbrical_scene_set_settings(c.scene, &settings), LUMBRICAL_OK);
  lumbrical_model* other = nullptr;
  expect_refused(lumbrical_model_build(c.scene, nullptr, &other), LUMBRICAL_BAD_DATA,
                 "settings.precision[5] is out of range");
}

TEST(CApiMistakes, AHandleOfAnotherKindIsNoticed) {
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  const lumbrical_frame frame = touching_frame_c(0);
  auto* const wrong = reinterpret_cast<lumbrical_session*>(c.scene);
  expect_mistake(lumbrical_session_tick(wrong, &frame, nullptr, 0, &c.output), "no session");
  expect_mistake(lumbrical_session_destroy(wrong), "no session");  // leaves it alone
  lumbrical_model* other = nullptr;
  EXPECT_EQ(lumbrical_model_build(c.scene, nullptr, &other), LUMBRICAL_OK);
  lumbrical_model_destroy(other);
}

TEST(CApiMistakes, WhatTheEngineRefusesIsBadData) {
  CSession c;
  c.create();
  const auto refuse = [&](const Mesh& mesh, const char* word) {
    CSession own;
    own.create();
    MeshObject object(mesh);
    ASSERT_EQ(lumbrical_scene_add_object(own.scene, &object.object), LUMBRICAL_OK) << lumbrical_message();
    expect_refused(lumbrical_model_build(own.scene, nullptr, &own.model), LUMBRICAL_BAD_DATA, word);
  };
  Mesh nan = make_sphere(0.04, 2), far_corner = nan;
  nan.vertices[3].y = std::numeric_limits<double>::quiet_NaN();
  far_corner.triangles[2][1] = 4000000000u;
  refuse(nan, "vertex 3 is not finite");
  refuse(far_corner, "names vertex 4000000000");
  EXPECT_EQ(lumbrical_scene_load("no such file.json", &c.scene), LUMBRICAL_BAD_DATA);
  lumbrical_reader* reader = nullptr;
  EXPECT_EQ(lumbrical_reader_open("no such file.mcap", LUMBRICAL_FIRST_HAND, &reader), LUMBRICAL_BAD_DATA);
  EXPECT_EQ(reader, nullptr);
  MeshObject open(make_plane(0.2, 2));
  MeshObject wild(far_corner);
  wild.object.mobility = open.object.mobility = LUMBRICAL_FREE;
  wild.object.density = open.object.density = 1000;
  expect_refused(lumbrical_scene_add_object(c.scene, &wild.object), LUMBRICAL_BAD_DATA,
                 "names vertex 4000000000");
  expect_refused(lumbrical_scene_add_object(c.scene, &open.object), LUMBRICAL_BAD_DATA, "closed");
  for (const double density : {0.0, 1000.0, -1.0, std::nan("")}) {
    open.object.density = density;
    open.object.mass = density == 0 ? 0 : std::nan("");
    expect_mistake(lumbrical_scene_add_object(c.scene, &open.object), "density or a mass");
  }
  open.object.mobility = LUMBRICAL_FIXED;
  open.object.density = open.object.mass = 0;
  const std::uint16_t grey = 0;
  open.object.bumps = {&grey, 65536, 65536, 0.01, 0, 1};
  expect_mistake(lumbrical_scene_add_object(c.scene, &open.object), "texels");
  double radii[LUMBRICAL_JOINTS] = {};
  expect_refused(lumbrical_scene_set_radii(c.scene, radii), LUMBRICAL_BAD_DATA, "radius");
  expect_mistake(lumbrical_scene_create(LUMBRICAL_LEFT, std::nan(""), &c.scene), "hand_length");
}

TEST(CApiMistakes, ASceneFileThatAsksForMoreThanAHandAndStillObjectsIsRefused) {
  const std::string examples = LUMBRICAL_SOURCE_DIR "/examples/";
  lumbrical_scene* scene = nullptr;
  expect_refused(lumbrical_scene_load((examples + "bodies.json").c_str(), &scene), LUMBRICAL_BAD_DATA,
                 "bodies.json: physics: ");
  expect_refused(lumbrical_scene_load((examples + "two_hands.json").c_str(), &scene), LUMBRICAL_BAD_DATA,
                 "two_hands.json: motion: ");
  EXPECT_EQ(scene, nullptr);
}

TEST(CApiMistakes, AMassOfWhatStandsStillIsRefused) {
  CSession c;
  c.create();
  MeshObject ball(ball_scene().objects[0].mesh);
  for (double lumbrical_object::*const field : {&lumbrical_object::density, &lumbrical_object::mass}) {
    ball.object.*field = 1;
    expect_mistake(lumbrical_scene_add_object(c.scene, &ball.object), "takes no density or mass");
    ball.object.*field = 0;
  }
  ball.object.mobility = LUMBRICAL_GIVEN;
  EXPECT_EQ(lumbrical_scene_add_object(c.scene, &ball.object), LUMBRICAL_OK) << lumbrical_message();
  ball.object.mass = std::nan("");
  expect_mistake(lumbrical_scene_add_object(c.scene, &ball.object), "density or a mass");
}

// A file's square is two triangles: the caller's array must not be read beyond its end.
TEST(CApiMistakes, FrictionFactorsOfAMeshFileAreCounted) {
  const std::filesystem::path folder = own_folder();
  const std::string square = (folder / "square.obj").string();
  std::ofstream(square) << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  const std::vector<double> factors = {1, 2};
  lumbrical_object object;
  ASSERT_EQ(lumbrical_object_init(&object), LUMBRICAL_OK);
  object.mesh_file = square.c_str();
  object.static_friction = 0.5;
  object.friction_factors = factors.data();
  CSession c;
  c.create();
  for (const std::size_t count : {0, 1, 3}) {
    object.triangle_count = count;
    expect_mistake(lumbrical_scene_add_object(c.scene, &object), "the mesh_file has 2 triangles");
  }
  object.triangle_count = factors.size();
  EXPECT_EQ(lumbrical_scene_add_object(c.scene, &object), LUMBRICAL_OK) << lumbrical_message();
  c.start();
}

TEST(CApiMistakes, NothingIsReadFromTheStandardInputOfTheHost) {
  lumbrical_object object;
  ASSERT_EQ(lumbrical_object_init(&object), LUMBRICAL_OK);
  object.mesh_file = "-";
  CSession c;
  expect_mistake(lumbrical_scene_load("-", &c.scene), "standard input");
  c.create();
  expect_mistake(lumbrical_scene_add_object(c.scene, &object), "object->mesh_file is not read from standard");
}

TEST(CApiMistakes, AMaterialThatMakesNoSenseIsRefusedOfAnObjectThatStandsStill) {
  MeshObject ball(ball_scene().objects[0].mesh);
  for (double lumbrical_object::*const field :
       {&lumbrical_object::static_friction, &lumbrical_object::kinetic_friction, &lumbrical_object::viscosity,
        &lumbrical_object::shear_stiffness}) {
    const double good = ball.object.*field;
    for (const double wrong : {std::nan(""), -0.5}) {
      CSession c;
      c.create();
      ball.object.*field = wrong;
      EXPECT_EQ(lumbrical_scene_add_object(c.scene, &ball.object), LUMBRICAL_OK) << lumbrical_message();
      expect_refused(lumbrical_model_build(c.scene, nullptr, &c.model), LUMBRICAL_BAD_DATA, "out of range");
    }
    ball.object.*field = good;
  }
}

TEST(CApiMistakes, ALongMessageKeepsItsPlaceAndItsRemedy) {
  MeshObject ball(ball_scene().objects[0].mesh);
  const std::string name(5000, 'x'), path(1100, 'y');
  ball.object.name = name.c_str();
  ball.object.viscosity = -1;
  CSession c;
  c.create();
  ASSERT_EQ(lumbrical_scene_add_object(c.scene, &ball.object), LUMBRICAL_OK) << lumbrical_message();
  expect_refused(lumbrical_model_build(c.scene, nullptr, &c.model), LUMBRICAL_BAD_DATA,
                 "lumbrical_model_build: object \"xxx");
  expect_refused(lumbrical_model_build(c.scene, nullptr, &c.model), LUMBRICAL_BAD_DATA,
                 "xxx\": viscosity is out of range: give 0 to 100 s/m");
  EXPECT_EQ(std::string(lumbrical_message()).size(), 1023u);
  lumbrical_scene* none = nullptr;
  expect_refused(lumbrical_scene_load(path.c_str(), &none), LUMBRICAL_BAD_DATA, "permission to read it");
}

TEST(CApiMistakes, AFrameThatIsNotFiniteIsATickThatSaysSo) {
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  lumbrical_frame frame = touching_frame_c(60);
  frame.angle[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(c.step(frame).flags & LUMBRICAL_INPUT_NOT_FINITE, 0u);
  EXPECT_EQ(c.output.hand_force[2], 0);
}

TEST(CApiMistakes, AQuestionBeforeTheFirstTickIsRefused) {
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  std::size_t count = 0;
  std::uint32_t known = 0;
  std::vector<double> values(16 * 36);
  expect_mistake(lumbrical_session_contacts(c.session, nullptr, 0, &count), "not been ticked");
  expect_mistake(lumbrical_session_jacobians(c.session, ~0u, values.data(), &known), "not been ticked");
}

TEST(CApiMistakes, AHandleThatAnotherThreadIsInIsBusy) {
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  const lumbrical_frame frame = touching_frame_c(0);
  c.session->busy = true;
  expect_refused(lumbrical_session_tick(c.session, &frame, nullptr, 0, &c.output), LUMBRICAL_BUSY, "thread");
  c.session->busy = false;
  EXPECT_EQ(lumbrical_session_tick(c.session, &frame, nullptr, 0, &c.output), LUMBRICAL_OK);
}

TEST(CApiMistakes, AHandleThatAnotherThreadIsInIsNotDestroyed) {
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  c.session->busy = c.scene->busy = true;
  expect_refused(lumbrical_session_destroy(c.session), LUMBRICAL_BUSY,
                 "another thread is using this session; it is not destroyed");
  expect_refused(lumbrical_scene_destroy(c.scene), LUMBRICAL_BUSY, "it is not destroyed");
  c.session->busy = c.scene->busy = false;
  c.step(0);
}

TEST(CApiMistakes, ThreadsThatCallAtOnceGetTicksOrBusyAndTheirOwnMessages) {
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  std::atomic<int> ticks{0}, others{0};
  const auto run = [&] {
    auto output = sized<lumbrical_output>();
    const lumbrical_frame frame = touching_frame_c(60);
    for (int i = 0; i < 300; ++i) {
      const int status = lumbrical_session_tick(c.session, &frame, nullptr, 0, &output);
      (status == LUMBRICAL_OK ? ticks : others) += 1;
      EXPECT_TRUE(status == LUMBRICAL_OK || status == LUMBRICAL_BUSY) << status;
    }
  };
  std::thread first(run), second(run);
  first.join();
  second.join();
  EXPECT_EQ(ticks + others, 600);
  EXPECT_EQ(c.step(0).tick, static_cast<std::uint64_t>(ticks));
}

TEST(CApiOpenXr, LocationsAreTakenAsTheyAre) {
  lumbrical_joint joints[LUMBRICAL_JOINTS];
  for (int j = 0; j < LUMBRICAL_JOINTS; ++j) {
    const auto x = static_cast<float>(j);
    joints[j] = {{x + 0.25f, x + 0.5f, x + 0.75f}, {0.5f, -0.5f, 0.5f, x}};
  }
  lumbrical_frame frame = new_frame();
  frame.base.position[1] = 7;
  ASSERT_EQ(frame_by_openxr(joints, 0x3fffffe, 1, &frame), LUMBRICAL_OK) << lumbrical_message();
  EXPECT_EQ(frame.kind, LUMBRICAL_JOINT_POSES);
  EXPECT_EQ(frame.valid, 0x3fffffeu);
  EXPECT_EQ(frame.flags, 0u);
  EXPECT_EQ(frame.base.position[1], 7);
  EXPECT_EQ(std::memcmp(frame.joint, joints, sizeof joints), 0);
  ASSERT_EQ(frame_by_openxr(joints, ~0u, 0, &frame), LUMBRICAL_OK);
  EXPECT_EQ(frame.flags, static_cast<std::uint32_t>(LUMBRICAL_TRACKING_LOST));
}

TEST(CApiOpenXr, AHandIsFittedToItsJoints) {
  CSession c;
  c.create();
  lumbrical_joint joints[LUMBRICAL_JOINTS];
  std::array<Pose, kJointCount> poses;
  forward_kinematics(default_hand(Side::right, 0.17), {}, std::array<double, kAngleCount>{}, poses);
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const auto& [p, q] = poses[j];
    joints[j] = {
        {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)},
        {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)}};
  }
  ASSERT_EQ(fit_by_openxr(c.scene, joints, 0.0125f), LUMBRICAL_OK) << lumbrical_message();
  for (const double radius : c.scene->scene.hand.radius) EXPECT_EQ(radius, static_cast<double>(0.0125f));
  EXPECT_EQ(fit_by_openxr(c.scene, joints, -1), LUMBRICAL_OK) << "not told: the hand's own";
  EXPECT_EQ(fit_by_openxr(c.scene, joints, 1e9f), LUMBRICAL_BAD_DATA);
  EXPECT_EQ(c.scene->scene.hand.radius[4], static_cast<double>(0.0125f));
  for (lumbrical_joint& joint : joints) joint = joints[0];
  expect_refused(fit_by_openxr(c.scene, joints, 0.02f), LUMBRICAL_BAD_DATA, "span no area");
  EXPECT_EQ(c.scene->scene.hand.radius[4], static_cast<double>(0.0125f));
}

// ---- Axes and units

Vec3 convert(int from, int to, int quantity, Vec3 v) {
  double xyz[3] = {v.x, v.y, v.z};
  EXPECT_EQ(lumbrical_convert_vectors(from, to, quantity, xyz, 1), LUMBRICAL_OK);
  return {xyz[0], xyz[1], xyz[2]};
}

TEST(CApiAxes, RightUpAndAheadAreWhereEachConventionHasThem) {
  const Vec3 right{1, 0, 0}, up{0, 1, 0}, ahead{0, 0, -1};
  const auto in = [](int convention, Vec3 v) {
    return convert(LUMBRICAL_OPENXR, convention, LUMBRICAL_DIRECTION, v);
  };
  EXPECT_EQ(in(LUMBRICAL_UNITY, right), (Vec3{1, 0, 0}));
  EXPECT_EQ(in(LUMBRICAL_UNITY, up), (Vec3{0, 1, 0}));
  EXPECT_EQ(in(LUMBRICAL_UNITY, ahead), (Vec3{0, 0, 1}));
  EXPECT_EQ(in(LUMBRICAL_UNREAL, right), (Vec3{0, 1, 0}));
  EXPECT_EQ(in(LUMBRICAL_UNREAL, up), (Vec3{0, 0, 1}));
  EXPECT_EQ(in(LUMBRICAL_UNREAL, ahead), (Vec3{1, 0, 0}));
  EXPECT_EQ(convert(LUMBRICAL_OPENXR, LUMBRICAL_UNREAL, LUMBRICAL_POSITION, up), (Vec3{0, 0, 100}));
  EXPECT_EQ(convert(LUMBRICAL_UNREAL, LUMBRICAL_UNITY, LUMBRICAL_POSITION, {50, 0, 0}), (Vec3{0, 0, 0.5}));
}

TEST(CApiAxes, PosesMoveTheSamePointsAndTorquesMatchTheirArms) {
  const Pose pose{{0.1, -0.4, 0.7}, normalized({0.3, -0.5, 0.2, 0.7})};
  const Vec3 point{0.03, 0.2, -0.05}, force{1, 2, -3};
  for (const int to : {LUMBRICAL_UNITY, LUMBRICAL_UNREAL}) {
    const auto& [p, q] = pose;
    lumbrical_pose c = {{p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}};
    ASSERT_EQ(lumbrical_convert_poses(LUMBRICAL_OPENXR, to, &c, 1), LUMBRICAL_OK);
    const Pose there{{c.position[0], c.position[1], c.position[2]},
                     {c.orientation[3], c.orientation[0], c.orientation[1], c.orientation[2]}};
    const Vec3 moved = convert(LUMBRICAL_OPENXR, to, LUMBRICAL_POSITION, transform(pose, point));
    const Vec3 moved_there = transform(there, convert(LUMBRICAL_OPENXR, to, LUMBRICAL_POSITION, point));
    EXPECT_LT(norm(moved - moved_there), 1e-12);
    // Numbers of a torque are the cross product of the numbers of arm and force, whichever hand the frame is.
    const Vec3 arm = convert(LUMBRICAL_OPENXR, to, LUMBRICAL_DIRECTION, point);
    const Vec3 torque = convert(LUMBRICAL_OPENXR, to, LUMBRICAL_ROTATION, cross(point, force));
    EXPECT_LT(norm(torque - cross(arm, convert(LUMBRICAL_OPENXR, to, LUMBRICAL_DIRECTION, force))), 1e-12);
    ASSERT_EQ(lumbrical_convert_poses(to, LUMBRICAL_OPENXR, &c, 1), LUMBRICAL_OK);
    EXPECT_NEAR(c.position[0], p.x, 1e-15);
    EXPECT_NEAR(c.orientation[1], q.y, 1e-15);
  }
}

// The same touch told in the axes of another engine gives that engine's forces.
TEST(CApiAxes, ASceneInUnrealsAxesFeelsTheSame) {
  const Mesh mesh = make_sphere(0.04, 6);
  MeshObject ball(mesh);
  CSession plain(ball.object);
  std::vector<double> there = ball.vertices;
  ASSERT_EQ(lumbrical_convert_vectors(LUMBRICAL_OPENXR, LUMBRICAL_UNREAL, LUMBRICAL_POSITION, there.data(),
                                      there.size() / 3),
            LUMBRICAL_OK);
  ball.object.vertices = there.data();
  ball.object.convention = LUMBRICAL_UNREAL;
  CSession unreal(ball.object);
  lumbrical_frame frame = touching_frame_c(60);
  ASSERT_EQ(lumbrical_convert_frame(LUMBRICAL_OPENXR, LUMBRICAL_UNREAL, &frame), LUMBRICAL_OK);
  EXPECT_NEAR(frame.base.position[1], 100 * touching_frame(60).base.position.x, 1e-12);
  ASSERT_EQ(lumbrical_convert_frame(LUMBRICAL_UNREAL, LUMBRICAL_OPENXR, &frame), LUMBRICAL_OK);
  const lumbrical_output expected = plain.step(touching_frame_c(60));
  lumbrical_output output = unreal.step(frame);
  ASSERT_GT(expected.contact_count, 0u);
  ASSERT_EQ(lumbrical_convert_output(LUMBRICAL_OPENXR, LUMBRICAL_UNREAL, &output), LUMBRICAL_OK);
  EXPECT_NEAR(output.hand_force[2], expected.hand_force[1], 1e-6);
  EXPECT_NEAR(output.hand_force[0], -expected.hand_force[2], 1e-6);
  EXPECT_NEAR(output.segment[5].torque[1], -expected.segment[5].torque[0], 1e-8);
}

}  // namespace
}  // namespace lumbrical::test
