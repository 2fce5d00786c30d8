// lumbrical.h, as C and others call it through liblumbrical.so, held against the C++ interface's bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "capi_fixture.h"
#include "lumbrical/jacobian.h"

namespace lumbrical::test {
namespace {

TEST(CApi, ForcesAreThoseOfTheCppInterfaceToTheLastBit) {
  for (const bool exact : {true, false}) {
    Scene scene = ball_scene();
    if (exact) scene.settings.precision.fill(0);
    const std::vector<lumbrical_frame> frames = touching_frames(120);
    const MeshObject ball(scene.objects[0].mesh);
    lumbrical_settings settings;
    ASSERT_EQ(lumbrical_settings_init(&settings), LUMBRICAL_OK);
    if (exact) std::fill(std::begin(settings.precision), std::end(settings.precision), 0);
    std::vector<lumbrical_output> outputs(frames.size());
    ASSERT_EQ(touch_mesh(&ball.object, &settings, frames.data(), frames.size(), outputs.data()), LUMBRICAL_OK)
        << lumbrical_message();
    const Model model = model_of(scene);
    State state = make_state(model);
    Scratch scratch = make_scratch(model);
    double strongest = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const ActuatorFrame expected = tick(model, state, scratch, touching_frame(i));
      expect_same(expected, outputs[i]);
      strongest = max(strongest, norm(expected.segment[5].force));
    }
    EXPECT_GT(strongest, 0.1);
  }
}

TEST(CApi, FloatVerticesAreTheSameMesh) {
  MeshObject ball(ball_scene().objects[0].mesh);
  std::vector<float> vertices;
  for (const double x : ball.vertices) vertices.push_back(static_cast<float>(x));
  std::copy(vertices.begin(), vertices.end(), ball.vertices.begin());
  CSession from_double(ball.object);
  ball.object.vertices = nullptr;
  ball.object.float_vertices = vertices.data();
  CSession from_float(ball.object);
  for (std::size_t i = 0; i < 60; ++i)
    EXPECT_EQ(std::memcmp(&from_double.step(i), &from_float.step(i), sizeof(lumbrical_output)), 0) << i;
}

TEST(CApi, ASceneFileGivesTheTicksOfItsOwnMotion) {
  const std::string path = std::string(LUMBRICAL_SOURCE_DIR) + "/examples/cup.json";
  SceneFile file;
  ASSERT_TRUE(load_scene_file(path, file).ok());
  const Model model = model_of(file.scene, file.execution);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  CSession c;
  ASSERT_EQ(lumbrical_scene_load(path.c_str(), &c.scene), LUMBRICAL_OK) << lumbrical_message();
  c.start();
  double seconds = 0;
  ASSERT_EQ(lumbrical_scene_seconds(c.scene, &seconds), LUMBRICAL_OK);
  EXPECT_EQ(seconds, file.seconds);
  std::uint32_t contacts = 0;
  for (int i = 0; i < 100; ++i) {
    const double time = 0.5 + i * 0.02;
    lumbrical_frame frame = new_frame();
    ASSERT_EQ(lumbrical_scene_frame(c.scene, time, &frame), LUMBRICAL_OK);
    EXPECT_EQ(lumbrical_scene_frame(c.scene, std::nan(""), &frame), LUMBRICAL_BAD_ARGUMENT);
    const ActuatorFrame expected = tick(model, state, scratch, resample(file.motion, time));
    expect_same(expected, c.step(frame));
    contacts += expected.contact_count;
  }
  EXPECT_GT(contacts, 0u);
}

// A tilted ball beside the world, and what is far from the hand. The ball comes first.
std::vector<lumbrical_contact> contacts_of_a_ball(double friction, lumbrical_output& last) {
  CSession c;
  c.create();
  const Mesh far_box = make_box({0.1, 0.1, 0.1}, 1);
  MeshObject box(far_box), ball(ball_scene().objects[0].mesh);
  box.object.pose.position[0] = 2;
  ball.object.pose = {{0.002, 0.001, 0.001}, {0.5, -0.5, 0.1, 0.7}};
  ball.object.static_friction = ball.object.kinetic_friction = friction;
  EXPECT_EQ(lumbrical_scene_add_object(c.scene, &ball.object), LUMBRICAL_OK) << lumbrical_message();
  EXPECT_EQ(lumbrical_scene_add_object(c.scene, &box.object), LUMBRICAL_OK) << lumbrical_message();
  c.set([](lumbrical_settings& settings) { std::fill(settings.precision, settings.precision + 16, 0); });
  c.start();
  for (std::size_t i = 0; i < 60; ++i) last = c.step(touching_frame_c(60));
  std::size_t count = 0;
  lumbrical_session_contacts(c.session, nullptr, 0, &count);
  std::vector<lumbrical_contact> contacts(count, sized<lumbrical_contact>());
  EXPECT_EQ(lumbrical_session_contacts(c.session, contacts.data(), count, &count), LUMBRICAL_OK);
  return contacts;
}

TEST(CApi, ContactsOfWhatRubsAreThoseOfTheSameObjectInTheWorld) {
  lumbrical_output smooth{}, rubbing{};
  const auto expected = contacts_of_a_ball(0, smooth), found = contacts_of_a_ball(0.5, rubbing);
  ASSERT_GT(expected.size(), 0u);
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_EQ(found.size(), rubbing.contact_count);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].segment, expected[i].segment);
    EXPECT_EQ(found[i].object, 0u);
    EXPECT_EQ(expected[i].object, 0u);
    EXPECT_EQ(found[i].triangle, expected[i].triangle);
    EXPECT_NEAR(found[i].depth, expected[i].depth, 1e-9);
    EXPECT_NEAR(found[i].area, expected[i].area, 1e-9);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(found[i].centroid[k], expected[i].centroid[k], 1e-9);
      EXPECT_NEAR(found[i].centre[k], expected[i].centre[k], 1e-9);
      EXPECT_NEAR(found[i].normal[k], expected[i].normal[k], 1e-9);
      EXPECT_NEAR(found[i].force[k], expected[i].force[k], 1e-9);
    }
  }
}

