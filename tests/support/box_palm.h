// Palms by themselves, for tests: a hand of nothing but a swept polygon, pressed against triangles.
#pragma once

#include <array>
#include <vector>

#include "largest.h"
#include "model/swept_polygon.h"
#include "random.h"
#include "session.h"
#include "stages/narrowphase.h"

namespace lumbrical::test {

inline constexpr double kPalmRadius = 0.012;  // [m]

/// A core 2 a by 2 b wide [m], everything within `radius` of it, its palmar skin `depth` [m] below z = 0; X
/// moves it.
inline SweptPolygon box_palm(double a, double b, double depth, double radius = kPalmRadius,
                             const Pose& X = {}) {
  SweptPolygon palm;
  palm.corner_count = 4;
  palm.radius = radius;
  palm.normal = rotate(X.orientation, {0, 0, -1});
  const std::array<Vec3, 4> corner = {{{a, b, 0}, {a, -b, 0}, {-a, -b, 0}, {-a, b, 0}}};
  const std::array<Vec3, 4> outward = {{{1, 0, 0}, {0, -1, 0}, {-1, 0, 0}, {0, 1, 0}}};
  for (std::size_t i = 0; i < 4; ++i) {
    palm.corner[i] = transform(X, corner[i] + Vec3{0, 0, radius - depth});
    palm.outward[i] = rotate(X.orientation, outward[i]);
  }
  return palm;
}

/// A palm of 3 to 16 corners on a circle of 15 to 40 mm, as a hand has it.
inline Palm random_palm(Random& random) {
  Palm palm;
  palm.height = random.between(0.005, 0.02);
  palm.thickness = 2 * random.between(0.006, 0.015);
  const std::size_t corners = 3 + random.below(14);
  const double size = random.between(0.015, 0.04);
  for (std::size_t i = 0; i < corners; ++i) {
    const double angle =
        6.283185307179586 * (static_cast<double>(i) + random.between(0, 0.9)) / static_cast<double>(corners);
    palm.polygon.push_back({size * std::cos(angle), 0, size * std::sin(angle)});
  }
  return palm;
}

inline Primitives hand_of(const SweptPolygon& palm, Law law = Law::field) {
  Primitives hand;
  hand.palm = palm;
  add_palm_parts(palm, law, hand);
  return hand;
}

inline Model world_of(Mesh mesh) {
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"mesh", std::move(mesh)});
  return model_of(scene);
}

/// What a palm feels of triangles, all of them asked.
struct Pressed {
  Vec3 force;   ///< [m^3] over K_s
  Vec3 torque;  ///< [m^4] about the origin
  double area = 0, volume = 0, depth = 0;
  Vec3 centre;  ///< [m] of pressure
  std::vector<Contact> contacts;
};

inline Pressed press(const Model& model, const Primitives& hand) {
  std::vector<std::uint64_t> candidates;
  for (std::uint64_t i = 0; i < hand.count; ++i) {
    for (std::size_t k = 0; k < model.triangles.size(); ++k) candidates.push_back(i << 32 | k);
  }
  Pressed pressed;
  pressed.contacts.resize(candidates.size());
  pressed.contacts.resize(collide_pairs(model, hand, candidates, pressed.contacts));
  for (const Contact& contact : pressed.contacts) {
    const Vec3 force = contact.volume * contact.normal;
    pressed.force += force;
    pressed.torque += cross(contact.centre, force);
    pressed.area += contact.area;
    pressed.volume += contact.volume;
    pressed.depth = largest(pressed.depth, contact.depth);
    pressed.centre += contact.volume * contact.centre;
  }
  if (pressed.volume > 0) pressed.centre = pressed.centre / pressed.volume;
  return pressed;
}

}  // namespace lumbrical::test
