// Friction between skin and objects, held against Coulomb.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "largest.h"
#include "pads.h"

namespace lumbrical {
namespace {

using test::largest;
using test::Pad;
using test::Session;

constexpr double kGravity = 9.81, kTick = 1e-3;

Quat about_z(double angle) { return {std::cos(0.5 * angle), 0, 0, std::sin(0.5 * angle)}; }
Quat about_y(double angle) { return {std::cos(0.5 * angle), 0, std::sin(0.5 * angle), 0}; }

// A block of 0.3 kg on four fingertips whose tops are a slope that falls towards +x. They stand so far apart
// that it does not tilt while it slides, and are pressed in as far as they will be.
struct Slope {
  Quat tilt;
  std::vector<Pad> pads;
  explicit Slope(double angle) : tilt(about_y(angle)) {
    const double load = 0.3 * kGravity * std::cos(angle) / 4;
    double pressed = 0.001;
    const auto force = [](double depth) {
      const double r = test::kPadRadius, h = r - depth;
      return 2e7 * 3.141592653589793 * (r * r * r / 3 - r * h * h + 2 * h * h * h / 3);
    };
    for (int i = 0; i < 60; ++i) pressed -= (force(pressed) - load) / 1000;
    for (const double x : {-0.2, 0.2}) {
      for (const double y : {-0.02, 0.02})
        pads.push_back({rotate(tilt, {x, y, -0.025 - test::kPadRadius + pressed}), rotate(tilt, {0, 0, -1})});
    }
  }
};

Scene block_on_pads(double mu_s, double mu_k, Quat tilt) {
  Scene scene = test::pad_scene();
  scene.objects.push_back(
      test::body_of("block", make_box({0.8, 0.06, 0.05}, 4), 0.3, {{0, 0, 0}, tilt}, {mu_s, mu_k, 0, 2000}));
  return scene;
}

TEST(Friction, ABlockSticksBelowTheAngleOfFrictionAndSlidesAboveItAsCoulombSays) {
  const double mu = 0.5;
  for (const double degrees : {10.0, 20.0, 26.0, 27.2, 30.0, 40.0}) {
    const double angle = degrees * 3.141592653589793 / 180;
    const Slope slope(angle);
    Session run(block_on_pads(mu, mu, slope.tilt));
    const DeviceFrame frame = test::frame_of(slope.pads);
    const Vec3 down = rotate(slope.tilt, {1, 0, 0});
    const auto speed = [&] { return dot(down, run.state.objects[0].velocity); };
    for (int i = 0; i < 50; ++i) run.step(frame);
    const double early = speed();
    for (int i = 0; i < 150; ++i) run.step(frame);
    const double acceleration = (speed() - early) / (150 * kTick);
    if (std::tan(angle) < mu) {
      for (int i = 0; i < 3000; ++i)
        run.step(frame);  // it was let go on slack skin, so slides a little first
      EXPECT_LT(std::fabs(speed()), 1e-5) << degrees;
      EXPECT_LT(norm(run.state.objects[0].pose.position), 5e-3) << degrees;
    } else {
      const double expected = kGravity * (std::sin(angle) - mu * std::cos(angle));
      EXPECT_NEAR(acceleration, expected, 0.01 * expected + 0.003) << degrees;
    }
  }
}

TEST(Friction, ABlockThatSticksDoesNotCreep) {
  const Slope slope(0.3);
  Session run(block_on_pads(0.5, 0.4, slope.tilt));
  const DeviceFrame frame = test::frame_of(slope.pads);
  for (int i = 0; i < 2000; ++i) run.step(frame);
  const Pose settled = run.state.objects[0].pose;
  for (int i = 0; i < 20000; ++i) run.step(frame);
  EXPECT_LT(norm(run.state.objects[0].pose.position - settled.position), 1e-7);
}

TEST(Friction, HoldsAMugBetweenThreeFingersForAMinute) {
  Scene scene = test::pad_scene();
  scene.settings.precision = every_segment(1e-4);
  const MugShape shape;
  scene.objects.push_back(test::body_of("mug", make_mug(shape), 0.2, {}, {0.8, 0.6, 0, 1000}));
  Session run(scene);
  std::vector<test::Pad> pads;
  for (const double angle : {2.1, -2.1, 0.6}) {  // the handle is at angle 0
    const Vec3 out{std::cos(angle), std::sin(angle), 0};
    pads.push_back({(shape.radius + test::kPadRadius - 0.002) * out + Vec3{0, 0, 0.05}, out});
  }
  const DeviceFrame frame = test::frame_of(pads);
  for (int i = 0; i < 1000; ++i) run.step(frame);  // the grip settles
  const Pose before = run.state.objects[0].pose;
  for (int i = 0; i < 59000; ++i) run.step(frame);
  const Pose after = run.state.objects[0].pose;
  EXPECT_LT(norm(after.position - before.position), 1e-4);
  EXPECT_LT(test::angle_of(after.orientation * conjugate(before.orientation)), 0.1 * 3.14159 / 180);
  EXPECT_GT(after.position.z, -0.004);  // skin gives way
}

// A fingertip pressed on a plane and turned about the normal until it slips.
TEST(Friction, ATwistedPadSlipsAtMuTimesTheMomentOfItsPressure) {
  const double mu = 0.7;
  for (const bool lying : {false, true}) {
    Scene scene = test::pad_scene();
    scene.objects.push_back(test::object_of("plane", make_plane(0.2, 5), {}, {mu, mu, 0, 20000}));
    Session run(scene);
    // One capsule in the plane z = 0, lying or upright, and its plain sums (contact_patch_test has more of
    // them).
    const double height = test::kPadRadius - 0.002;
    const auto depth = [&](double x, double y) {
      const double beyond = lying ? max(0, std::fabs(x) - 0.01) : std::fabs(x);
      return test::kPadRadius - std::sqrt(beyond * beyond + y * y + height * height);
    };
    double moment = 0;
    const double cell = 5e-5;
    for (int i = -400; i < 400; ++i) {
      for (int j = -200; j < 200; ++j) {
        const double x = (i + 0.5) * cell, y = (j + 0.5) * cell;
        moment += max(0, depth(x, y)) * std::hypot(x, y) * cell * cell;
      }
    }
    double torque = 0;
    for (int i = 0; i < 400; ++i) {
      const double angle = 0.002 * i;
      Pad pad{{0, 0, height}, {0, 0, 1}};
      if (lying)
        pad = {{0.01 * std::cos(angle), 0.01 * std::sin(angle), height},
               {-std::cos(angle), -std::sin(angle), 0}};
      DeviceFrame frame = test::frame_of({pad});
      const auto turn = about_z(angle);
      for (JointPose& joint : frame.joint)
        joint.orientation = {0, 0, static_cast<float>(turn.z), static_cast<float>(turn.w)};
      run.step(frame);
      torque = run.scratch.object_output[0].wrench.torque.z;
    }
    EXPECT_NEAR(torque, mu * 2e7 * moment, 0.02 * torque) << lying;
  }
}

// A fingertip that stands on a plane, turned steadily: skin slides at r times its speed of turning.
TEST(Friction, OfATwistFallsToTheKineticOneToo) {
  const double depth = 0.002, height = test::kPadRadius - depth;
  double volume = 0, moment = 0;
  for (double r = 5e-7; r < test::kPadRadius; r += 1e-6) {
    const double inside = max(0, test::kPadRadius - std::sqrt(r * r + height * height));
    volume += inside * r;
    moment += inside * r * r;
  }
  const double arm = moment / volume, pressed = 2e7 * 2 * 3.141592653589793 * 1e-6 * volume;
  for (const auto& [speed, mu] : {std::pair{1e-3, 0.799}, std::pair{0.02, 0.6}, std::pair{0.6, 0.4}}) {
    Scene scene = test::pad_scene();
    scene.objects.push_back(test::object_of("plane", make_plane(0.2, 5), {}, {0.8, 0.4, 0, 20000}));
    Session run(scene);
    const double turn = speed / arm * kTick;
    const int ticks = static_cast<int>(0.3 / kTick + 1 / turn);
    for (int i = 0; i < ticks; ++i) {
      DeviceFrame frame = test::frame_of({{{0, 0, height}, {0, 0, 1}}});
      const auto now = about_z(turn * i);
      for (JointPose& joint : frame.joint)
        joint.orientation = {0, 0, static_cast<float>(now.z), static_cast<float>(now.w)};
      run.step(frame);
    }
    EXPECT_NEAR(run.scratch.object_output[0].wrench.torque.z, mu * pressed * arm, 0.02 * mu * pressed * arm)
        << speed;
  }
}

TEST(Friction, RollsWithoutDragging) {
  Scene scene = test::pad_scene();
  scene.objects.push_back(test::object_of("plane", make_plane(0.4, 9), {}, {0.8, 0.8, 0, 1000}));
  Session run(scene);
  // A ball of a fingertip rolls along x at the height of its centre, 1 mm below where it would just touch.
  const double height = test::kPadRadius - 0.001;
  double worst = 0, pressed = 0;
  for (int i = 0; i < 2000; ++i) {
    const double x = -0.05 + 5e-5 * i,
                 angle = x / height;  // the patch is as far from the centre as the plane
    const Quat turn = about_y(angle);
    DeviceFrame frame = test::frame_of({{{x, 0, height}, rotate(turn, {0, 1, 0}), 1e-6}});
    for (JointPose& joint : frame.joint)
      joint.orientation = {0, static_cast<float>(turn.y), 0, static_cast<float>(turn.w)};
    run.step(frame);
    const Vec3 force = test::hand_force(run.output);
    worst = largest(worst, std::fabs(force.x));
    pressed = force.z;
  }
  EXPECT_GT(pressed, 0.4);
  EXPECT_LT(worst, 0.02 * pressed);
}

TEST(Friction, BeginsAndEndsWithTheNormalForceAndNeverJumps) {
  Scene scene = test::pad_scene();
  scene.objects.push_back(test::object_of("plane", make_plane(0.2, 5), {}, {0.8, 0.5, 0.5, 1000}));
  Session run(scene);
  Vec3 last;
  double most = 0, pressed = 0, dragged = 0;
  for (int i = 0; i < 4000; ++i) {  // down, along ever faster, up, all smoothly
    const double t = i / 4000.0, down = 0.002 * std::sin(3.14159265 * t) - 0.0002, along = 0.08 * t * t * t;
    run.step(test::frame_of({{{along - 0.04, 0, test::kPadRadius - down}, {0, 0, 1}}}));
    const Vec3 force = test::hand_force(run.output);
    const double friction = std::hypot(force.x, force.y);
    EXPECT_LE(friction, (0.8 + 0.5 * 0.06 + 1e-9) * force.z + 1e-12);
    most = largest(most, norm(force - last));
    pressed = largest(pressed, force.z);
    dragged = largest(dragged, friction);
    last = force;
  }
  EXPECT_EQ(norm(last), 0);
  EXPECT_LT(most, 0.05);  // [N] in a tick, of up to 1.7
  EXPECT_GT(pressed, 1);
  EXPECT_GT(dragged, 0.5 * pressed);
}

// A fingertip pressed with 16 N is drawn along a plane at a steady speed.
struct Drawn {
  double pressed = 0, last = 0, mean = 0;  // [N] then its drag, in the end and of the last half
  double fall = 0, trembling = 0;  // [N] most that the drag falls, and of the last half changes, in a tick
  int slips = 0;
};
Drawn draw(const Material& material, double speed, double rate) {
  Scene scene = test::pad_scene();
  scene.settings.stiffness = 6e7;
  scene.settings.rate = rate;
  scene.objects.push_back(test::object_of("plane", make_plane(2, 1), {}, material));
  Session run(scene);
  Drawn drawn;
  bool falling = false;
  const int ticks = static_cast<int>(2.5 * rate);
  for (int i = 0; i < ticks; ++i) {
    run.step(test::frame_of({{{speed * i / rate, 0, 0.5 * test::kPadRadius}, {0, 0, 1}}}));
    const Vec3 force = test::hand_force(run.output);
    const double fell = drawn.last + force.x;
    drawn.fall = largest(drawn.fall, fell);
    if (2 * i >= ticks) {
      drawn.trembling = largest(drawn.trembling, std::fabs(fell));
      drawn.mean -= force.x / (ticks - ticks / 2);
    }
    if (fell * rate > 10 && !falling) ++drawn.slips;
    falling = fell > 0 && (falling || fell * rate > 10);
    drawn.last = -force.x;
    drawn.pressed = force.z;
  }
  return drawn;
}

// Skin that is let go slides back, and so lets itself go.
TEST(Friction, FallsToTheKineticOneOverItsLagHoweverFarSkinIsDrawn) {
  for (const double shear_stiffness : {200.0, 1000.0}) {
    for (const double speed : {0.05, 0.3}) {
      const Material material{0.8, 0.6, 0, shear_stiffness};
      const Drawn drawn = draw(material, speed, 1000);
      EXPECT_GT(drawn.pressed, 15);
      EXPECT_GE(drawn.slips, 1);
      EXPECT_LT(drawn.fall, 1.05 * 0.2 * drawn.pressed * kTick / 0.03) << shear_stiffness << ", " << speed;
    }
  }
}

TEST(Friction, StillSticksAndSlipsWhereSkinIsDrawnFarAtAnyRate) {
  const Material material{0.8, 0.6, 0, 1000};
  const Drawn slow = draw(material, 0.02, 1000), fast = draw(material, 0.02, 16000);
  EXPECT_GE(slow.slips, 5);
  EXPECT_NEAR(slow.slips, fast.slips, 1);
  EXPECT_NEAR(slow.mean, fast.mean, 0.02 * fast.mean);
  EXPECT_LT(fast.fall, 1.05 * 0.2 * fast.pressed / 16000 / 0.03);
}

TEST(Friction, OfViscousSkinDoesNotTremble) {
  for (const double viscosity : {1.0, 3.0}) {
    for (const double rate : {1000.0, 16000.0}) {
      const Drawn drawn = draw({0.8, 0.6, viscosity, 200}, 0.2, rate);
      EXPECT_NEAR(drawn.last / drawn.pressed, 0.6 + 0.2 / 101 + 0.2 * viscosity, 0.02) << viscosity;
      EXPECT_LT(drawn.trembling, 10 / rate) << viscosity << ", " << rate;
    }
  }
}

// Two fingertips that loosen their grip slowly let go where mu N falls below the weight they carry.
TEST(Friction, HoldsAnObjectUntilTheGripIsTooWeak) {
  const double mu = 0.6;
  Scene scene = test::pad_scene();
  scene.objects.push_back(test::body_of("box", make_box({0.04, 0.04, 0.04}, 6), 0.1, {}, {mu, mu, 0, 1000}));
  Session run(scene);
  const auto hold = [&](double pressed) {
    const double reach = 0.02 + test::kPadRadius - pressed;
    run.step(test::frame_of({{{-reach, 0, 0}, {-1, 0, 0}}, {{reach, 0, 0}, {1, 0, 0}}}));
    return 0.5 * (std::fabs(run.output.segment[2].force.x) + std::fabs(run.output.segment[5].force.x));
  };
  double pressed = 0.003, weakest = 0;
  for (int i = 0; i < 1500; ++i) hold(pressed);
  const double held_at = run.state.objects[0].pose.position.z;
  while (pressed > 0 && run.state.objects[0].velocity.z > -0.01) weakest = hold(pressed -= 5e-8);
  EXPECT_NEAR(weakest, 0.1 * kGravity / (2 * mu), 0.02 * weakest);
  EXPECT_GT(held_at, -0.001);
}

// A strip along x of triangles 0.1 mm wide, 1,000 edges across the way; the half at y > 0 is shifted by a
// third of one, so that all its corners are T-junctions.
Mesh strip_of_edges(bool twice) {
  Mesh mesh;
  constexpr int kCells = 1400;
  constexpr double kWidth = 1e-4;
  const auto add_half = [&](double y0, double y1, double shift) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int i = 0; i <= kCells; ++i)
      for (const double y : {y0, y1}) mesh.vertices.push_back({(i + shift - 0.5 * kCells) * kWidth, y, 0});
    for (std::uint32_t i = 0; i < 2 * kCells; i += 2) {
      mesh.triangles.push_back({first + i, first + i + 2, first + i + 3});
      mesh.triangles.push_back({first + i, first + i + 3, first + i + 1});
    }
  };
  add_half(-0.02, 0, 0);
  add_half(0, 0.02, 1.0 / 3);
  const std::size_t once = mesh.triangles.size();
  for (std::size_t i = 0; twice && i < once; ++i) mesh.triangles.push_back(Triangle(mesh.triangles[i]));
  return mesh;
}

