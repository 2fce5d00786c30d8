// Clusters at the joints of bent fingers, where the border between two tiles is a cone: what each segment
// feels against triangle by triangle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lanes/leaf_contact.h"
#include "model/primitive.h"
#include "pressed_hand.h"
#include "random.h"
#include "session.h"

namespace lumbrical::test {
namespace {

constexpr double kWidth = 0.26;  // [m]

// Fingers that taper unevenly, so that the borders at their joints are curved.
Hand uneven_hand(Random& random) {
  Hand hand = default_hand(Side::right);
  for (double& radius : hand.radius) radius *= random.between(0.8, 1.2);
  return hand;
}

DeviceFrame bent_frame(const Hand& hand, Random& random) {
  DeviceFrame frame = pressed_frame(hand, random.between(0.001, 0.004), random.between(0, 1));
  for (std::size_t finger = 1; finger < kFingerCount; ++finger) {
    for (std::size_t k = 1; k <= 3; ++k)
      frame.angle[4 * finger + k] += static_cast<float>(random.between(-0.05, 0.05));
  }
  return frame;
}

Model model_at(const Hand& hand, const Pose& place, double tolerance, const Execution& execution = {}) {
  Scene scene = pressed_scene(kWidth, 420);
  scene.hand = hand;
  for (Vec3& p : scene.objects[0].mesh.vertices) p = transform(place, p);
  scene.settings.tolerance = tolerance;
  scene.settings.max_candidates = 1u << 19;
  return model_of(scene, execution);
}

// What each segment feels, over K_s, and how far that may be off.
struct Felt {
  std::array<Vec3, kSegmentCount> force{}, torque{};
  std::array<double, kSegmentCount> force_bound{}, torque_bound{};
  std::size_t triangles = 0, clusters = 0, split = 0;
  std::size_t singly = 0;  // leaves whose border is too curved
};

Felt feel(const Model& model, const DeviceFrame& frame) {
  State state;
  Scratch scratch = make_scratch(model);
  const ActuatorFrame output = tick(model, state, scratch, frame);
  EXPECT_EQ(output.flags & kCandidateOverflow, 0u);
  Felt felt;
  const Primitives& hand = *scratch.primitives;
  for (std::uint32_t i = 0; i < scratch.contact_count; ++i) {
    const Contact& contact = scratch.contacts[i];
    const Primitive& primitive = hand.primitive[contact.primitive];
    const std::size_t segment = primitive.segment;
    const Vec3 force = contact.volume * contact.normal, lever = contact.centre - hand.base_joint[segment];
    felt.force[segment] += force;
    felt.torque[segment] += cross(lever, force);
    felt.force_bound[segment] += contact.error;
    const double size =
        segment == kPalmSegment ? 0.5 * model.hand.palm.thickness : max(primitive.radius1, primitive.radius2);
    felt.torque_bound[segment] += contact.error * (norm(lever) + 4 * size);
    if (segment == kPalmSegment) continue;
    felt.triangles += (contact.triangle & kClusterBit) == 0 ? 1 : 0;
    felt.clusters += (contact.triangle & kClusterBit) != 0 ? 1 : 0;
    if ((contact.triangle & kSplitBit) == 0) continue;
    ++felt.split;
    LeafQuery query;
    set_leaf_query(hand, primitive, query);
    Contact again = contact;
    felt.singly += leaf_contact(model, field_kernels(model.execution.isa), query, again) ? 0 : 1;
  }
  return felt;
}

TEST(ClusterBorders, LeaveEverySegmentItsShareWithinTheStatedError) {
  Random random(11);
  std::size_t split = 0, clusters = 0, triangles = 0, singly = 0;
  for (int pose = 0; pose < 3; ++pose) {
    const Hand hand = uneven_hand(random);
    const Pose place{random.in_box(0.3), random.rotation()};
    DeviceFrame frame = bent_frame(hand, random);
    frame.base = place * frame.base;
    const Felt wanted = feel(model_at(hand, place, 0), frame);
    double largest = 0;
    for (const Vec3 force : wanted.force) largest = std::max(largest, norm(force));
    for (const double tolerance : {3e-3, 3e-2}) {
      const Felt got = feel(model_at(hand, place, tolerance), frame);
      for (std::size_t i = 0; i < kSegmentCount; ++i) {
        const double rounding = 1e-12 * largest;
        const double off = norm(got.force[i] - wanted.force[i]);
        EXPECT_LE(off, got.force_bound[i] + wanted.force_bound[i] + rounding)
            << "pose " << pose << " segment " << i << " at " << tolerance;
        EXPECT_LE(norm(got.torque[i] - wanted.torque[i]),
                  got.torque_bound[i] + wanted.torque_bound[i] + 0.1 * rounding)
            << "pose " << pose << " segment " << i << " at " << tolerance;
        EXPECT_LE(off, 0.1 * tolerance * largest) << "segment " << i << " at " << tolerance;
      }
      singly += got.singly;
      if (tolerance < 1e-2) continue;  // some triangles are too wide for that
      split += got.split;
      clusters += got.clusters;
      triangles += got.triangles;
    }
  }
  EXPECT_GT(split, 1000u);
  EXPECT_GT(singly, 0u);
  EXPECT_LT(triangles, clusters / 2);  // under fingertips that are all but through
}

}  // namespace
}  // namespace lumbrical::test
