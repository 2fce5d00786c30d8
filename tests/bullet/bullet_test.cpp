// Bodies that touch each other: the hand's contact is ours, theirs is Bullet's.
#include "lumbrical/bullet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "finely_cut.h"
#include "lumbrical/shared_objects.h"
#include "pads.h"
#include "recording/recording_fixture.h"

namespace lumbrical {
namespace {

using test::Pad;
using test::Session;

// A body that Bullet moves.
SceneObject body_of(const char* name, Mesh mesh, double mass, Vec3 position, const Material& material = {}) {
  SceneObject object = test::body_of(name, std::move(mesh), mass, {position, {}}, material);
  object.mechanism.mobility = Mobility::given;
  return object;
}

/// A session with a physics engine beside it.
struct World : Session {
  BulletWorld world;
  std::vector<ObjectFrame> given;

  explicit World(const Scene& scene) : Session(scene), given(start_frames(model)) {
    const Status status = make_bullet_world(model, {}, world);
    if (!status.ok()) throw std::runtime_error(status.message());
  }
  void advance(const DeviceFrame& frame) {
    step(frame, given);
    push_bodies(world, model, scratch);
    move_bodies(world, model, given);
  }
};

DeviceFrame no_hand() { return test::frame_of({{{0, 0, 10}}}); }

TEST(Bullet, AMugComesToRestOnATableAndStays) {
  Scene scene = test::pad_scene();
  scene.objects.push_back({"table", make_box({0.4, 0.4, 0.02}, 4)});
  scene.objects.push_back(body_of("mug", make_mug({}), 0.3, {0, 0, 0.02}));
  World run(scene);
  for (int i = 0; i < 800; ++i) run.advance(no_hand());
  const Pose rested = run.given[0].pose;
  EXPECT_NEAR(rested.position.z, 0.01, 1e-4);
  for (int i = 0; i < 2000; ++i) run.advance(no_hand());
  EXPECT_LT(norm(run.given[0].pose.position - rested.position), 2e-4);
  EXPECT_LT(test::angle_of(run.given[0].pose.orientation * conjugate(rested.orientation)), 2e-3);
}

// Blocks of 40 mm and 0.1 kg, one on the other, on the ground.
Scene stack(int count) {
  Scene scene = test::pad_scene();
  scene.ground.emplace();
  for (int i = 0; i < count; ++i)
    scene.objects.push_back(
        body_of("block", make_box({0.04, 0.04, 0.04}, 3), 0.1, {0, 0, 0.02 + 0.04 * i}, {0.8, 0.6, 0, 1000}));
  return scene;
}

TEST(Bullet, StackedBlocksStandAndFallWhereAFingerPushes) {
  World run(stack(5));
  for (int i = 0; i < 1000; ++i) run.advance(no_hand());
  for (int i = 0; i < 5; ++i)
    EXPECT_LT(norm(run.given[static_cast<std::size_t>(i)].pose.position - Vec3{0, 0, 0.02 + 0.04 * i}), 3e-4);
  // A finger pushes the topmost but one over the edge of those below, and waits until they lie.
  for (int i = 0; i < 1500; ++i) {
    const double x = -0.03 + 0.00004 * std::min(i, 1200);
    run.advance(test::frame_of({{{x, 0, 0.145}, {-1, 0, 0}}}));
    EXPECT_LT(norm(test::hand_force(run.output)), 8);
    EXPECT_EQ(run.output.flags & kObjectImplausible, 0u);
  }
  EXPECT_LT(run.given[4].pose.position.z, 0.1);
  EXPECT_NEAR(run.given[0].pose.position.z, 0.02, 1e-3);
}

// Also where a light thing carries a heavy one.
TEST(Bullet, AStackAtRestDoesNotCreep) {
  for (const double ratio : {1.0, 10.0}) {
    Scene scene = stack(3);
    scene.settings.rate = 500;
    double mass = 0.01;
    for (SceneObject& block : scene.objects) {
      scale_to_mass(mass, block.mechanism.body);
      mass *= ratio;
    }
    World run(scene);
    for (int i = 0; i < 500; ++i) move_bodies(run.world, run.model, run.given);
    const std::vector<ObjectFrame> settled = run.given;
    for (int i = 0; i < 2500; ++i) move_bodies(run.world, run.model, run.given);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LT(norm(run.given[i].pose.position - settled[i].pose.position), 1e-4) << ratio << " " << i;
      EXPECT_LT(norm(run.given[i].pose.position - run.model.apart[i].start.position), 3e-4)
          << ratio << " " << i;
    }
  }
}

// From before it touches until the body has left it.
TEST(Bullet, WhatTheHandDoesIsWhatTheBodysMomentumChangesBy) {
  Scene scene = test::pad_scene();
  scene.gravity = {};
  scene.objects.push_back(body_of("box", make_box({0.05, 0.03, 0.04}, 4), 0.2, {0.001, 0.002, 0}));
  scene.objects[0].mechanism.body.centre = {0.004, -0.003, 0.002};
  scene.objects[0].mechanism.body.inertia = {8e-5, 1e-4, 9e-5, 1e-5, -2e-5, 5e-6};
  World run(scene);
  const auto centre = [&] { return transform(run.given[0].pose, scene.objects[0].mechanism.body.centre); };
  Vec3 impulse, last;
  for (int i = 0; i < 400; ++i) {
    last = centre();
    run.advance(test::frame_of({{{0.002, 0.006, 0.0285 - 1e-4 * std::min(i, 30)}, {0, 0, 1}}}));
    const Vec3 force = run.scratch.object_output[0].wrench.force;
    EXPECT_LT(norm(test::hand_force(run.output) + force), 1e-12);
    impulse += 1e-3 * force;
  }
  EXPECT_EQ(run.output.contact_count, 0u);
  EXPECT_GT(norm(impulse), 0.01);
  EXPECT_LT(norm(200 * (centre() - last) - impulse), 0.01 * norm(impulse));
}

// Two fingertips press on a cube and then go up and down.
DeviceFrame grip_at(double z) {
  const double y = 0.02 + test::kPadRadius - 0.001;
  return test::frame_of({{{0.003, y, z}, {0, 1, 0}}, {{-0.002, -y, z}, {0, -1, 0}}});
}

TEST(Bullet, LightThingsInAGripMoveAsThoseDoThatMoveByThemselves) {
  for (const double rate : {500.0, 1000.0}) {
    for (const double mass : {0.002, 0.02}) {
      Scene scene = test::pad_scene();
      scene.settings.rate = rate;
      scene.objects.push_back(
          body_of("cube", make_box({0.04, 0.04, 0.04}, 4), mass, {}, {0.8, 0.6, 0, 1000}));
      World bullet(scene);
      scene.objects[0].mechanism.mobility = Mobility::free;
      Session own(scene);
      for (int i = 0; i < rate; ++i) {
        const double z = 0.005 * std::sin(std::min(12 * i / rate, 7.854));  // until it stands still above
        bullet.advance(grip_at(z));
        own.step(grip_at(z));
        const Vec3 off = test::hand_force(bullet.output) - test::hand_force(own.output);
        ASSERT_LT(norm(off), i > 0.2 * rate ? 0.05 : 1) << rate << " " << mass << " " << i;
      }
      EXPECT_LT(norm(bullet.given[0].pose.position - own.state.objects[0].pose.position), 1e-4);
      EXPECT_NEAR(test::hand_force(bullet.output).z, -9.81 * mass, 0.01);
    }
  }
}

// Springs are solved together with what else touches a body: in the way of a light one, skin does not only
// push what it has for itself.
TEST(Bullet, AHandPushesThroughALightThingWhatStandsBehindIt) {
  Scene scene = test::pad_scene();
  scene.gravity = {};
  const Mesh cube = make_box({0.04, 0.04, 0.04}, 3);
  scene.objects.push_back(body_of("light", cube, 0.002, {0, 0, 0}));
  scene.objects.push_back(body_of("heavy", cube, 1, {0, 0, -0.04}));
  World run(scene);
  const DeviceFrame frame = test::frame_of({{{0, 0, 0.02 + test::kPadRadius - 0.002}, {0, 0, 1}}});
  Vec3 impulse;
  for (int i = 0; i < 100; ++i) {
    run.advance(frame);
    run.step(frame, run.given);  // what the step was
    impulse += 1e-3 * run.scratch.object_output[0].wrench.force;
  }
  const Vec3 before = run.given[1].pose.position;
  run.advance(no_hand());
  run.advance(no_hand());
  const Vec3 momentum = 500 * (run.given[1].pose.position - before);
  EXPECT_LT(impulse.z, -0.02);
  EXPECT_NEAR(momentum.z, impulse.z, 0.02 * norm(impulse));
}

// A fingertip presses, off the middle, many times as hard as by the weight. What lies below is a closed
// convex part, an open sheet, or a tray, cut finely.
TEST(Bullet, WhatIsPressedOntoATableStays) {
  Mesh table = make_box({0.4, 0.4, 0.02}, 4);
  place_mesh({{0, 0, -0.01}, {}}, table);
  for (const Mesh& below : {table, make_plane(0.3, 32), test::finely_cut_tray()}) {
    for (const double rate : {500.0, 1000.0}) {
      for (const double mass : {0.005, 0.05}) {
        Scene scene = test::pad_scene();
        scene.settings.rate = rate;
        scene.objects.push_back({"below", below});
        scene.objects.push_back(
            body_of("cube", make_box({0.03, 0.03, 0.03}, 2), mass, {0, 0, 0.015}, {0.8, 0.8, 0, 1000}));
        World run(scene);
        const auto press = [&](double depth) {
          run.advance(test::frame_of({{{0.002, 0.001, 0.03 + test::kPadRadius - depth}, {0, 0, 1}}}));
        };
        for (int i = 0; i < 0.5 * rate; ++i) press(0.003 * std::min(1.0, i / (0.4 * rate)));
        const Pose rested = run.given[0].pose;
        Vec3 last = test::hand_force(run.output);
        for (int i = 0; i < rate; ++i) {
          press(0.003);
          const Vec3 force = test::hand_force(run.output);
          ASSERT_LT(norm(force - last), 0.15) << rate << " " << mass << " " << i;
          ASSERT_LT(std::hypot(force.x, force.y), 0.5) << rate << " " << mass << " " << i;
          last = force;
        }
        EXPECT_GT(test::hand_force(run.output).z, 1);
        EXPECT_LT(norm(run.given[0].pose.position - rested.position), 4e-4) << rate << " " << mass;
      }
    }
  }
}

// Finely cut, and no face of them a convex polygon: an L, a bowl, a saddle, and a table as a scanner sees it.
std::vector<Mesh> finely_cut_surfaces() {
  std::vector<Mesh> surfaces(4, make_plane(0.3, 16));
  std::erase_if(surfaces[0].triangles, [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t i) {
      return surfaces[0].vertices[i].x > 0.05 && surfaces[0].vertices[i].y > 0.05;
    });
  });
  for (Vec3& p : surfaces[1].vertices) p.z = p.x * p.x + p.y * p.y;
  for (Vec3& p : surfaces[2].vertices) p.z = 0.2 * (p.x * p.x - p.y * p.y);
  for (Vec3& p : surfaces[3].vertices) p.z = 1e-5 * std::sin(1731 * p.x + 917 * p.y);
  return surfaces;
}

