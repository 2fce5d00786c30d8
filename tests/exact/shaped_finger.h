// Fingers of any shape against single triangles or small meshes, pair by pair, for tests of how tiles share
// out space.
#pragma once

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "borders/joint_border.h"
#include "finger_reference.h"
#include "mesh_world.h"
#include "model/corners.h"
#include "pose_hand.h"
#include "posed_finger.h"
#include "random.h"
#include "stages/narrowphase.h"

namespace lumbrical::test {

inline constexpr double kRadius = 0.0078125;
inline constexpr double kDegree = std::numbers::pi / 180;

// The plane z = height, one triangle far larger than a finger.
inline Corners floor_at(double height) {
  return {{-1, -0.9, height}, {1.1, -1, height}, {-0.1, 1.2, height}};
}

struct FingerShape {
  std::array<double, 3> length{};  // [m]
  std::array<double, 4> radius{};  // [m] at the joints, base to tip
  double bend1 = 0, bend2 = 0;     // [rad]
  double sideways = 0;             // share of each bone that lies out of the plane of bending
};

// Joints from the origin, the first bone at `tilt` over the x axis, bending down.
inline std::array<Vec3, 4> joints_of(const FingerShape& shape, double tilt) {
  std::array<Vec3, 4> joint{};
  double angle = tilt;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 bone{std::cos(angle), i == 1 ? shape.sideways : 0, std::sin(angle)};
    joint[i + 1] = joint[i] + shape.length[i] * unit_or(bone, {});
    angle -= i == 0 ? shape.bend1 : shape.bend2;
  }
  return joint;
}

inline Primitives posed(const FingerShape& shape, const std::array<Vec3, 4>& joints, Law law = Law::field) {
  Hand hand = plain_hand(kRadius);
  for (std::size_t i = 0; i < 4; ++i) hand.radius[kIndexProximal + i] = shape.radius[i];
  Settings settings;
  settings.law.fill(law);
  Primitives primitives;
  pose_hand(hand, settings, finger_frame(joints), primitives);
  return primitives;
}

inline Primitives posed(const FingerShape& shape, const Pose& X) {
  std::array<Vec3, 4> joints = joints_of(shape, 0);
  for (Vec3& joint : joints) joint = transform(X, joint);
  return posed(shape, joints);
}

// Moved as a whole, without rounding to the device's floats again.
inline Primitives moved(Primitives hand, Vec3 by) {
  for (Primitive* p : {&hand.capsule[3], &hand.capsule[4], &hand.capsule[5], &hand.primitive[0],
                       &hand.primitive[1], &hand.primitive[2]}) {
    p->end1 += by;
    p->end2 += by;
    for (HalfSpace& cut : p->cut) cut.point += by;
  }
  set_joint_borders(hand);
  return hand;
}

inline std::vector<ReferenceCapsule> capsules_of(const Primitives& hand) {
  std::vector<ReferenceCapsule> finger;
  for (std::size_t i = 3; i < 6; ++i) {
    const Primitive& c = hand.capsule[i];
    finger.push_back({c.end1, c.end2, c.radius1, c.radius2});
  }
  return finger;
}

struct Felt {
  double area = 0, volume = 0, error = 0;  // error: what the contacts state
  Vec3 area_first, first;                  // about a corner of the triangle
  Vec3 force;                              // over the stiffness
  std::array<double, 3> share{};           // volume of each tile
};

inline Mesh mesh_of(const std::vector<Corners>& triangles) {
  Mesh mesh;
  for (const Corners& t : triangles) add_triangle(t.a, t.b, t.c, mesh);
  return mesh;
}

// Of every tile with every triangle, as ticks find them.
inline std::vector<Contact> contacts_of(const Primitives& hand, const Mesh& mesh) {
  Model model;
  model.triangles = world_of(mesh);
  std::vector<std::uint64_t> candidates;
  for (std::uint64_t i = 0; i < hand.count; ++i) {
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) candidates.push_back(i << 32 | k);
  }
  std::vector<Contact> contacts(candidates.size());
  contacts.resize(collide_pairs(model, hand, candidates, contacts));
  return contacts;
}

inline Felt feel(const Primitives& hand, const Mesh& mesh) {
  Felt felt;
  for (const Contact& contact : contacts_of(hand, mesh)) {
    const Vec3 corner = mesh.vertices[mesh.triangles[contact.triangle][0]];
    felt.area += contact.area;
    felt.volume += contact.volume;
    felt.error += contact.error;
    felt.area_first += contact.area * (contact.centroid - corner);
    felt.first += contact.volume * (contact.centre - corner);
    felt.force += contact.volume * contact.normal;
    felt.share[contact.primitive] += contact.volume;
  }
  return felt;
}

inline Felt feel(const Primitives& hand, const Corners& t) { return feel(hand, mesh_of({t})); }

inline FingerShape random_finger(Random& random) {
  FingerShape shape;
  shape.radius[0] = kRadius * random.between(0.8, 1.2);
  for (std::size_t i = 1; i < 4; ++i) shape.radius[i] = shape.radius[i - 1] * random.between(0.7, 1.3);
  for (double& length : shape.length)
    length = kRadius * (random.bits() % 2 != 0 ? random.between(0.5, 1.5) : random.between(1.5, 5));
  shape.bend1 = random.between(-30, 120) * kDegree;
  shape.bend2 = random.between(-30, 120) * kDegree;
  shape.sideways = random.between(-0.1, 0.1);
  return shape;
}

/// How many random fingers to try: LUMBRICAL_BORDER_FINGERS or the usual number.
inline int finger_count(int usual) {
  const char* wanted = std::getenv("LUMBRICAL_BORDER_FINGERS");
  return wanted != nullptr ? std::atoi(wanted) : usual;
}

}  // namespace lumbrical::test
