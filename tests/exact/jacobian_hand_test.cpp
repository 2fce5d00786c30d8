// The Jacobian of a hand's segments: what ticks of a moved hand say, the same bits everywhere, and what it
// does not give.
#include "lumbrical/jacobian.h"

#include <gtest/gtest.h>

#include <cmath>

#include "golden/golden_sessions.h"
#include "largest.h"
#include "matrix6.h"
#include "model/primitive.h"
#include "pads.h"
#include "posed_finger.h"
#include "random.h"

namespace lumbrical {
namespace {

using test::kAxes;
using test::times;
using Jacobians = std::array<SegmentJacobian, kSegmentCount>;

struct Session {
  Model model;
  State state;
  Scratch scratch;
  explicit Session(const Scene& scene, const Execution& execution = {})
      : model(test::model_of(scene, execution)), scratch(make_scratch(model)) {}
  ActuatorFrame operator()(const DeviceFrame& frame) { return tick(model, state, scratch, frame); }
};

Scene grasp_scene() {
  Scene scene = test::mug_scene(Law::field);
  scene.settings.fade_time = 0;
  scene.settings.max_force = 1e6;
  return scene;
}

// One radius per finger: neighbours share out space along planes everywhere, as the Jacobian takes it.
Scene even_scene() {
  Scene scene = grasp_scene();
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    const auto [base, tip] = kPhalanxJoints[i];
    scene.hand.radius[tip] = scene.hand.radius[base];
  }
  return scene;
}

Jacobians jacobians_of(Session& session) {
  Jacobians jacobians;
  segment_jacobians(session.model, session.scratch, jacobians);
  return jacobians;
}

// A hand pressed flat on bumps: every segment and the palm touch.
DeviceFrame flat_hand(const Hand& hand, double height) {
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  frame.base = {{0.01, -0.02, height + hand.palm.height}, {std::sqrt(0.5), std::sqrt(0.5), 0, 0}};
  return frame;
}

// Central differences of ticks against what the Jacobians say, segment by segment; counts those that touch.
struct Change {
  std::array<Wrench, kSegmentCount> said, seen;
  std::array<double, kSegmentCount> scale{};  // [N/m] the largest change of a force
};

Change change_of(Session& session, const DeviceFrame& frame, test::Random& random) {
  session(frame);
  const Jacobians jacobians = jacobians_of(session);
  const auto joints = session.scratch.primitives->base_joint;
  const Vec3 translation = random.direction(), rotation = 20 * random.direction();
  const double step = 2e-8;
  const auto ahead_by = [&](double by) {
    DeviceFrame next = frame;
    next.base = test::turn_about(joints[kPalmSegment], by * translation, by * rotation) * frame.base;
    next.base.orientation = normalized(next.base.orientation);
    return session(next);
  };
  const ActuatorFrame ahead = ahead_by(step), behind = ahead_by(-step);
  Change change;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    EXPECT_TRUE(jacobians[i].known);
    const Vec3 own = translation + cross(rotation, joints[i] - joints[kPalmSegment]);
    change.said[i] = times(jacobians[i].value, own, rotation);
    change.seen[i] = {(ahead.segment[i].force - behind.segment[i].force) / (2 * step),
                      (ahead.segment[i].torque - behind.segment[i].torque) / (2 * step)};
    for (const auto& row : jacobians[i].value) {
      for (std::size_t k = 0; k < 3; ++k) change.scale[i] = test::largest(change.scale[i], std::fabs(row[k]));
    }
  }
  return change;
}

void compare_with_ticks(Session& session, const DeviceFrame& frame, test::Random& random,
                        std::array<int, kSegmentCount>& touches) {
  const Change change = change_of(session, frame, random);
  double scale = 0;
  for (const double one : change.scale) scale = test::largest(scale, one);
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const Wrench &said = change.said[i], &seen = change.seen[i];
    EXPECT_LE(norm(said.force - seen.force), 1e-7 * scale) << segment_name(static_cast<int>(i));
    EXPECT_LE(norm(said.torque - seen.torque), 1e-8 * scale) << segment_name(static_cast<int>(i));
    touches[i] += change.scale[i] > 0 ? 1 : 0;
  }
}