TEST(Bullet, WhatIsPressedOntoAFinelyCutSurfaceStaysWhateverItsShape) {
  const std::vector<Mesh> surfaces = finely_cut_surfaces();
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    Scene scene = test::pad_scene();
    scene.objects.push_back({"below", surfaces[k]});
    scene.objects.push_back(
        body_of("cube", make_box({0.03, 0.03, 0.03}, 2), 0.005, {0, 0, 0.0153}, {0.8, 0.8, 0, 1000}));
    World run(scene);
    Pose rested;
    for (int i = 0; i < 700; ++i) {
      const double depth = 0.003 * std::min(1.0, i / 200.0);
      run.advance(test::frame_of({{{0.002, 0.001, 0.03 + test::kPadRadius - depth}, {0, 0, 1}}}));
      if (i < 300) rested = run.given[0].pose;
      const Vec3 force = test::hand_force(run.output);
      ASSERT_LT(std::hypot(force.x, force.y), i < 300 ? 2 : 0.25) << k << " " << i;
    }
    EXPECT_GT(test::hand_force(run.output).z, 3) << k;
    EXPECT_LT(norm(run.given[0].pose.position - rested.position), 2e-4) << k;
    EXPECT_LT(test::angle_of(run.given[0].pose.orientation * conjugate(rested.orientation)), 0.02) << k;
  }
}

