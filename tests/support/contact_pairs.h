// Random pairs of primitive and triangle of every shape, size, depth and angle, for holding the engine
// against the reference.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>

#include "lumbrical/probe.h"
#include "random.h"
#include "reference/contact.h"

namespace lumbrical::test {

inline constexpr double kPi = std::numbers::pi;

enum class Form { sphere, cylinder, capsule, cone };
inline constexpr const char* kFormNames[] = {"sphere", "cylinder", "capsule", "cone"};
inline void PrintTo(Form form, std::ostream* out) { *out << kFormNames[static_cast<int>(form)]; }

struct Pair {
  ProbePrimitive primitive;
  std::array<Vec3, 3> corners;
  double radius = 0;  ///< [m] of the thickest section: the scale of all errors
};

inline reference::Vector<double> to_reference(Vec3 a) { return {a.x, a.y, a.z}; }
template <class T>
Vec3 from_reference(const reference::Vector<T>& a) {
  return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
}

inline reference::Solid to_reference(const ProbePrimitive& primitive) {
  reference::Solid solid;
  const bool sphere = primitive.shape == ProbeShape::sphere, capsule = primitive.shape == ProbeShape::capsule;
  solid.flat = primitive.shape == ProbeShape::cylinder;
  solid.end1 = to_reference(primitive.end1);
  solid.end2 = to_reference(sphere ? primitive.end1 : primitive.end2);
  solid.radius1 = primitive.radius1;
  solid.radius2 = capsule ? primitive.radius2 : primitive.radius1;
  return solid;
}

inline reference::Triangle to_reference(const std::array<Vec3, 3>& corners) {
  return {to_reference(corners[0]), to_reference(corners[1]), to_reference(corners[2])};
}

template <class T = long double>
reference::Contact<T> ask_reference(const Pair& pair) {
  return reference::contact<T>(to_reference(pair.primitive), to_reference(pair.corners));
}

/// Whether LUMBRICAL_REFERENCE_PAIRS asks for few pairs.
inline bool in_a_hurry() {
  const char* pairs = std::getenv("LUMBRICAL_REFERENCE_PAIRS");
  return pairs != nullptr && std::atoi(pairs) < 100;
}

inline double power_of_ten(Random& random, double low, double high) {
  return std::pow(10.0, random.between(low, high));
}

// A unit axis at an angle to the z axis: anything, or along or across it to within next to nothing.
inline Vec3 random_axis(Random& random) {
  const double turn = random.between(0, 2 * kPi);
  const double off = random.bits() % 3 == 0 ? 0 : power_of_ten(random, -13, -2);
  const auto at = [&](double sine, double cosine) {
    return Vec3{sine * std::cos(turn), sine * std::sin(turn), cosine};
  };
  switch (random.bits() % 4) {
    case 0:
      return at(std::sqrt((1 - off) * (1 + off)), random.bits() % 2 == 0 ? off : -off);
    case 1:
      return at(off, random.bits() % 2 == 0 ? 1 : -1);
    default:
      return random.direction();
  }
}

// A primitive whose lowest point is somewhere below the plane z = 0, and a triangle of that plane round a
// point of their section; half of the pairs then go anywhere.
inline Pair random_pair(Form form, Random& random) {
  Pair pair;
  ProbePrimitive& primitive = pair.primitive;
  primitive.radius1 = random.between(0.004, 0.012);
  primitive.radius2 = primitive.radius1;
  pair.radius = primitive.radius1;
  primitive.shape = form == Form::sphere     ? ProbeShape::sphere
                    : form == Form::cylinder ? ProbeShape::cylinder
                                             : ProbeShape::capsule;
  const Vec3 axis = random_axis(random);
  const double length = form == Form::sphere ? 0 : random.between(0.2, 5) * primitive.radius1;
  if (form == Form::cone) {
    const double most = 0.98 * std::min(length, primitive.radius1);
    primitive.radius2 -=
        random.bits() % 2 == 0 ? random.between(0.01, 1) * most : most * power_of_ten(random, -9, -2);
  }
  primitive.end2 = length * axis;
  // The lowest points: under the ends' spheres, or on the rim of a flat end.
  const double down = form == Form::cylinder
                          ? primitive.radius1 * std::sqrt(axis.x * axis.x + axis.y * axis.y)
                          : primitive.radius1;
  const double down2 = form == Form::cone ? primitive.radius2 : down;
  const double lowest = std::min(-down, length * axis.z - down2);
  const double highest = std::max(down, length * axis.z + down2);
  const double depth = random.bits() % 3 == 0
                           ? random.between(0.01, 0.95) * (highest - lowest)
                           : std::min(pair.radius * power_of_ten(random, -4, 0.3), 0.95 * (highest - lowest));
  const Vec3 shift{0, 0, -depth - lowest};
  primitive.end1 += shift;
  primitive.end2 += shift;

  // Some point of the section: tries under the axis, then straight above the lowest point.
  const Vec3 lower = axis.z * length - down2 < -down ? primitive.end2 : primitive.end1;
  const double size =
      std::min(pair.radius, std::sqrt(depth * std::max(2 * pair.radius - depth, pair.radius))) *
      power_of_ten(random, -1.5, 1.5);
  Vec3 inside{lower.x, lower.y, 0};
  for (int i = 0; i < 40; ++i) {
    const Vec3 on_axis = primitive.end1 + random.between(-0.3, 1.3) * (primitive.end2 - primitive.end1);
    const Vec3 p{on_axis.x + random.between(-1, 1) * pair.radius,
                 on_axis.y + random.between(-1, 1) * pair.radius, 0};
    if (reference::depth_at<long double>(to_reference(primitive), {0, 0, 1}, to_reference(p)) > 0) {
      inside = p;
      break;
    }
  }
  const double first = random.between(0, 2 * kPi);
  const double angles[] = {first, first + random.between(0.2, 2.9), first + random.between(3.3, 6.0)};
  const Vec3 middle =
      inside + size * random.between(0, 1.2) * Vec3{std::cos(3 * first), std::sin(3 * first), 0};
  for (int i = 0; i < 3; ++i) {
    pair.corners[i] =
        middle + size * random.between(0.4, 1) * Vec3{std::cos(angles[i]), std::sin(angles[i]), 0};
  }
  if (random.bits() % 2 == 0) {
    const Pose anywhere = random.pose(0.5);
    primitive.end1 = transform(anywhere, primitive.end1);
    primitive.end2 = transform(anywhere, primitive.end2);
    for (Vec3& corner : pair.corners) corner = transform(anywhere, corner);
  }
  return pair;
}

/// All numbers with all their digits.
inline std::string describe(const reference::Solid& solid, const reference::Triangle& triangle) {
  std::string text = solid.flat ? "flat" : "round";
  char number[32];
  const auto add = [&](double value) {
    std::snprintf(number, sizeof number, " %.17g", value);
    text += number;
  };
  const auto add_point = [&](const char* name, const reference::Vector<double>& p) {
    text += name;
    for (const double value : {p.x, p.y, p.z}) add(value);
  };
  add_point(" ends", solid.end1);
  add_point(",", solid.end2);
  text += " radii";
  add(solid.radius1);
  add(solid.radius2);
  add_point(" triangle", triangle[0]);
  add_point(",", triangle[1]);
  add_point(",", triangle[2]);
  return text;
}

/// [m^3] The largest error that a contact of the field law may state for that area of a triangle: `share` of
/// R^3, and three times what rounding turns the triangle's plane by, at its farthest corner from the
/// primitive.
inline double most_stated(double share, double radius, Vec3 from, const std::array<Vec3, 3>& corner,
                          double area) {
  double farthest = 0, longest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    farthest = std::max(farthest, norm(corner[i] - from));
    longest = std::max(longest, norm(corner[i] - corner[(i + 1) % 3]));
  }
  const double narrow = longest * longest / norm(cross(corner[1] - corner[0], corner[2] - corner[0]));
  return share * radius * radius * radius + 3e-15 * farthest * narrow * area;
}
/// The shares of R^3: three times what the engine says of quadrature along a boundary, which is worst, of
/// sides whose axis lies nearly in the plane, and of discs.
inline constexpr double kMostStated = 3e-9, kMostOfLying = 6e-10, kMostOfDiscs = 3e-11;

inline std::string describe(const Pair& pair) {
  return describe(to_reference(pair.primitive), to_reference(pair.corners));
}

}  // namespace lumbrical::test