TEST(HandJacobian, PredictsHowTicksOfAMovedHandChange) {
  test::Random random(9);
  std::array<int, kSegmentCount> touches{};
  Session grasp(even_scene());
  for (const DeviceFrame& frame : test::grasp_frames(grasp.model.hand, 12)) {
    compare_with_ticks(grasp, frame, random, touches);
  }
  Scene bumps = even_scene();
  bumps.objects = {{"bumps", make_height_field(0.5, 60, 0.002, 0.03)}};
  Session flat(bumps);
  for (const double height : {-0.004, -0.002, 0.0, 0.002}) {
    compare_with_ticks(flat, flat_hand(flat.model.hand, height), random, touches);
  }
  for (std::size_t i = 1; i < kSegmentCount; ++i)
    EXPECT_GT(touches[i], 1) << segment_name(static_cast<int>(i));
}

// Where radii differ the borders are curved (docs/mechanics.md).
TEST(HandJacobian, FingersOfAnyRadiiChangeAsItSays) {
  test::Random random(9);
  Session grasp(grasp_scene());
  double worst = 0;
  int touches = 0;
  for (const DeviceFrame& frame : test::grasp_frames(grasp.model.hand, 12)) {
    const Change change = change_of(grasp, frame, random);
    for (std::size_t i = 0; i < kPhalanxCount; ++i) {
      if (change.scale[i] == 0) continue;
      worst = test::largest(worst, norm(change.said[i].force - change.seen[i].force) / change.scale[i]);
      ++touches;
    }
  }
  EXPECT_GT(touches, 30);
  EXPECT_LT(worst, 1e-5);
}

TEST(HandJacobian, HasTheSameBitsEverywhere) {
  for (const Execution& execution :
       {Execution{}, Execution{Broadphase::brute, 0, 8, 1}, Execution{Broadphase::tree, 1, 3, 3}}) {
    const std::uint64_t hash = test::hash_jacobians(execution);
    EXPECT_EQ(hash, test::golden_hash("jacobians")) << "0x" << std::hex << hash;
  }
}

void expect_no_change_along_xy(const SegmentJacobian& jacobian) {
  const double stiffness = -times(jacobian.value, kAxes[2], {}).force.z;
  EXPECT_GT(stiffness, 100);
  for (const Vec3 along : {kAxes[0], kAxes[1]}) {
    const Wrench change = times(jacobian.value, along, {});
    EXPECT_LT(norm(change.force), 1e-9 * stiffness);
    EXPECT_LT(norm(change.torque), 1e-11 * stiffness);
  }
  // Nor does turning about the plane's normal change any force.
  EXPECT_LT(norm(times(jacobian.value, {}, kAxes[2]).force), 1e-11 * stiffness);
}

TEST(HandJacobian, FingerThatSlidesAlongAPlaneFeelsNoChangeInAnySegment) {
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = test::plain_hand(0.008);
  scene.settings.fade_time = 0;
  scene.objects.push_back({"plane", make_plane(0.4, 25, 1)});
  Session session(scene);
  session(test::finger_frame(
      {Vec3{0.001, 0.002, 0.005}, {0.04, 0.004, 0.006}, {0.063, 0.001, 0.004}, {0.08, 0, 0.002}}));
  const Jacobians jacobians = jacobians_of(session);
  for (std::size_t i = 3; i < 6; ++i) {
    SCOPED_TRACE(i);
    expect_no_change_along_xy(jacobians[i]);
  }
}

// Which of two triangles then has the border between two segments is rounding's choice, but not how much
// there is of it.
TEST(HandJacobian, FeelsNoChangeWhereAnEdgeOfThePlaneLiesExactlyUnderAJoint) {
  constexpr double kRadius = 0.0078125, kJoint = 3 * kRadius, kFar = 16 * kRadius;
  Mesh plane;
  for (const double x : {-kFar, kJoint, kFar}) {
    plane.vertices.push_back({x, -kFar, 0});
    plane.vertices.push_back({x, kFar, 0});
  }
  plane.triangles = {{0, 2, 3}, {0, 3, 1}, {2, 4, 5}, {2, 5, 3}};
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = test::plain_hand(kRadius);
  scene.settings.fade_time = 0;
  scene.objects.push_back({"plane", plane});
  Session session(scene);
  const double z = kRadius / 2;
  session(test::finger_frame({Vec3{0, 0, z}, {kJoint, 0, z}, {2 * kJoint, 0, z}, {3 * kJoint, 0, z}}));
  const Jacobians jacobians = jacobians_of(session);
  for (std::size_t i = 3; i < 6; ++i) {
    SCOPED_TRACE(i);
    EXPECT_TRUE(jacobians[i].known);
    expect_no_change_along_xy(jacobians[i]);
  }
}