// Such meshes load and are told of, and nothing stands on them.
TEST(Bullet, AWorldOfTrianglesWithoutAreaHoldsNothing) {
  Scene scene = test::pad_scene();
  scene.objects.push_back({"hair", {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}}});
  scene.objects.push_back(body_of("cube", make_box({0.04, 0.04, 0.04}, 2), 0.1, {0, 0, 0.02}));
  World run(scene);
  for (int i = 0; i < 100; ++i) run.advance(no_hand());
  EXPECT_LT(run.given[0].pose.position.z, 0);
}

TEST(Bullet, ABodyWithoutAMassGoesWhereItIsToldAndPushesTheOthers) {
  Scene scene = test::pad_scene();
  scene.ground.emplace();
  scene.objects.push_back(body_of("pusher", make_box({0.04, 0.04, 0.04}, 2), 0.1, {0, 0, 0.021}));
  scene.objects[0].mechanism.body = {};
  scene.objects.push_back(body_of("pushed", make_box({0.04, 0.04, 0.04}, 2), 0.1, {0.045, 0, 0.02}));
  World run(scene);
  for (int i = 0; i < 600; ++i) {
    run.given[0].pose.position.x = 0.0001 * i;
    run.advance(no_hand());
  }
  EXPECT_NEAR(run.given[1].pose.position.x, 0.0599 + 0.04, 5e-4);
}

