// The Jacobian of exact segments over random grasps of worlds of all sizes of triangles, against central
// differences of ticks.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "largest.h"
#include "lumbrical/jacobian.h"
#include "matrix6.h"
#include "model/primitive.h"
#include "random.h"
#include "session.h"

namespace lumbrical {
namespace {

using test::kAxes;
using Jacobians = std::array<SegmentJacobian, kSegmentCount>;

constexpr double kLength = 0.008;  // [m] at which rotations and torques are measured

// Segments whose Jacobian has no larger entry are left out [N/m]: differences of ticks tell nothing of them.
constexpr double kLeast = 1e-3;

std::size_t grasps() {
  const char* wanted = std::getenv("LUMBRICAL_GRASPS");
  return wanted == nullptr ? 20 : static_cast<std::size_t>(std::atoll(wanted));
}

struct World {
  const char* name;
  Mesh mesh;
};

std::vector<World> worlds() {
  return {{"two triangles", make_plane(0.4, 1)},
          {"box of twelve triangles", make_box({0.06, 0.08, 0.05}, 1)},
          {"box", make_box({0.06, 0.08, 0.05}, 6)},
          {"sphere", make_sphere(0.04, 6)},
          {"field", make_height_field(0.4, 69, 0.002, 0.04)},
          {"coarse field", make_height_field(0.4, 9, 0.01, 0.1)},
          {"mug", make_mug({})}};
}

// All angles anywhere within their limits, some joint's sphere pressed into the surface.
DeviceFrame random_grasp(const Hand& hand, const Mesh& mesh, test::Random& random) {
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  std::array<double, kAngleCount> angles;
  for (std::size_t i = 0; i < kAngleCount; ++i) {
    const AngleLimit& limit = hand.finger[i / 4].limit[i % 4];
    frame.angle[i] = static_cast<float>(random.between(limit.lower, limit.upper));
    angles[i] = static_cast<double>(frame.angle[i]);
  }
  frame.base.orientation = random.rotation();
  std::array<Pose, kJointCount> X_WJ;
  forward_kinematics(hand, frame.base, angles, X_WJ);
  const std::size_t joint = kThumbMetacarpal + random.below(kJointCount - kThumbMetacarpal);
  const Triangle& t = mesh.triangles[random.below(mesh.triangles.size())];
  const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
  const double s = random.between(0, 1), u = random.between(0, 1 - s);
  const Vec3 out = unit_or(cross(b - a, c - a), {});
  frame.base.position = a + s * (b - a) + u * (c - a) + random.between(-0.3, 1) * hand.radius[joint] * out -
                        X_WJ[joint].position;
  return frame;
}

struct Session {
  Model model;
  State state;
  Scratch scratch;
  Session(const Hand& hand, const Mesh& mesh) {
    Scene scene;
    scene.hand = hand;
    scene.settings.precision.fill(0);
    scene.settings.fade_time = 0;
    scene.settings.max_force = 1e6;
    scene.objects = {{"world", mesh}};
    model = test::model_of(scene);
    scratch = make_scratch(model);
  }
};

// Central differences of ticks of a hand that moves as a whole, about each segment's own joint.
std::array<Matrix6, kSegmentCount> differences(Session& session, const DeviceFrame& frame,
                                               const std::array<Vec3, kSegmentCount>& joints, double step) {
  const Vec3 pivot = joints[kPalmSegment];
  std::array<std::array<Vec3, 6>, kSegmentCount> force, torque;
  for (std::size_t k = 0; k < 6; ++k) {
    const double h = k < 3 ? step : step / kLength;
    ActuatorFrame side[2];
    for (const int i : {0, 1}) {
      const Vec3 by = (i == 0 ? -h : h) * kAxes[k % 3];
      const Pose move = k < 3 ? test::turn_about(pivot, by, {}) : test::turn_about(pivot, {}, by);
      DeviceFrame next = frame;
      next.base = move * frame.base;
      next.base.orientation = normalized(next.base.orientation);
      side[i] = tick(session.model, session.state, session.scratch, next);
    }
    for (std::size_t i = 0; i < kSegmentCount; ++i) {
      force[i][k] = (side[1].segment[i].force - side[0].segment[i].force) / (2 * h);
      torque[i][k] = (side[1].segment[i].torque - side[0].segment[i].torque) / (2 * h);
    }
  }
  std::array<Matrix6, kSegmentCount> value;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    // A turn about the segment's own joint is one about the pivot and a shift of it.
    const Vec3 arm = pivot - joints[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 shift = cross(kAxes[k], arm);
      force[i][3 + k] += shift.x * force[i][0] + shift.y * force[i][1] + shift.z * force[i][2];
      torque[i][3 + k] += shift.x * torque[i][0] + shift.y * torque[i][1] + shift.z * torque[i][2];
    }
    value[i] = test::blocks(force[i], torque[i]);
  }
  return value;
}

double largest(const Matrix6& m) {
  double most = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < 6; ++k)
      most = test::largest(most, std::fabs(m[i][k]) * (i < 3 ? 1 : 1 / kLength) * (k < 3 ? 1 : 1 / kLength));
  }
  return most;
}