TEST(CApi, ContactsNameSegmentObjectAndTriangleAndAddUpToTheForce) {
  CSession c;
  c.create();
  const Mesh far_box = make_box({0.1, 0.1, 0.1}, 1);
  MeshObject box(far_box), ball(ball_scene().objects[0].mesh);
  box.object.pose.position[0] = 2;
  box.object.name = "far";
  ball.object.name = "near";
  ASSERT_EQ(lumbrical_scene_add_object(c.scene, &box.object), LUMBRICAL_OK);
  ASSERT_EQ(lumbrical_scene_add_object(c.scene, &ball.object), LUMBRICAL_OK);
  c.set([](lumbrical_settings& settings) { std::fill(settings.precision, settings.precision + 16, 0); });
  c.start();
  lumbrical_output last{};
  for (std::size_t i = 0; i < 60; ++i) last = c.step(touching_frame_c(60));
  std::size_t count = 0;
  EXPECT_EQ(lumbrical_session_contacts(c.session, nullptr, 0, &count), LUMBRICAL_TOO_SMALL);
  ASSERT_EQ(count, last.contact_count);
  ASSERT_GT(count, 0u);
  std::vector<lumbrical_contact> contacts(count, sized<lumbrical_contact>());
  ASSERT_EQ(lumbrical_session_contacts(c.session, contacts.data(), count, &count), LUMBRICAL_OK);
  double sum[LUMBRICAL_SEGMENTS][3] = {};
  const char* name = nullptr;
  for (const lumbrical_contact& contact : contacts) {
    ASSERT_LT(contact.segment, 16u);
    EXPECT_EQ(contact.object, 1u);
    EXPECT_LT(contact.triangle, ball.triangles.size() / 3);
    EXPECT_GT(contact.depth, 0);
    EXPECT_GT(contact.area, 0);
    for (int k = 0; k < 3; ++k) sum[contact.segment][k] += contact.force[k];
    ASSERT_EQ(lumbrical_model_object_name(c.model, contact.object, &name), LUMBRICAL_OK);
    EXPECT_STREQ(name, "near");
  }
  ASSERT_EQ(last.flags & (LUMBRICAL_FADING | LUMBRICAL_FORCE_LIMITED), 0u);
  for (int s = 0; s < LUMBRICAL_SEGMENTS; ++s)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(sum[s][k], last.segment[s].force[k], 1e-9) << s;
}