TEST(Bullet, WhatStandsStillHoldsBodiesUpWhetherItRubsOrNot) {
  for (const bool rubs : {false, true}) {
    Scene scene = test::pad_scene();
    const Pose place{{0, 0, 0.5}, {}};
    Mesh table = make_box({0.4, 0.4, 0.02}, 4);
    if (!rubs) place_mesh(place, table);
    scene.objects.push_back(
        test::object_of("table", table, rubs ? place : Pose{}, {rubs ? 0.6 : 0, 0, 0, 1000}));
    scene.objects.push_back(body_of("cube", make_box({0.04, 0.04, 0.04}, 2), 0.1, {0, 0, 0.53}));
    World run(scene);
    for (int i = 0; i < 500; ++i) run.advance(no_hand());
    EXPECT_NEAR(run.given[0].pose.position.z, 0.53, 1e-4) << rubs;
  }
}

// A lift that stands elsewhere when it is first told to be below the cube, that jumps, and that for one tick
// is nowhere.
TEST(Bullet, WhatJumpsOrIsNoPosePushesNothingAway) {
  for (const double off : {0.0, 0.001, 0.09, 0.5}) {
    Scene scene = test::pad_scene();
    scene.objects.push_back(body_of("lift", make_box({0.3, 0.3, 0.02}, 2), 0.1, {0, 0, 0.5 - off}));
    scene.objects[0].mechanism.body = {};
    scene.objects.push_back(body_of("cube", make_box({0.04, 0.04, 0.04}, 2), 0.1, {0, 0, 0.53}));
    World run(scene);
    for (int i = 0; i < 400; ++i) {
      run.given[0].pose = {{i < 200 ? 0 : 0.12, 0, 0.5}, {}};
      if (i == 100) run.given[0].pose.position.z = std::nan("");
      if (i == 300) run.given[0].pose.orientation = {0, 0, 0, 0};
      run.advance(no_hand());
    }
    EXPECT_LT(norm(run.given[1].pose.position - Vec3{0, 0, 0.53}), 2e-4) << off;
  }
}

