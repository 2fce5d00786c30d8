// Random primitives of the field law, with and without cuts, touching a random triangle.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "borders/pair_contact.h"
#include "random.h"

namespace lumbrical::test {

enum class TouchForm { sphere, capsule, cone };
inline constexpr const char* kTouchFormNames[] = {"sphere", "capsule", "cone"};
inline void PrintTo(TouchForm form, std::ostream* out) { *out << kTouchFormNames[static_cast<int>(form)]; }

struct RandomTouch {
  Primitive primitive;
  Vec3 joint;  ///< [m] W, what torques are about
  std::array<Vec3, 3> corner;
  Contact contact;    ///< what the engine finds
  double radius = 0;  ///< [m] the thicker end's: the scale of all errors
};

inline void add_random_cut(Vec3 point, Vec3 outward, Random& random, Primitive& primitive) {
  const Vec3 normal = unit_or(outward + random.between(0, 0.8) * random.direction(), outward);
  primitive.cut[primitive.cut_count++] = {normal, point};
}

/// Radii of 4 to 12 mm, depths of a hundredth of the radius to the axis and beyond, triangles of a thirtieth
/// to thirty radii, all angles.
inline RandomTouch random_touch(TouchForm form, int cut_count, Random& random) {
  for (;;) {
    RandomTouch touch;
    Primitive& primitive = touch.primitive;
    touch.radius = primitive.radius1 = primitive.radius2 = random.between(0.004, 0.012);
    const double length = form == TouchForm::sphere ? 0 : random.between(0.3, 4) * touch.radius;
    if (form == TouchForm::cone)
      primitive.radius2 -= random.between(0.05, 0.9) * std::min(length, touch.radius);
    const Vec3 axis = random.direction();
    primitive.end2 = length * axis;
    if (random.bits() % 2 == 0) std::swap(primitive.radius1, primitive.radius2);
    if (cut_count > 0) add_random_cut(primitive.end1, -axis, random, primitive);
    if (cut_count > 1) add_random_cut(primitive.end2, axis, random, primitive);
    touch.joint = primitive.end1 + 2 * touch.radius * random.in_box(1);

    const Vec3 normal = random.direction();
    const double reach = random.bits() % 3 == 0 ? random.between(-0.5, 1) : random.between(0.6, 1);
    const Vec3 middle = primitive.end1 + random.between(0, 1) * (primitive.end2 - primitive.end1) -
                        reach * touch.radius * normal;
    const double size = touch.radius * std::pow(10.0, random.between(-1.5, 1.5));
    const Vec3 u = unit_or(cross(normal, random.direction()), Vec3{1, 0, 0}), v = cross(normal, u);
    const double first = random.between(0, 6.28);
    const double angle[] = {first, first + random.between(0.6, 2.6), first + random.between(3.4, 5.6)};
    for (std::size_t i = 0; i < 3; ++i) {
      touch.corner[i] =
          middle + size * random.between(0.4, 1) * (std::cos(angle[i]) * u + std::sin(angle[i]) * v);
    }
    if (collide(primitive, {}, {touch.corner[0], touch.corner[1], touch.corner[2]}, touch.contact) &&
        touch.contact.area > 1e-4 * touch.radius * touch.radius) {
      return touch;
    }
  }
}

}  // namespace lumbrical::test