TEST(Friction, SlidesOverAThousandCoplanarEdgesWithoutABump) {
  for (const bool twice : {false, true}) {
    Scene scene = test::pad_scene();
    scene.objects.push_back(test::object_of("strip", strip_of_edges(twice), {}, Material{0.6, 0.6, 0, 1000}));
    Session run(scene);
    Vec3 steady;
    double worst = 0;
    for (int i = 0; i <= 1000; ++i) {
      run.step(test::frame_of({{{-0.05 + 1e-4 * i, 0.0007, test::kPadRadius - 0.002}, {0, 0, 1}}}));
      const Vec3 force = test::hand_force(run.output);
      if (i == 100) steady = force;  // by then it slides
      if (i > 100) worst = largest(worst, norm(force - steady));
    }
    EXPECT_LT(worst, 1e-6 * norm(steady)) << twice;
    EXPECT_NEAR(-steady.x, 0.6 * steady.z, 1e-6 * steady.z);
  }
}

// A slider of 0.1 kg under a fingertip that has just come to touch it: the skin, which is not drawn yet, must
// not take the object along with more than it can hold.
TEST(Friction, OfATouchThatHasJustBegunIsNoMoreThanCoulombs) {
  constexpr double kMu = 0.1;
  for (const double speed : {0.1, 1.0}) {
    for (const double depth : {1e-6, 1e-5, 1e-4}) {
      Scene scene = test::pad_scene();
      scene.gravity = {};
      SceneObject& plate = scene.objects.emplace_back(
          test::body_of("plate", make_box({0.4, 0.1, 0.01}, 4), 0.1, {}, {kMu, kMu, 0, 1000}));
      plate.mechanism.mobility = Mobility::slider;
      plate.mechanism.axis = {1, 0, 0};
      Session run(scene);
      run.state.objects[0].velocity = {speed, 0, 0};
      for (int i = 0; i < 3; ++i) {
        run.step(test::frame_of({{{0, 0, 0.005 + test::kPadRadius - depth}, {0, 0, 1}}}));
        const Vec3 force = test::hand_force(run.output);
        EXPECT_GT(force.z, 0);
        EXPECT_LE(force.x, 1.001 * kMu * force.z) << speed << " m/s, " << depth << " m deep";
        EXPECT_GT(force.x, 0.9 * kMu * force.z) << speed << " m/s, " << depth << " m deep";
      }
    }
  }
}