// A mesh whose faces have corners of their own.
TEST(Bullet, ACubeOfSeparateFacesIsOneBodyAndAFlatOneWithoutAMassPushes) {
  Scene scene = test::pad_scene();
  const Mesh cube = make_box({0.04, 0.04, 0.04}, 1);
  Mesh apart;
  for (const Triangle& t : cube.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.vertices.size());
    for (const std::uint32_t corner : t) apart.vertices.push_back(cube.vertices[corner]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  scene.objects.push_back(body_of("sheet", cube, 0.1, {0, 0, 0.5}));
  scene.objects[0].mesh = make_plane(0.3, 2);
  scene.objects[0].mechanism.body = {};
  scene.objects.push_back(body_of("cube", cube, 0.1, {0, 0, 0.52}));
  scene.objects[1].mesh = apart;
  World run(scene);
  for (int i = 0; i < 300; ++i) {
    run.given[0].pose.position.z = 0.5 + 1e-4 * i;
    run.advance(no_hand());
  }
  EXPECT_NEAR(run.given[1].pose.position.z, 0.5299 + 0.02, 1e-3);
}

TEST(Bullet, TheGroundsFrictionIsItsOwnThoughBodiesShareNone) {
  Scene scene = test::pad_scene();
  scene.gravity = {3, 0, -9.81};
  scene.ground.emplace(Ground{{0, 0, 1}, 0, 0.8});
  scene.objects.push_back(body_of("cube", make_box({0.04, 0.04, 0.04}, 2), 0.1, {0, 0, 0.02}));
  const Model model = test::model_of(scene);
  BulletWorld world;
  BulletOptions options;
  options.friction = 0;
  ASSERT_TRUE(make_bullet_world(model, options, world).ok());
  std::vector<ObjectFrame> given = start_frames(model);
  for (int i = 0; i < 500; ++i) move_bodies(world, model, given);
  EXPECT_NEAR(given[0].pose.position.x, 0, 1e-3);
}

// Rings of abutting pieces hang in each other; the first is held.
Mesh ring() {
  Mesh mesh;
  constexpr int kPieces = 12;
  constexpr double kRadius = 0.012, kThick = 0.005;
  for (int i = 0; i < kPieces; ++i) {
    const double angle = 2 * 3.141592653589793 * i / kPieces;
    const Quat turn{std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
    const double length = 2 * (kRadius + kThick / 2) * std::tan(3.141592653589793 / kPieces);
    const Mesh piece = make_box({kThick, length, kThick}, 1);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3 v : piece.vertices) mesh.vertices.push_back(rotate(turn, v + Vec3{kRadius, 0, 0}));
    for (const Triangle& t : piece.triangles)
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return mesh;
}

TEST(Bullet, RingsOfAChainHoldEachOther) {
  Scene scene = test::pad_scene();
  for (int i = 0; i < 6; ++i) {
    SceneObject link = test::object_of("link", ring(), {{0, 0, -0.018 * i}, {}}, {0.5, 0.4, 0, 1000});
    const double half = std::sqrt(0.5);
    link.pose.orientation = i % 2 == 0 ? Quat{half, half, 0, 0} : Quat{0.5, 0.5, 0.5, 0.5};
    link.mechanism.mobility = Mobility::given;
    if (i > 0) link.mechanism.body = {0.02, {}, {2e-6, 2e-6, 4e-6, 0, 0, 0}};
    scene.objects.push_back(link);
  }
  World run(scene);
  // A finger pushes the lowest ring aside.
  for (int i = 0; i < 1500; ++i)
    run.advance(test::frame_of({{{-0.06 + 0.00006 * std::min(i, 1200), 0, -0.095}, {-1, 0, 0}}}));
  for (std::size_t i = 1; i < 6; ++i) {
    const double apart = norm(run.given[i].pose.position - run.given[i - 1].pose.position);
    EXPECT_GT(apart, 0.005) << i;
    EXPECT_LT(apart, 0.0205) << i;
  }
  EXPECT_GT(run.given[5].pose.position.x, 0.003);
}

TEST(Bullet, WhatItHasLostIsFlaggedAndForcesFade) {
  World run(stack(1));
  run.model.settings.fade_time = 0.02;
  const DeviceFrame frame = test::frame_of({{{0, 0, 0.0465}, {0, 0, 1}}});
  for (int i = 0; i < 100; ++i) run.advance(frame);
  double before = norm(test::hand_force(run.output));
  EXPECT_GT(before, 0.3);
  run.given[0].pose.position.x = std::nan("");  // as a solver that has failed would say
  for (int i = 0; i < 40; ++i) {
    const ObjectFrame lost = run.given[0];
    run.step(frame, {&lost, 1});
    EXPECT_NE(run.output.flags & kObjectImplausible, 0u);
    const double now = norm(test::hand_force(run.output));
    EXPECT_LE(now, before + 1e-12);
    EXPECT_GE(now, before - 0.1);
    before = now;
  }
  EXPECT_EQ(before, 0);
}

TEST(Bullet, SessionsReplayWithoutIt) {
  const Scene scene = stack(3);
  World run(scene);
  std::vector<TickRecord> records;
  for (int i = 0; i < 300; ++i) {
    TickRecord& record = records.emplace_back();
    record.device = test::frame_of({{{-0.0275 + 0.00002 * i, 0.004, 0.1}, {-1, 0, 0}}});
    record.given_count = 3;
    std::copy(run.given.begin(), run.given.end(), record.given.begin());
    run.advance(record.device);
    record.output = run.output;
    take_results(run.state, run.scratch, record);
  }
  EXPECT_GT(run.given[2].pose.position.x, 0.001);
  const std::string path = test::cleared(test::temporary_path("bullet.mcap"));
  test::write_recording(path, scene, records);
  RecordingReader reader;
  ASSERT_TRUE(reader.open(path).ok());
  ReplayOptions options;
  options.execution.isa = Isa::scalar;
  options.execution.broadphase = Broadphase::brute;
  ReplayResult result;
  const Status status = replay(reader, options, result);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(result.ticks, 300u);
  EXPECT_FALSE(result.first_divergence);
}

TEST(Bullet, WhatItCanNotMoveIsRefusedByName) {
  Scene scene = test::pad_scene();
  SceneObject sheet = test::object_of("sheet", make_plane(0.1, 3), {}, {});
  sheet.mechanism.mobility = Mobility::given;
  sheet.mechanism.body = {0.1, {}, {1e-4, 1e-4, 1e-4, 0, 0, 0}};
  scene.objects.push_back(sheet);
  BulletWorld world;
  EXPECT_NE(make_bullet_world(test::model_of(scene), {}, world).message().find("\"sheet\""),
            std::string::npos);
  scene.objects[0].mechanism.body.mass = -1;
  Model model;
  EXPECT_NE(build_model(scene, {}, model).message().find("\"sheet\": mass"), std::string::npos);
  EXPECT_FALSE(make_bullet_world(test::model_of(stack(1)), {-1}, world).ok());
}

}  // namespace
}  // namespace lumbrical