TEST(HandJacobian, SaysWhichSegmentsItDoesNotKnow) {
  Scene scene = grasp_scene();
  scene.settings.law.fill(Law::max_depth);
  scene.settings.law[4] = scene.settings.law[5] = scene.settings.law[8] = Law::field;
  Session session(scene);
  double known = 0;
  for (const DeviceFrame& frame : test::grasp_frames(scene.hand, 10)) {
    session(frame);
    const Jacobians jacobians = jacobians_of(session);
    for (std::size_t i = 0; i < kSegmentCount; ++i) {
      EXPECT_EQ(jacobians[i].known, i == 4 || i == 5 || i == 8);
      double sum = 0;
      for (const auto& row : jacobians[i].value) {
        for (const double entry : row) sum += std::fabs(entry);
      }
      if (!jacobians[i].known) {
        EXPECT_EQ(sum, 0);
      }
      known += sum;
    }
  }
  EXPECT_GT(known, 0);
}

TEST(HandJacobian, IsUnknownWhereThereWereMorePairsThanRoom) {
  Scene scene = grasp_scene();
  scene.settings.max_candidates = 10;
  Session session(scene);
  const ActuatorFrame output = session(test::grasp_frames(session.model.hand, 10)[8]);
  ASSERT_NE(output.flags & kCandidateOverflow, 0u);
  for (const SegmentJacobian& jacobian : jacobians_of(session)) {
    EXPECT_FALSE(jacobian.known);
    EXPECT_EQ(jacobian.value, Matrix6{});
  }
}

// Who asks for records then makes what does not fit into nothing, which is no Jacobian of zero.
TEST(HandJacobian, StaysUnknownForWantOfRoomWhenRecordsOfContactsAreAskedFor) {
  Scene scene = grasp_scene();
  scene.settings.max_candidates = 10;
  scene.settings.precision.fill(0);
  scene.settings.precision[kPalmSegment] = 1e-4;
  Session session(scene);
  const ActuatorFrame output = session(test::grasp_frames(session.model.hand, 10)[8]);
  ASSERT_NE(output.flags & kCandidateOverflow, 0u);
  find_contacts(session.model, session.scratch);
  const Jacobians jacobians = jacobians_of(session);
  for (std::size_t i = 0; i < kPhalanxCount; ++i) EXPECT_FALSE(jacobians[i].known) << i;
}

TEST(HandJacobian, IsZeroWhereTheFrameCannotBeTrusted) {
  Session session(grasp_scene());
  DeviceFrame frame = test::grasp_frames(session.model.hand, 10)[8];
  session(frame);
  frame.flags |= kTrackingLost;
  session(frame);
  const Jacobians jacobians = jacobians_of(session);
  for (const SegmentJacobian& jacobian : jacobians) {
    EXPECT_TRUE(jacobian.known);
    EXPECT_EQ(jacobian.value, Matrix6{});
  }
}

// Where such a joint is its place may be anything.
TEST(HandJacobian, BySamplesDoesNotAskWhereJointsAreThatAreNotTracked) {
  Scene scene = test::pad_scene();
  scene.settings.precision.fill(1e-4);
  scene.objects.push_back({"plane", make_plane(1, 100)});
  const Model model = test::model_of(scene);
  DeviceFrame frame = test::frame_of({{{0.3, 0.2, 0.007}, {0, 0, 1}}});
  std::array<SegmentJacobian, kSegmentCount> jacobian[2];
  for (int i = 0; i < 2; ++i) {
    State state;
    Scratch scratch = make_scratch(model);
    if (i == 1) frame.joint[kPhalanxJoints[0].base].position = {-3, 40, 1e6f};
    tick(model, state, scratch, frame);
    segment_jacobians(model, scratch, jacobian[i], 1u << 2);
  }
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column < 6; ++column)
      EXPECT_EQ(jacobian[0][2].value[row][column], jacobian[1][2].value[row][column]) << row << column;
  }
  EXPECT_LT(jacobian[0][2].value[2][2], -500);
}

}  // namespace
}  // namespace lumbrical
