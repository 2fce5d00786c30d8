// The rungs of samples as a hand moves: no steps, the same however a plane is cut, and no work on the way
// round and back.
#include <gtest/gtest.h>

#include <numbers>

#include "frame_joints.h"
#include "largest.h"
#include "pressed_hand.h"
#include "sampled_hand.h"

namespace lumbrical::test {
namespace {

constexpr double kPrecisions[] = {1e-3, 1e-4, 1e-5};
constexpr double kStiffness = 2e7;  // [N/m^3] of Settings

Vec3 joint_of(const Hand& hand, const DeviceFrame& frame, std::size_t joint) {
  return posed_joints(hand, frame)[joint].position;
}

// |F after - F before| <= K_s A d, A the area touched: phi changes by no more than d. Rounding gets a share
// of 1e-5.
struct Walk {
  double worst = 0;  // step, as a share of what is allowed
  double size = 0;   // [N] the largest force
};
template <class Move>
Walk walk(const Scene& scene, double precision, const DeviceFrame& start, int steps, double step,
          const Move& move) {
  FeelingHand hand(scene, precision), exact(scene, 0);
  Walk result;
  Vec3 before;
  double area = 0;
  for (int i = 0; i <= steps; ++i) {
    DeviceFrame frame = start;
    move(frame, i * step);
    if (i % 20 == 0) {
      exact(frame);
      area = 1.1 * exact.contact_area() + 2e-5;  // until it is asked again
    }
    const ActuatorFrame felt = hand(frame);
    const Vec3 force = total_force(felt);
    const double allowed = kStiffness * area * step + 1e-5 * force_size(felt);
    if (i > 0) result.worst = largest(result.worst, norm(force - before) / allowed);
    result.size = largest(result.size, force_size(felt));
    before = force;
  }
  return result;
}

std::vector<Mesh> surfaces() {
  return {make_plane(0.2, 60, 1, 3), make_plane(0.3, 1), make_height_field(0.3, 69, 0.002, 0.04),
          make_plane(0.16, 200, 0.7, 5)};
}

TEST(SampledContinuity, SlidingByMicrometresMovesForcesNoFasterThanTheirAreaAllows) {
  for (const Mesh& mesh : surfaces()) {
    const Scene scene = sampled_scene(default_hand(Side::right), {{"mesh", mesh}});
    Random random(21);
    for (const double precision : kPrecisions) {
      for (const double flexion : {0.1, 0.6}) {
        const DeviceFrame start =
            dropped_hand(scene.hand, random, flexion - 0.1, flexion + 0.1, 0.1, 0.006, 0.02);
        const Vec3 direction = unit_or(Vec3{random.between(-1, 1), random.between(-1, 1), 0.05}, {});
        const Walk slide = walk(scene, precision, start, 400, 1e-6,
                                [&](DeviceFrame& frame, double way) { move(frame, way * direction); });
        EXPECT_GT(slide.size, 0.1);
        EXPECT_LE(slide.worst, 1) << mesh.triangles.size() << " at " << precision;
      }
    }
  }
}

// Also what fingers and palm hold together, where the deepest one takes over from another.
TEST(SampledContinuity, WhatIsFeltOnceMovesNoFasterEither) {
  Scene scene = sampled_scene(default_hand(Side::right), {{"mesh", make_plane(0.2, 60, 1, 3)}});
  scene.settings.felt_once = FeltOnce::always;
  const Vec3 direction = unit_or(Vec3{0.6, -0.8, 0.1}, {});
  for (const double precision : {0.0, 1e-4}) {
    const Walk slide = walk(scene, precision, pressed_frame(scene.hand, 0.004, 0.3), 200, 5e-6,
                            [&](DeviceFrame& frame, double way) { move(frame, way * direction); });
    EXPECT_GT(slide.size, 1);
    EXPECT_LE(slide.worst, 1) << precision;
  }
}

// Farther, through many triangles.
TEST(SampledContinuity, SlidingFartherMovesForcesNoFasterThanTheirAreaAllows) {
  for (const Mesh& mesh : surfaces()) {
    const Scene scene = sampled_scene(default_hand(Side::right), {{"mesh", mesh}});
    Random random(22);
    for (const double precision : kPrecisions) {
      const DeviceFrame start = dropped_hand(scene.hand, random, 0.1, 0.5, 0.1, 0.004, 0.02);
      const Vec3 direction = unit_or(Vec3{random.between(-1, 1), random.between(-1, 1), -0.1}, {});
      const Walk slide = walk(scene, precision, start, 400, 2e-5,
                              [&](DeviceFrame& frame, double way) { move(frame, way * direction); });
      EXPECT_GT(slide.size, 0.1);
      EXPECT_LE(slide.worst, 1) << mesh.triangles.size() << " at " << precision;
    }
  }
}

// All fingers bend at all joints; no skin moves faster than the sum of the joints' arms.
TEST(SampledContinuity, BendingMovesForcesNoFasterThanTheirAreaAllows) {
  constexpr double kFarthest = 3 * 0.12;  // [m] of the skin from three joints that turn at once
  for (const Mesh& mesh : surfaces()) {
    const Scene scene = sampled_scene(default_hand(Side::right), {{"mesh", mesh}});
    Random random(23);
    for (const double precision : kPrecisions) {
      const DeviceFrame start = dropped_hand(scene.hand, random, 0.1, 0.5, 0.1, 0.004, 0.01);
      const Walk bend =
          walk(scene, precision, start, 400, 2e-4 * kFarthest, [&](DeviceFrame& frame, double way) {
            for (std::size_t i = 0; i < kAngleCount; ++i) {
              if (i % 4 != 0) frame.angle[i] += static_cast<float>(way / kFarthest);
            }
          });
      EXPECT_GT(bend.size, 0.1);
      EXPECT_LE(bend.worst, 1) << mesh.triangles.size() << " at " << precision;
    }
  }
}

// Down through z = 0 in steps down to a picometre, one joint after the other.
TEST(SampledContinuity, AJointThatPassesThroughATrianglesPlaneMakesNoStep) {
  for (const Mesh& mesh : {make_plane(0.3, 6), make_plane(0.3, 40, 0.5, 2)}) {
    const Scene scene = sampled_scene(default_hand(Side::right), {{"plane", mesh}});
    for (const double precision : kPrecisions) {
      FeelingHand hand(scene, precision);
      DeviceFrame frame = pressed_frame(scene.hand, 0.001, 0);
      for (std::size_t k = 0; k < kAngleCount; ++k) frame.angle[k] = k % 4 == 0 ? 0.0f : 0.4f;
      for (const std::size_t joint : {kIndexProximal, kIndexIntermediate, kMiddleDistal, kLittleTip}) {
        const double height = joint_of(scene.hand, frame, joint).z;
        Vec3 before;
        double last = 0;
        for (const double z : {-1e-6, -1e-9, -1e-10, -1e-11, -1e-12, 0.0, 1e-12, 1e-11, 1e-10, 1e-9, 1e-6}) {
          DeviceFrame now = frame;
          now.base.position.z += z - height;
          const ActuatorFrame felt = hand(now);
          const double allowed = kStiffness * 0.02 * (z - last) + 1e-5 * force_size(felt);
          if (z > -1e-6) {
            EXPECT_LE(norm(total_force(felt) - before), allowed)
                << joint_name(static_cast<int>(joint)) << " " << z;
          }
          before = total_force(felt);
          last = z;
        }
      }
    }
  }
}

// ---- The same plane, cut in other ways ----

std::vector<Mesh> planes() {
  Mesh needles = make_plane(0.3, 120, 0.5, 7);
  for (Vec3& vertex : needles.vertices) vertex.y *= 6;
  return {make_plane(0.3, 1),
          make_plane(0.3, 7, 0.8, 2),
          make_plane(0.3, 31, 1, 3),
          make_plane(0.3, 60, 0, 1),
          make_plane(0.3, 90, 0.6, 4),
          make_plane(0.3, 150, 1, 5),
          needles};
}

TEST(SampledRung, FeelsTheSamePlaneHoweverItIsCut) {
  const Hand hand = default_hand(Side::right);
  Random random(27);
  std::vector<DeviceFrame> frames;
  for (int i = 0; i < 20; ++i)
    frames.push_back(dropped_hand(hand, random, -0.1, i % 2 == 0 ? 0.2 : 0.5, 0.15, 0.005, 0.01));
  const std::vector<Mesh> all = planes();
  for (const double precision : kPrecisions) {
    std::vector<Vec3> first;
    for (const Mesh& mesh : all) {
      FeelingHand felt(sampled_scene(hand, {{"plane", mesh}}), precision);
      for (std::size_t i = 0; i < frames.size(); ++i) {
        const ActuatorFrame forces = felt(frames[i]);
        if (first.size() < frames.size()) first.push_back(total_force(forces));
        EXPECT_LE(norm(total_force(forces) - first[i]), 2 * precision * std::max(force_size(forces), 0.5))
            << mesh.triangles.size() << " at " << precision;
      }
    }
  }
}

// ---- Work ----

// Once round a closed path: along it F v dt, and the torque about the base where the hand turns.
struct Work {
  double done = 0, largest = 0, length = 0;
  [[nodiscard]] double share() const { return std::fabs(done) / (largest * length); }
};
Vec3 torque_about(const HandForces& forces, const Hand& hand, const DeviceFrame& frame, Vec3 point) {
  Vec3 torque;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const std::size_t joint = i == kPalmSegment ? std::size_t{kWrist} : std::size_t{kPhalanxJoints[i].base};
    const Wrench& felt = forces.segment[i];
    torque += felt.torque + cross(joint_of(hand, frame, joint) - point, felt.force);
  }
  return torque;
}
Work work_round(FeelingHand& hand, const DeviceFrame& start, Vec3 one, Vec3 other, Vec3 spin) {
  constexpr int kNodes = 1500;
  Work work;
  for (int i = 0; i < kNodes; ++i) {
    const double t = 2 * std::numbers::pi * i / kNodes, dt = 2 * std::numbers::pi / kNodes;
    DeviceFrame frame = start;
    move(frame, std::cos(t) * one + std::sin(t) * other);
    const double angle = norm(spin) * std::sin(t);
    frame.base.orientation = normalized(turned(unit_or(spin, {1, 0, 0}), angle) * start.base.orientation);
    const Vec3 velocity = std::cos(t) * other - std::sin(t) * one, turn = std::cos(t) * spin;
    const ActuatorFrame felt = hand(frame);
    const Vec3 force = total_force(felt);
    work.done += dt * (dot(force, velocity) +
                       dot(torque_about(felt, hand.model().hand, frame, frame.base.position), turn));
    work.largest = largest(work.largest, norm(force));
    work.length += dt * norm(velocity);
  }
  return work;
}

TEST(SampledWork, ALoopOverTheEdgeOfAClosedMeshCostsNoneWithinThePrecision) {
  Mesh box = make_box({0.06, 0.06, 0.05}, 9);
  move(box, {0, 0, -0.025});
  const Scene scene = sampled_scene(default_hand(Side::right), {{"box", box}});
  Random random(29);
  for (int round = 0; round < 4; ++round) {
    DeviceFrame frame = dropped_hand(scene.hand, random, 0.1, 0.5, 0.1, 0, 0);
    const Vec3 tip = joint_of(scene.hand, frame, kMiddleTip);
    // A fingertip over the edge x = 0.03, in and out.
    move(frame, Vec3{0.03, 0, scene.hand.radius[kMiddleTip] - 0.002} - tip);
    const Vec3 one{0.012, 0.004, 0}, other{0, 0.003, 0.004}, spin{0, round % 2 == 0 ? 0.0 : 0.1, 0};
    FeelingHand exact(scene, 0);
    const Work none = work_round(exact, frame, one, other, spin);
    EXPECT_GT(none.largest, 0.3);
    EXPECT_LT(none.share(), 2e-6);  // of the sum over nodes
    for (const double precision : kPrecisions) {
      FeelingHand hand(scene, precision);
      const Work work = work_round(hand, frame, one, other, spin);
      EXPECT_LT(work.share(), precision) << round;
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