TEST(CApi, GivenObjectsAreFeltWhereTheyAreTold) {
  Scene scene = ball_scene();
  scene.objects[0].mechanism.mobility = Mobility::given;
  const Model model = model_of(scene);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  MeshObject ball(scene.objects[0].mesh);
  ball.object.mobility = LUMBRICAL_GIVEN;
  CSession c(ball.object);
  auto object = sized<lumbrical_object_output>();
  double most = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    const double lift = 0.0001 * static_cast<double>(i);
    const ObjectFrame given{{{0, 0, lift}, {}}};
    const ActuatorFrame expected = tick(model, state, scratch, touching_frame(50), {&given, 1});
    const lumbrical_pose pose = {{0, 0, lift}, {0, 0, 0, 1}};
    const lumbrical_frame frame = touching_frame_c(50);
    ASSERT_EQ(lumbrical_session_tick(c.session, &frame, &pose, 1, &c.output), LUMBRICAL_OK);
    expect_same(expected, c.output);
    std::size_t count = 0;
    ASSERT_EQ(lumbrical_session_objects(c.session, &object, 1, &count), LUMBRICAL_OK);
    EXPECT_EQ(count, 1u);
    EXPECT_EQ(object.pose.position[2], lift);
    EXPECT_EQ(object.wrench.force[2], scratch.object_output[0].wrench.force.z);
    most = max(most, norm(scratch.object_output[0].wrench.force));
  }
  EXPECT_GT(most, 0.1);
  const lumbrical_pose two[2] = {};
  const lumbrical_frame frame = touching_frame_c(50);
  EXPECT_EQ(lumbrical_session_tick(c.session, &frame, two, 2, &c.output), LUMBRICAL_BAD_ARGUMENT);
}

TEST(CApi, AHeavyBoxFallsAndAHingeTakesItsAxis) {
  CSession c;
  c.create();
  MeshObject box(make_box({0.1, 0.1, 0.1}, 1)), door(make_box({0.1, 0.4, 0.01}, 1));
  box.object.mobility = LUMBRICAL_FREE;
  box.object.mass = 1;
  box.object.pose.position[2] = 5;
  door.object.mobility = LUMBRICAL_HINGE;
  door.object.density = 500;
  door.object.pose.position[0] = 3;
  door.object.pivot[0] = 3;
  door.object.axis[0] = 1;
  door.object.axis[2] = 0;
  ASSERT_EQ(lumbrical_scene_add_object(c.scene, &box.object), LUMBRICAL_OK) << lumbrical_message();
  ASSERT_EQ(lumbrical_scene_add_object(c.scene, &door.object), LUMBRICAL_OK) << lumbrical_message();
  c.start();
  for (std::size_t i = 0; i < 100; ++i) c.step(touching_frame_c(0));
  lumbrical_object_output objects[2] = {sized<lumbrical_object_output>(), {}};
  std::size_t count = 0;
  ASSERT_EQ(lumbrical_session_objects(c.session, objects, 2, &count), LUMBRICAL_OK);
  EXPECT_EQ(objects[1].object, 1u);
  EXPECT_NEAR(objects[0].pose.position[2], 5 - 0.5 * 9.81 * 0.099 * 0.1, 1e-6);
  EXPECT_NEAR(objects[1].pose.position[0], 3, 1e-12);
}

