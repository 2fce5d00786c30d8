// Work and energy without friction: what is put in comes back, and nothing is added.
#include <gtest/gtest.h>

#include <cmath>

#include "pads.h"

namespace lumbrical {
namespace {

using test::Pad;
using test::Session;

constexpr double kPi = 3.141592653589793;

// A thing that is felt apart from the world but neither moves nor, as good as, rubs.
Scene still_scene(Mesh mesh) {
  Scene scene = test::pad_scene();
  scene.objects.push_back(test::object_of("still", std::move(mesh), {}, {}));
  scene.objects[0].mechanism.mobility = Mobility::given;
  return scene;
}

/// What a fingertip has taken from what it touches.
struct Work {
  double done = 0, most = 0;  ///< [J]
};

// Round a closed path of as many steps; what is felt is taken as straight from one to the next.
template <class Path>
Work work_round(Session& run, int steps, Vec3 away, const Path& path) {
  const ObjectFrame still{};
  Work work;
  Vec3 last_place, last_force;
  for (int i = 0; i <= steps; ++i) {
    const DeviceFrame frame = test::frame_of({{path(2 * kPi * i / steps), away}});
    const auto& tip = frame.joint[static_cast<std::size_t>(kPhalanxJoints[2].tip)].position;
    run.step(frame, {&still, 1});
    const Vec3 place{tip[0], tip[1], tip[2]}, force = test::hand_force(run.output);
    if (i > 0) work.done += 0.5 * dot(force + last_force, place - last_place);
    work.most = std::max(work.most, std::fabs(work.done));
    last_place = place;
    last_force = force;
  }
  return work;
}

TEST(Energy, AStrokeRoundAClosedPathCostsNoWork) {
  Session run(still_scene(make_sphere(0.03, 16)));
  const auto path = [](double t) {  // deeper and less deep, round and along
    const double reach = 0.03 + test::kPadRadius - 0.002 + 0.001 * std::sin(t);
    const Vec3 way{0.4 * std::cos(t), 0.3 * std::sin(2 * t), 1.0};
    return reach * unit_or(way, {});
  };
  const Work work = work_round(run, 2000, {0, 0, 1}, path);
  EXPECT_GT(work.most, 1e-3);
  EXPECT_LT(std::fabs(work.done), 1e-5 * work.most);
}

// A hole 14 mm square, narrower than the finger: it is pressed all round.
Mesh hole() {
  Mesh mesh;
  for (int side = 0; side < 4; ++side) {
    const double angle = 0.5 * kPi * side;
    const Mesh wall = make_box({0.02, 0.054, 0.06}, 6);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3 v : wall.vertices) {
      const Vec3 p = v + Vec3{0.017, -0.01, 0};
      mesh.vertices.push_back({std::cos(angle) * p.x - std::sin(angle) * p.y,
                               std::sin(angle) * p.x + std::cos(angle) * p.y, p.z});
    }
    for (const Triangle& t : wall.triangles)
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return mesh;
}

TEST(Energy, AFingerWiggledInATightHoleGainsNothing) {
  Scene scene = still_scene(hole());
  scene.objects[0].winding = Winding::as_is;
  Session run(scene);
  const auto wiggle = [](double t) {
    return Vec3{0.0015 * std::sin(3 * t), 0.0012 * std::sin(2 * t + 0.3), 0.002 * std::cos(t)};
  };
  double sum = 0;
  for (int round = 0; round < 3; ++round) {
    const Work work = work_round(run, 2000, {0, 0, 1}, wiggle);
    EXPECT_GT(work.most, 1e-4);
    EXPECT_LT(std::fabs(work.done), 2e-5 * work.most) << round;
    sum += work.done;
  }
  EXPECT_LT(std::fabs(sum), 1e-7);
}

TEST(Energy, ABounceNeverGainsHeight) {
  Scene scene = test::pad_scene();
  const double top = 0.02 + 0.004;  // where the ball would just touch the finger, and above it
  const Pose start{{0, 0, top + test::kPadRadius}, {}};
  scene.objects.push_back(test::body_of("ball", make_sphere(0.02, 10), 0.1, start, {}));
  scene.objects[0].mechanism.mobility = Mobility::slider;  // or it rolls off
  Session run(scene);
  const DeviceFrame frame = test::frame_of({{{-0.01, 0, 0}, {1, 0, 0}}});  // lies along x
  double last_peak = run.state.objects[0].pose.position.z, lowest = 1, before = last_peak;
  int bounces = 0;
  bool rising = false;
  for (int i = 0; i < 1200; ++i) {
    run.step(frame);
    const double z = run.state.objects[0].pose.position.z;
    lowest = std::min(lowest, z);
    if (rising && z < before) {
      EXPECT_LE(before, last_peak) << bounces;
      last_peak = before;
      ++bounces;
    }
    rising = z > before;
    before = z;
  }
  EXPECT_GE(bounces, 2);
  EXPECT_GT(lowest, 0.02);
}

// A body of 0.1 kg that nothing pulls or touches, off the point (0, 0, 0) that its joint, if any, holds.
Scene turning_scene(Mobility mobility, Vec3 size, double rate) {
  Scene scene = test::pad_scene();
  scene.gravity = {};
  scene.settings.rate = rate;
  scene.objects.push_back(test::body_of("body", make_box(size, 1), 0.1, {{0.06, 0, -0.08}, {}}, {}));
  scene.objects[0].mechanism.mobility = mobility;
  return scene;
}

// As it turns about that point or, free, about its centre of mass; boxes have no products of inertia.
struct Turning {
  double energy = 0;  // [J]
  Vec3 momentum;      // [kg m^2/s]
};
Turning turning_of(const Session& run) {
  const ObjectState& state = run.state.objects[0];
  const Mechanism& mechanism = run.model.apart[0].mechanism;
  const auto& inertia = mechanism.body.inertia;
  const Vec3 spin = state.angular_velocity, own = rotate(conjugate(state.pose.orientation), spin);
  const bool held = mechanism.mobility != Mobility::free;
  const Vec3 arm = held ? transform(state.pose, mechanism.body.centre) : Vec3{};
  const Vec3 about_centre{inertia[0] * own.x, inertia[1] * own.y, inertia[2] * own.z};
  const Vec3 momentum =
      rotate(state.pose.orientation, about_centre) + mechanism.body.mass * cross(arm, cross(spin, arm));
  return {0.5 * dot(spin, momentum), momentum};
}

void run_apart_from_the_hand(Session& run, int ticks) {
  for (int i = 0; i < ticks; ++i) run.step(test::frame_of({{{0, 0, 10}}}));
}

TEST(Energy, OfABodyThatTurnsByItselfNeverGrowsHoweverFast) {
  for (const Mobility mobility : {Mobility::free, Mobility::ball}) {
    for (const double speed : {10.0, 300.0, 1000.0, 10000.0}) {
      for (const Vec3 way : {Vec3{0.1, 1, 0.05}, {1, -0.7, 0.3}, {0.2, 0.1, -1}}) {
        Session run(turning_scene(mobility, {0.1, 0.06, 0.01}, 1000));
        run.state.objects[0].angular_velocity = speed * way;
        double last = turning_of(run).energy;
        for (int i = 0; i < 200; ++i) {
          run_apart_from_the_hand(run, 1);
          const double now = turning_of(run).energy;
          ASSERT_LE(now, last * (1 + 1e-12)) << speed << " rad/s, tick " << i;
          last = now;
        }
      }
    }
  }
}

TEST(Energy, OfABodyOnABallIsKeptWithItsAngularMomentum) {
  Session run(turning_scene(Mobility::ball, {0.02, 0.02, 0.02}, 10000));
  run.state.objects[0].angular_velocity = {0, 0, 11};
  const Turning first = turning_of(run);
  for (int part = 0; part < 5; ++part) {
    run_apart_from_the_hand(run, 1000);
    const Turning now = turning_of(run);
    EXPECT_LT(norm(now.momentum - first.momentum), 0.003 * norm(first.momentum)) << part;
    EXPECT_NEAR(now.energy, first.energy, 0.005 * first.energy) << part;
  }
}

TEST(Energy, OfAHingeIsKeptHoweverFarItsCentreOfMassIsFromItsAxis) {
  Session run(turning_scene(Mobility::hinge, {0.02, 0.02, 0.02}, 1000));
  run.state.objects[0].angular_velocity = 100 * run.model.apart[0].mechanism.axis;
  const double first = turning_of(run).energy;
  run_apart_from_the_hand(run, 2000);
  EXPECT_NEAR(turning_of(run).energy, first, 1e-9 * first);
}

// Wherever between two detents it is let go, and however light it is.
TEST(Energy, OfWhatDetentsHoldNeverGrows) {
  constexpr double kForce = 5, kPitch = 0.001, kTurn = 2 * kPi / kPitch;
  for (const double mass : {0.1, 0.01, 0.001}) {
    Scene scene = test::pad_scene();
    scene.gravity = {};
    scene.objects.push_back(test::body_of("key", make_box({0.02, 0.02, 0.005}, 2), mass, {}, {}));
    Mechanism& key = scene.objects[0].mechanism;
    key.mobility = Mobility::slider;
    key.detent_force = kForce;
    key.detent_pitch = kPitch;
    Session run(scene);
    const auto energy = [&](double q, double speed) {
      return 0.5 * mass * speed * speed + kForce / kTurn * (1 - std::cos(kTurn * q));
    };
    for (int start = 0; start < 50; ++start) {
      ObjectState& state = run.state.objects[0] = {};
      state.coordinate = state.pose.position.z = kPitch * start / 50;
      double before = energy(state.coordinate, 0);
      for (int i = 0; i < 100; ++i) {
        run.step(test::frame_of({{{0, 0, 10}}}));
        const double now = energy(state.coordinate, state.velocity.z);
        EXPECT_LE(now, before + 1e-9 * kForce / kTurn) << mass << " kg, from " << start;
        before = now;
      }
    }
  }
}

}  // namespace
}  // namespace lumbrical
