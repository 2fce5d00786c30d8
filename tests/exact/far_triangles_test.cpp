// Triangles of metres to kilometres, of which only a corner lies within the hand: what it feels of them is
// what it feels of that corner.
#include <gtest/gtest.h>

#include <cmath>

#include "pads.h"
#include "random.h"

namespace lumbrical::test {
namespace {

constexpr double kRadius = 0.0078125;  // [m] a power of two, so that coincidences are exact
constexpr double kNear = 20;           // [radii] beyond this nothing of a corner lies within the hand
constexpr double kUnit = 2e7 * kRadius * kRadius * kRadius;  // [N]

void put(int joint, Vec3 p, DeviceFrame& frame) {
  frame.joint[static_cast<std::size_t>(joint)].position = {static_cast<float>(p.x), static_cast<float>(p.y),
                                                           static_cast<float>(p.z)};
  frame.valid |= 1u << joint;
}

/// A hand, and where it is.
struct Placed {
  Scene scene = pad_scene();
  DeviceFrame frame;
  Placed() { frame.valid = 0; }
};

// 8 by 4 radii across, nothing else.
Placed palm_alone() {
  Placed hand;
  const double x = 4 * kRadius, z = 2 * kRadius;
  hand.scene.hand.palm.polygon = {{x, 0, z}, {-x, 0, z}, {-x, 0, -z}, {x, 0, -z}};
  hand.scene.hand.palm.thickness = 2 * kRadius;
  hand.scene.hand.palm.height = 0;
  put(kPalm, {0, 0, 0}, hand.frame);
  put(kWrist, {0, 0, 0}, hand.frame);
  return hand;
}

// A straight index finger whose first joint is at the origin.
Placed straight_finger() {
  Placed hand;
  hand.scene.hand.radius.fill(kRadius);
  for (int k = 0; k < 4; ++k) put(kIndexProximal + k, {0, 3 * k * kRadius, 0}, hand.frame);
  return hand;
}

/// What the hand feels of one triangle.
struct Felt {
  Vec3 force, torque;  // about the origin
  double error = 0;
};
Felt feel_triangle(const Placed& hand, Vec3 corner, Vec3 to_b, Vec3 to_c) {
  Scene scene = hand.scene;
  scene.objects.push_back({"triangle", {{corner + to_b, corner + to_c, corner}, {{0, 1, 2}}}});
  Session run(scene);
  const ActuatorFrame output = tick(run.model, run.state, run.scratch, hand.frame);
  Felt felt{{}, {}, output.force_error};
  for (const Contact& contact : find_contacts(run.model, run.scratch)) {
    const Vec3 force = scene.settings.stiffness * contact.volume * contact.normal;
    felt.force += force;
    felt.torque += cross(contact.centre, force);
  }
  return felt;
}

// `to_b` and `to_c` are of a triangle of `size` radii. Answers whether it is felt.
bool expect_same_when_cut_short(const Placed& hand, double size, Vec3 corner, Vec3 to_b, Vec3 to_c) {
  const double share = kNear / size;
  const Felt far = feel_triangle(hand, corner, to_b, to_c),
             near = feel_triangle(hand, corner, share * to_b, share * to_c);
  EXPECT_LT(norm(far.force - near.force), far.error + near.error + 1e-11 * kUnit) << size;
  EXPECT_LT(norm(far.torque - near.torque), 2e-9 * kUnit * kRadius) << size;
  return norm(near.force) > 1e-3 * kUnit;
}

TEST(FarTriangles, SquareToThePalmsRimAtItsCornersAreFeltThereOnly) {
  const Placed hand = palm_alone();
  Random random(1);
  int felt = 0;
  const auto sign = [&] { return random.below(2) == 0 ? 1.0 : -1.0; };
  const auto quarters = [&] { return 0.25 * (static_cast<double>(random.below(5)) - 2); };
  for (const double size : {1e3, 1e4, 1e5}) {
    for (int i = 0; i < 60; ++i) {
      const Vec3 rim{sign() * 4, 0, sign() * 2}, beside{quarters(), quarters(), quarters()};
      const double slant = sign(), x = size * random.between(0.7, 1) * kRadius * sign();
      const Vec3 to_b{x, -slant * x, 0}, to_c = to_b + Vec3{0, 0, 1.4 * sign() * std::fabs(x)};
      felt += expect_same_when_cut_short(hand, size, kRadius * (rim + beside), to_b, to_c) ? 1 : 0;
    }
  }
  EXPECT_GT(felt, 100);
}

// A corner just beyond a joint, from which the triangle leads back across it: what is left to the joint's
// outer tile lies wholly within it.
TEST(FarTriangles, ThatLeadAwayAcrossAJointAreFeltThereOnly) {
  const Placed hand = straight_finger();
  Random random(2);
  int felt = 0;
  for (const double size : {1e3, 1e4, 1e5}) {
    for (int i = 0; i < 300; ++i) {
      const double beyond = random.between(0.02, 0.4), joint = 3 + 3 * static_cast<double>(random.below(2));
      const Vec3 aside = random.in_box(0.4), corner = kRadius * Vec3{aside.x, joint + beyond, aside.z};
      const Vec3 b = unit_or(random.direction() - Vec3{0, 1.5, 0}, {}),
                 c = unit_or(random.direction() - Vec3{0, 1.5, 0}, {});
      if (dot(b, c) < 0) continue;  // what is cut off of a wide corner would be near
      felt += expect_same_when_cut_short(hand, size, corner, size * kRadius * b, size * kRadius * c) ? 1 : 0;
    }
  }
  EXPECT_GT(felt, 100);
}

}  // namespace
}  // namespace lumbrical::test