TEST(CApi, JacobiansAreTheEnginesOwn) {
  Scene scene = ball_scene();
  scene.settings.precision.fill(0);
  const Model model = model_of(scene);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  tick(model, state, scratch, touching_frame(60));
  std::array<SegmentJacobian, kSegmentCount> expected{};
  segment_jacobians(model, scratch, expected);
  CSession c;
  c.create();
  MeshObject ball(scene.objects[0].mesh);
  ASSERT_EQ(lumbrical_scene_add_object(c.scene, &ball.object), LUMBRICAL_OK);
  c.set([](lumbrical_settings& settings) { std::fill(settings.precision, settings.precision + 16, 0); });
  c.start();
  c.step(touching_frame_c(60));
  std::vector<double> values(16 * 36);
  std::uint32_t known = 0;
  ASSERT_EQ(lumbrical_session_jacobians(c.session, 0xffff, values.data(), &known), LUMBRICAL_OK);
  double most = 0;
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    EXPECT_EQ((known >> s & 1u) != 0, expected[s].known) << s;
    EXPECT_EQ(std::memcmp(&values[36 * s], expected[s].value.data(), 36 * sizeof(double)), 0) << s;
    most = max(most, std::abs(values[36 * s]));
  }
  EXPECT_GT(most, 1);
}

TEST(CApi, JointPosesAreThoseOfForwardKinematics) {
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  const DeviceFrame frame = touching_frame(60);
  c.step(touching_frame_c(60));
  std::array<double, kAngleCount> angles;
  for (std::size_t i = 0; i < kAngleCount; ++i) angles[i] = frame.angle[i];
  std::array<Pose, kJointCount> expected;
  forward_kinematics(default_hand(Side::right), {frame.base.position, normalized(frame.base.orientation)},
                     angles, expected);
  lumbrical_pose joints[LUMBRICAL_JOINTS];
  ASSERT_EQ(lumbrical_session_joints(c.session, joints), LUMBRICAL_OK);
  for (std::size_t j = 0; j < kJointCount; ++j) {
    EXPECT_EQ(joints[j].position[1], expected[j].position.y) << j;
    EXPECT_EQ(joints[j].orientation[3], expected[j].orientation.w) << j;
    EXPECT_EQ(joints[j].orientation[0], expected[j].orientation.x) << j;
  }
}

TEST(CApi, ASurfaceIsThatOfTheEngine) {
  Scene scene = ball_scene();
  SceneObject& expected = scene.objects[0];
  expected.material = {0.5, 0.5, 0, 1000};
  expected.surface = {
      0.8, {}, {{1, 2, {65535, 30000}}, 0.02, 0.1, 1}, {{2, 1, {0, 65535}}, 0.004, 0, 0.0003}};
  expected.surface.friction_factor.assign(expected.mesh.triangles.size(), 0.75);
  const Surface& surface = expected.surface;
  MeshObject ball(expected.mesh);
  ball.object.static_friction = 0.5;  // and so the kinetic one
  ball.object.crease_angle = surface.crease_angle;
  ball.object.friction_factors = surface.friction_factor.data();
  const auto given = [](const Texture& texture) {
    const auto& [width, height, grey] = texture.image;
    return lumbrical_texture{grey.data(), width, height, texture.period, texture.black, texture.white};
  };
  ball.object.grip = given(surface.grip);
  ball.object.bumps = given(surface.bumps);
  CSession c(ball.object);
  const Model model = model_of(scene);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  for (std::size_t i = 0; i < 80; ++i) {
    c.step(i);
    tick(model, state, scratch, touching_frame(i));
  }
  std::uint64_t hash = 0;
  ASSERT_EQ(lumbrical_session_hash(c.session, &hash), LUMBRICAL_OK);
  EXPECT_EQ(hash, hash_state(state));
}