TEST(Friction, OfTheGroundTakesNoMoreThanCoulombsFromABoxThatComesDownSideways) {
  constexpr double kSpeed = 1, kTime = 0.4;
  for (const double mu : {0.0, 0.1}) {
    for (const double height : {0.0, 1e-4, 0.01}) {
      Scene scene = test::pad_scene();
      scene.ground = Ground{};
      scene.ground->friction = mu;
      scene.objects.push_back(
          test::body_of("box", make_box({0.1, 0.1, 0.02}, 2), 0.2, {{0, 0, 0.01 + height}, {}}, {}));
      Session run(scene);
      ObjectState& box = run.state.objects[0];
      box.velocity = {kSpeed, 0, 0};
      for (int i = 0; i < 400; ++i) run.step(test::frame_of({{{0, 0, 10}}}));
      // What stops its fall, and carries it afterwards.
      const double taken =
          mu * (std::sqrt(2 * kGravity * height) + kGravity * (kTime - std::sqrt(2 * height / kGravity)));
      EXPECT_NEAR(kSpeed - box.velocity.x, taken, 0.1 * taken + 1e-9) << "mu " << mu << ", from " << height;
      EXPECT_NEAR(box.velocity.z, 0, 1e-4);
    }
  }
}

// Where a spot of the surface has no friction at all, nothing of the way over it comes back behind it.
TEST(Friction, ASpotWithoutFrictionIsLikeOneWithHardlyAny) {
  std::vector<Vec3> forces[2];
  for (const double factor : {0.0, 1e-12}) {
    Scene scene = test::pad_scene();
    SceneObject plate = test::object_of("plate", make_plane(0.4, 2), {}, {0.5, 0.4, 1, 1000});
    GreyImage image{8, 1, {}};
    for (int i = 0; i < 8; ++i) image.grey.push_back(i >= 2 && i < 6 ? 0 : 65535);
    plate.surface.grip = {image, 0.16, factor, 1};
    scene.objects.push_back(plate);
    Session run(scene);
    Vec3 at{0.08, -0.05, test::kPadRadius - 0.002};
    const auto go = [&](Vec3 by) {
      at += by;
      run.step(test::frame_of({{at, {0, 0, 1}}}));
      forces[factor > 0].push_back(test::hand_force(run.output));
    };
    for (int i = 0; i < 400; ++i) go({0, 2.5e-4, 0});
    for (int i = 0; i < 400; ++i) go({1e-4, 0, 0});
  }
  double off = 0, most = 0;
  for (std::size_t i = 0; i < forces[0].size(); ++i) {
    off = largest(off, norm(forces[0][i] - forces[1][i]));
    most = largest(most, std::fabs(forces[0][i].x));
  }
  EXPECT_LT(off, 1e-9);
  EXPECT_GT(most, 0.1) << "nothing rubbed";
}

