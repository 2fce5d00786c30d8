// Places that few hands hit by chance, but round numbers do: sheets in the plane of an axis or between two
// tiles, skin that just touches. Lengths are exact in binary, so that what coincides does to the last bit,
// and turned but for rounding.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "exact/finger_reference.h"
#include "exact/posed_finger.h"
#include "largest.h"
#include "mesh_world.h"
#include "pads.h"
#include "random.h"
#include "sampled_hand.h"

namespace lumbrical::test {
namespace {

// [m] All lengths below are multiples of it.
constexpr double kUnit = 1.0 / 128;

// Of a finger, from base to tip.
using Joints = std::array<Vec3, 4>;

Joints straight(Vec3 base, double first, double second, double third) {
  return {base, base + Vec3{0, first, 0}, base + Vec3{0, first + second, 0},
          base + Vec3{0, first + second + third, 0}};
}

// A hand of nothing but what is put into it.
struct Parts {
  Hand hand = plain_hand(kUnit);
  DeviceFrame frame;

  Parts() { frame.valid = 0; }
  void put_joint(std::size_t joint, Vec3 at) {
    const Vec3 p = kUnit * at;
    frame.joint[joint].position = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    frame.valid |= 1u << joint;
  }
  void put_finger(std::size_t finger, const Joints& joints, double radius = 1) {
    const std::size_t base = kPhalanxJoints[3 * finger].base;
    for (std::size_t k = 0; k < joints.size(); ++k) {
      put_joint(base + k, joints[k]);
      hand.radius[base + k] = radius * kUnit;
    }
  }
  // Its core is 2 x wide and 2 z long; the skin lies 1 above and below the joint, which is in the middle.
  void put_palm(Vec3 joint, double x, double z) {
    hand.palm = {{}, kUnit, 2 * kUnit};
    for (const Vec3 corner : {Vec3{x, 0, z}, Vec3{-x, 0, z}, Vec3{-x, 0, -z}, Vec3{x, 0, -z}})
      hand.palm.polygon.push_back(kUnit * corner);
    put_joint(kPalm, joint);
    put_joint(kWrist, joint);
  }
};

// Hand and mesh, turned together.
struct Turned {
  Scene scene;
  DeviceFrame frame;
};
Turned turned_by(Quat rotation, const Parts& parts, Mesh mesh, FeltOnce felt_once) {
  for (Vec3& vertex : mesh.vertices) vertex = rotate(rotation, kUnit * vertex);
  Turned all{sampled_scene(parts.hand, {{"sheet", std::move(mesh), Winding::as_is}}), parts.frame};
  all.scene.settings.felt_once = felt_once;
  all.frame.base.orientation = rotation;
  return all;
}

// As it is first, then anyhow.
std::vector<Quat> rotations(std::size_t count) {
  Random random(8);
  std::vector<Quat> all(count);
  std::generate(all.begin() + 1, all.end(), [&] { return random.rotation(); });
  return all;
}

Mesh sheet_at(Vec3 middle, double extent, std::uint32_t cells) {
  Mesh sheet = make_plane(extent, cells);
  move(sheet, middle);
  return sheet;
}
Mesh triangle(Vec3 a, Vec3 b, Vec3 c) {
  Mesh mesh;
  add_triangle(a, b, c, mesh);
  return mesh;
}

// The worst segment's, of its force or of its torque over the unit, as a share of all forces.
double difference(const HandForces& one, const HandForces& other) {
  double most = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const Wrench &a = one.segment[i], &b = other.segment[i];
    most = largest(most, largest(norm(a.force - b.force), norm(a.torque - b.torque) / kUnit));
  }
  return most / force_size(other);
}

// Of the hand's force alone: what lies in a border may be either segment's.
double sum_difference(const HandForces& one, const HandForces& other) {
  return norm(total_force(one) - total_force(other)) / norm(total_force(other));
}

// ---- Skin that just touches ----

// Of feeling once and twice while the hand is moved by next to nothing, as a share of the precision.
double worst_difference_near(const Parts& parts, const Mesh& sheet, Quat rotation, double precision) {
  const Turned all = turned_by(rotation, parts, sheet, FeltOnce::by_samples);
  FeelingHand once(all.scene, precision);
  FeelingHand twice(turned_by(rotation, parts, sheet, FeltOnce::never).scene, precision);
  Random random(9);
  double worst = 0;
  for (const double step : {0.0, 1e-9, 1e-8, 1e-7, 1e-6}) {
    for (int i = 0; i < 4; ++i) {
      DeviceFrame frame = all.frame;
      move(frame, step * random.direction());
      worst = largest(worst, difference(once(frame), twice(frame)) / precision);
    }
  }
  return worst;
}

// Cells of the palm's lattice are then nothing but rounding, and so are their shares.
TEST(Coincidences, APalmThatJustTouchesTheSheetTakesNothingFromTheThumbInIt) {
  Parts at_its_base;
  at_its_base.put_finger(0, straight({2, -2.5, -2.5}, 1, 4, 3));
  Parts farther_on = at_its_base;
  at_its_base.put_palm({1, -2.5, -0.5}, 2, 1);
  farther_on.put_palm({1, 0, -0.5}, 2, 1);
  const Mesh sheet = sheet_at({6, 1.5, -2.5}, 8, 2);
  for (const Parts& parts : {at_its_base, farther_on}) {
    for (const Quat rotation : rotations(5)) {
      for (const double precision : {1e-3, 1e-4})
        EXPECT_LT(worst_difference_near(parts, sheet, rotation, precision), 1)
            << rotation.w << " " << precision;
    }
  }
}

// ---- Axes in the sheet ----

std::vector<ReferenceCapsule> capsules_of(const Joints& joints) {
  std::vector<ReferenceCapsule> capsules;
  for (std::size_t k = 0; k < 3; ++k)
    capsules.push_back({kUnit * joints[k], kUnit * joints[k + 1], kUnit, kUnit});
  return capsules;
}

// [m^3] Over z = 0 from low to high, by the middles of squares of a sixty-fourth.
double field_volume(const std::vector<ReferenceCapsule>& capsules, Vec3 low, Vec3 high) {
  constexpr double kStep = 1.0 / 64;
  double sum = 0;
  for (double x = low.x + kStep / 2; x < high.x; x += kStep) {
    for (double y = low.y + kStep / 2; y < high.y; y += kStep)
      sum += std::max(0.0, finger_field(capsules, kUnit * Vec3{x, y, 0}));
  }
  return kStep * kStep * kUnit * kUnit * sum;
}

// They overlap, and vertices of the sheet lie in planes of their joints: some parts of it, round a corner,
// are next to nothing.
TEST(Coincidences, TwoFingersWithTheirAxesInTheSheetFeelWhatTheDeepestFeels) {
  const Joints one = straight({0, 0, 0}, 3, 3, 3), other = straight({0.25, 0, 0}, 3, 3, 3);
  Parts parts;
  parts.put_finger(0, one);
  parts.put_finger(1, other);
  std::vector<ReferenceCapsule> both = capsules_of(one);
  for (const ReferenceCapsule& capsule : capsules_of(other)) both.push_back(capsule);
  const double volume = field_volume(both, {-1, -1, 0}, {1.25, 10, 0});
  for (const Quat rotation : rotations(5)) {
    const Turned all = turned_by(rotation, parts, sheet_at({0, 6, 0}, 16, 2), FeltOnce::always);
    const ActuatorFrame felt = FeelingHand(all.scene, 0)(all.frame);
    const double force = all.scene.settings.stiffness * volume;
    EXPECT_NEAR(norm(total_force(felt)), force, 1e-5 * force) << rotation.w;
    EXPECT_LT(felt.force_error, 1e-5 * force) << rotation.w;
    EXPECT_LT(sum_difference(FeelingHand(all.scene, 1e-4)(all.frame), felt), 1e-3) << rotation.w;
  }
}

// ---- Sheets in the plane between two tiles ----

// By how much samples are off the exact rung.
double sampled_error(const Turned& all) {
  return sum_difference(FeelingHand(all.scene, 1e-4)(all.frame), FeelingHand(all.scene, 0)(all.frame));
}

// The palm takes nothing here, but makes the finger ask who of all parts is the deepest.
TEST(Coincidences, ATriangleInAJointsPlaneIsFeltWhereThePalmsSkinTouchesItToo) {
  Parts parts;
  parts.put_finger(1, straight({2, 0, 0}, 1, 2, 4), 0.75);
  parts.put_palm({0, 0, -1.5}, 4, 2);
  for (const Mesh& mesh :
       {triangle({3, 1, -1.5}, {2.5, 1, 2}, {2, 1, -1}), triangle({2, 1, -1}, {3, 1, -1}, {2, 1, 1}),
        triangle({2, 1, -4}, {2, 1, 4}, {6, 1, 0})}) {
    for (const Quat rotation : rotations(10))
      EXPECT_LT(sampled_error(turned_by(rotation, parts, mesh, FeltOnce::always)), 1e-3) << rotation.w;
  }
}

TEST(Coincidences, ASheetMidwayBetweenTheEndsOfAFoldedFingerIsFeltWhereThePalmMeetsItToo) {
  Parts parts;
  parts.put_finger(1, {{{0, 0, 0}, {0, 4, 0}, {0, 4, -1.5}, {0, 0, -1.5}}});
  parts.put_palm({0, 0, 0}, 4, 2);
  const Mesh mesh = triangle({-4, -4, -0.75}, {4, -4, -0.75}, {0, 8, -0.75});
  for (const Quat rotation : rotations(10))
    EXPECT_LT(sampled_error(turned_by(rotation, parts, mesh, FeltOnce::always)), 1e-3) << rotation.w;
}

// Each then feels the sheet by triangles of its own, and both have to agree on whose it is.
TEST(Coincidences, ASheetInTheirJointsPlaneIsFeltOnceBySegmentsOfDifferentPrecisions) {
  Parts parts;
  parts.put_finger(0, straight({0, 0, 0}, 1, 3, 3), 0.75);
  for (const Mesh& mesh :
       {triangle({-4, 1, -4}, {4, 1, -4}, {0, 1, 4}), triangle({0, 1, 0}, {0, 1, -4}, {4, 1, -4})}) {
    for (const Quat rotation : rotations(20)) {
      Turned all = turned_by(rotation, parts, mesh, FeltOnce::never);
      const ActuatorFrame exact = FeelingHand(all.scene, 0)(all.frame);
      all.scene.settings.precision.fill(1e-5);
      all.scene.settings.precision[0] = 1e-3;
      EXPECT_LT(sum_difference(Session(all.scene).feel(all.frame), exact), 1e-3) << rotation.w;
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