TEST(CApi, ASnapshotBringsBackEveryBitAndADamagedOneIsRefused) {
  MeshObject ball(ball_scene().objects[0].mesh);
  ball.object.mobility = LUMBRICAL_FREE;
  ball.object.mass = 0.3;
  ball.object.static_friction = 0.5;
  CSession c(ball.object);
  for (std::size_t i = 0; i < 40; ++i) c.step(i);
  std::size_t size = 0;
  EXPECT_EQ(lumbrical_session_save(c.session, nullptr, 0, &size), LUMBRICAL_TOO_SMALL);
  std::vector<unsigned char> bytes(size);
  ASSERT_EQ(lumbrical_session_save(c.session, bytes.data(), size, &size), LUMBRICAL_OK);
  std::vector<lumbrical_output> first;
  for (std::size_t i = 40; i < 80; ++i) first.push_back(c.step(i));
  ASSERT_EQ(lumbrical_session_restore(c.session, bytes.data(), size), LUMBRICAL_OK) << lumbrical_message();
  CSession other(ball.object);  // in lockstep from here on, on another machine say
  ASSERT_EQ(lumbrical_session_restore(other.session, bytes.data(), size), LUMBRICAL_OK);
  std::uint64_t hash = 0, other_hash = 1;
  for (std::size_t i = 40; i < 80; ++i) {
    EXPECT_EQ(std::memcmp(&c.step(i), &first[i - 40], sizeof(lumbrical_output)), 0) << i;
    EXPECT_EQ(std::memcmp(&other.step(i), &first[i - 40], sizeof(lumbrical_output)), 0) << i;
  }
  ASSERT_EQ(lumbrical_session_hash(c.session, &hash), LUMBRICAL_OK);
  ASSERT_EQ(lumbrical_session_hash(other.session, &other_hash), LUMBRICAL_OK);
  EXPECT_EQ(hash, other_hash);
  for (std::size_t at = 0; at < size; at += 1 + size / 97) {
    std::vector<unsigned char> damaged = bytes;
    damaged[at] ^= 0x10;
    EXPECT_EQ(lumbrical_session_restore(c.session, damaged.data(), size), LUMBRICAL_BAD_DATA) << at;
  }
  for (const std::size_t cut : {std::size_t{0}, std::size_t{3}, std::size_t{8}, size / 2, size - 1})
    EXPECT_EQ(lumbrical_session_restore(c.session, bytes.data(), cut), LUMBRICAL_BAD_DATA) << cut;
  CSession still(MeshObject(ball_scene().objects[0].mesh).object);  // has no object that moves
  EXPECT_EQ(lumbrical_session_restore(still.session, bytes.data(), size), LUMBRICAL_BAD_DATA);
}

TEST(CApi, ASnapshotOfATableThatStandsElsewhereIsRefused) {
  MeshObject table(make_plane(0.5, 2));
  table.object.static_friction = 0.5;
  CSession high(table.object);
  table.object.pose.position[2] = -0.1;
  CSession low(table.object);
  high.step(0);
  std::vector<unsigned char> bytes(100000);
  std::size_t size = 0;
  ASSERT_EQ(lumbrical_session_save(high.session, bytes.data(), bytes.size(), &size), LUMBRICAL_OK);
  EXPECT_EQ(lumbrical_session_restore(low.session, bytes.data(), size), LUMBRICAL_BAD_DATA);
  EXPECT_EQ(lumbrical_session_restore(high.session, bytes.data(), size), LUMBRICAL_OK);
}

TEST(CApi, ASnapshotOfForcesAboveTheLimitFadesFromTheLimit) {
  MeshObject ball(ball_scene().objects[0].mesh);
  const auto start = [&](CSession& c, double max_force) {
    c.create();
    ASSERT_EQ(lumbrical_scene_add_object(c.scene, &ball.object), LUMBRICAL_OK);
    c.set([=](lumbrical_settings& settings) {
      settings.max_force = max_force;
      settings.stiffness = 1e9;
    });
    c.start();
  };
  CSession strong, weak;
  start(strong, 1000);
  start(weak, 1);
  for (std::size_t i = 0; i < 80; ++i) {
    strong.step(i);
    weak.step(i);
  }
  const auto restored = [](const CSession& from, const CSession& to) {
    std::vector<unsigned char> bytes(100000);
    std::size_t size = 0;
    EXPECT_EQ(lumbrical_session_save(from.session, bytes.data(), bytes.size(), &size), LUMBRICAL_OK);
    return lumbrical_session_restore(to.session, bytes.data(), size);
  };
  EXPECT_EQ(restored(strong, weak), LUMBRICAL_OK) << lumbrical_message();
  lumbrical_frame lost = touching_frame_c(80);
  lost.flags = LUMBRICAL_TRACKING_LOST;
  for (const lumbrical_wrench& wrench : weak.step(lost).segment)
    EXPECT_LE(norm({wrench.force[0], wrench.force[1], wrench.force[2]}), 1 + 1e-6);
}