TEST(Friction, ThatMakesNoSenseIsRefusedOfAnObjectThatStandsStill) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](double static_friction, double kinetic_friction, double viscosity,
                          double shear_stiffness) {
    Scene scene;
    scene.hand = default_hand(Side::right);
    scene.objects.push_back({"box", make_box({0.1, 0.1, 0.1}, 1)});
    scene.objects[0].material = {static_friction, kinetic_friction, viscosity, shear_stiffness};
    Model model;
    const Status status = build_model(scene, {}, model);
    return !status.ok() && status.message().find("object \"box\"") != std::string::npos;
  };
  EXPECT_FALSE(refused(0, 0, 0, 1000));
  for (const double wrong : {nan, -0.5}) {
    EXPECT_TRUE(refused(wrong, 0, 0, 1000));
    EXPECT_TRUE(refused(0, wrong, 0, 1000));
    EXPECT_TRUE(refused(0, 0, wrong, 1000));
    EXPECT_TRUE(refused(0, 0, 0, wrong));
  }
  EXPECT_TRUE(refused(0, 5, 0, 1000)) << "slides harder than it sticks";
}

// A finger that leans wholly through a plate: its faces push opposite ways, equally or, by a finger that
// tapers, nearly so, which turns it. The line of action is far away then, or nowhere.
TEST(ObjectsApart, PassOnATorqueWithHardlyAForce) {
  const DeviceFrame frame = test::frame_of({{{-0.8 * 0.03125, 0, -0.6 * 0.03125}, {0.8, 0, 0.6}, 0.0625}});
  const Mesh sheet = make_box({0.2, 0.2, 0.004}, 4);
  for (const double taper : {0.0, 1e-6, 1e-3}) {
    Scene whole = test::pad_scene();
    whole.gravity = {};
    whole.hand.radius[kThumbDistal] = test::kPadRadius * (1 + taper);
    Scene apart = whole, free = whole;
    whole.objects.push_back({"plate", sheet});
    apart.objects.push_back(test::object_of("plate", sheet, {}, {0.5, 0.5, 0, 1000}));
    free.objects.push_back(test::body_of("plate", sheet, 0.1, {}, {}));
    Session one(whole), other(apart), moved(free);
    one.feel(frame);
    other.feel(frame);
    moved.feel(frame);
    const auto turn = [](const Session& run) { return run.output.segment[2].torque.y; };
    EXPECT_LT(turn(one), -0.05);
    EXPECT_NEAR(turn(other), turn(one), 1e-6);
    EXPECT_NEAR(moved.state.objects[0].angular_velocity.y,
                -turn(one) * kTick / free.objects[0].mechanism.body.inertia[1], 1e-3);
  }
}

}  // namespace
}  // namespace lumbrical
