// Touching pairs of primitive and triangle for accuracy runs: every shape, all angles, triangles of a
// thousandth to a thousand radii, depths of a millionth of the radius to through and through.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "model/primitive.h"
#include "random.h"
#include "reference/contact.h"

namespace lumbrical::bench {

enum class Form { sphere, cylinder, capsule, cone };
inline constexpr const char* kFormNames[] = {"sphere", "flat cylinder", "capsule", "rounded cone"};

/// Of the axis against the plane: whatever comes, or along or across it to within 1e-2 to 1e-15 or exactly.
enum class Angle { any, lying, upright };
inline constexpr const char* kAngleNames[] = {"any", "lying", "upright"};

struct Pair {
  Primitive primitive;
  std::array<Vec3, 3> corners;
  double radius = 0;  ///< [m] the larger one: the scale of all errors
};

/// Most of them touch; who needs all to, draws again.
Pair draw_pair(Form form, Angle angle, test::Random& random);

reference::Solid to_reference(const Primitive& primitive);
reference::Triangle to_reference(const std::array<Vec3, 3>& corners);

/// All numbers with all their digits.
std::string describe(const Pair& pair);

}  // namespace lumbrical::bench