TEST(CApi, AProxyIsASettingAndAPartOfASnapshot) {
  Scene scene = ball_scene();
  scene.settings.proxy_stiffness = 500;
  scene.settings.pad = {{{{0.2, 3}, {0.5, -1}}}, 2};
  scene.settings.felt_once = FeltOnce::always;
  const Model model = model_of(scene);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  MeshObject ball(scene.objects[0].mesh);
  CSession c, without(ball.object);
  c.create();
  ASSERT_EQ(lumbrical_scene_add_object(c.scene, &ball.object), LUMBRICAL_OK);
  c.set([](lumbrical_settings& settings) {
    settings.proxy_stiffness = 500;
    settings.pad_from[0] = 0.2;
    settings.pad_stiffness[0] = 3;
    settings.pad_from[1] = 0.5;
    settings.pad_stiffness[1] = -1;
    settings.pad_damping = 2;
    settings.felt_once = LUMBRICAL_FELT_ONCE_ALWAYS;
  });
  c.set([](lumbrical_settings& settings) {
    EXPECT_EQ(settings.proxy_stiffness, 500);
    EXPECT_EQ(settings.felt_once, LUMBRICAL_FELT_ONCE_ALWAYS);
  });
  c.start();
  for (std::size_t i = 0; i < 60; ++i) expect_same(tick(model, state, scratch, touching_frame(i)), c.step(i));
  std::vector<unsigned char> bytes(100000);
  std::size_t size = 0;
  ASSERT_EQ(lumbrical_session_save(c.session, bytes.data(), bytes.size(), &size), LUMBRICAL_OK);
  EXPECT_EQ(lumbrical_session_restore(without.session, bytes.data(), size), LUMBRICAL_BAD_DATA);
  EXPECT_EQ(lumbrical_session_restore(c.session, bytes.data(), size), LUMBRICAL_OK);
}

TEST(CApi, TwoHandsShareAWorld) {
  MeshObject ball(ball_scene().objects[0].mesh);
  CSession right(ball.object), left, alone;
  left.create(LUMBRICAL_LEFT);
  ASSERT_EQ(lumbrical_model_share(right.model, left.scene, &left.model), LUMBRICAL_OK) << lumbrical_message();
  ASSERT_EQ(lumbrical_session_create(left.model, &left.session), LUMBRICAL_OK);
  alone.create(LUMBRICAL_LEFT);
  ASSERT_EQ(lumbrical_scene_add_object(alone.scene, &ball.object), LUMBRICAL_OK);
  alone.start();
  auto info = sized<lumbrical_model_info>();
  ASSERT_EQ(lumbrical_model_describe(left.model, &info), LUMBRICAL_OK);
  EXPECT_EQ(info.side, LUMBRICAL_LEFT);
  EXPECT_EQ(info.object_count, 1u);
  EXPECT_EQ(info.triangle_count, ball.triangles.size() / 3);
  for (std::size_t i = 40; i < 70; ++i)
    EXPECT_EQ(std::memcmp(&left.step(i), &alone.step(i), sizeof(lumbrical_output)), 0) << i;
}

TEST(CApi, SessionsOutliveTheirModelAndScene) {
  CSession c(MeshObject(ball_scene().objects[0].mesh).object);
  lumbrical_scene_destroy(std::exchange(c.scene, nullptr));
  lumbrical_model_destroy(std::exchange(c.model, nullptr));
  EXPECT_GT(c.step(touching_frame_c(60)).contact_count, 0u);
}

}  // namespace
}  // namespace lumbrical::test