// Radii and limits that no hand has: fingers folded upon themselves, bent by 140 degrees at a joint.
Hand odd_hand() {
  Hand hand = default_hand(Side::left);
  test::Random random(3);
  for (double& radius : hand.radius) radius *= random.between(0.7, 1.3);
  for (Finger& finger : hand.finger) {
    for (AngleLimit& limit : finger.limit) limit = {limit.lower - 0.5, limit.upper + 0.5};
  }
  return hand;
}

struct Tally {
  int felt = 0, known = 0, compared = 0;
};

// Compares where differences over two lengths agree to a part in a thousand, for then they are the truth.
void compare(Session& session, const DeviceFrame& frame, Tally& tally) {
  tick(session.model, session.state, session.scratch, frame);
  Jacobians jacobians;
  segment_jacobians(session.model, session.scratch, jacobians);
  const auto joints = session.scratch.primitives->base_joint;
  const auto wide = differences(session, frame, joints, 1e-7),
             fine = differences(session, frame, joints, 1e-8);
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const Matrix6& value = jacobians[i].value;
    if (largest(wide[i]) < kLeast && largest(value) < kLeast) continue;
    ++tally.felt;
    if (!jacobians[i].known) {
      EXPECT_EQ(value, Matrix6{});
      continue;
    }
    ++tally.known;
    if (test::difference(wide[i], fine[i], kLength) > 1e-3) continue;
    ++tally.compared;
    const double off =
        std::fmin(test::difference(value, wide[i], kLength), test::difference(value, fine[i], kLength));
    EXPECT_LT(off, 0.01) << segment_name(static_cast<int>(i));
  }
}

Tally compare_grasps(const Hand& hand, std::uint64_t seed) {
  Tally tally;
  test::Random random(seed);
  for (const World& world : worlds()) {
    Session session(hand, world.mesh);
    for (std::size_t i = 0; i < grasps(); ++i) {
      SCOPED_TRACE(std::string(world.name) + ", grasp " + std::to_string(i));
      compare(session, random_grasp(hand, world.mesh, random), tally);
    }
  }
  return tally;
}

TEST(GraspJacobian, IsRightInEverySegmentWhereItIsKnown) {
  const Tally tally = compare_grasps(default_hand(Side::right), 77);
  EXPECT_GT(tally.felt, 500);
  EXPECT_GE(tally.known, 0.995 * tally.felt);
  EXPECT_GE(tally.compared, 0.99 * tally.known);
}

TEST(GraspJacobian, IsRightOnHandsThatFoldAsNoHandDoes) {
  const Tally tally = compare_grasps(odd_hand(), 78);
  EXPECT_GT(tally.felt, 500);
  EXPECT_GE(tally.known, 0.98 * tally.felt);
  EXPECT_GE(tally.compared, 0.99 * tally.known);
}

}  // namespace
}  // namespace lumbrical
