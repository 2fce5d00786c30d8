// Which triangles have no area worth the name: one judgement for the report on a mesh and for its repair.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "lumbrical/math.h"

namespace lumbrical {

// A triangle is degenerate when its doubled area is at most this share of its longest edge squared. Storing a
// corner as a double moves it by up to 1.1e-16 of its distance from the origin, so three collinear points
// come out as a triangle of about 1e-16 times (distance / longest edge); the bound leaves room for triangles
// 10^4 times smaller than their distance. The flattest triangles in float files that are flat on purpose lie
// near 1e-7, the spacing of floats, far above.
inline constexpr double kFlat = 1e-12;
inline constexpr double kSinOneDegree = 0.017452406437283512;

/// Collinear: also where corners coincide.
enum class TriangleShape : std::uint8_t { sound, sliver, collinear };

struct TriangleMeasures {
  double unit = 1;  ///< [m] what the rest is measured in: squares of a tiny triangle's edges would vanish
  double doubled_area = 0;                ///< [unit^2]
  std::array<double, 3> squared_edges{};  ///< [unit^2] from the first corner on
};

/// Of corners none of which is so large that their differences overflow.
inline TriangleMeasures measure_triangle(Vec3 p, Vec3 q, Vec3 r) {
  const double size = max(max(largest_of(q - p), largest_of(r - q)), largest_of(p - r));
  TriangleMeasures measures;
  measures.unit = size > 0 ? size : 1.0;
  const Vec3 a = (q - p) / measures.unit, b = (r - q) / measures.unit, c = (p - r) / measures.unit;
  measures.doubled_area = norm(cross(a, b));
  measures.squared_edges = {dot(a, a), dot(b, b), dot(c, c)};
  return measures;
}

/// The smallest angle lies between the two longest edges.
inline TriangleShape shape_of(const TriangleMeasures& measures) {
  std::array<double, 3> squared = measures.squared_edges;
  std::sort(squared.begin(), squared.end());
  if (measures.doubled_area <= kFlat * squared[2]) return TriangleShape::collinear;
  const double product = std::sqrt(squared[1]) * std::sqrt(squared[2]);
  return measures.doubled_area < kSinOneDegree * product ? TriangleShape::sliver : TriangleShape::sound;
}

/// [2^exponent m] A power of two rounds nothing; with an exponent by which no coordinate exceeds 1 no product
/// of them overflows.
inline Vec3 scaled_down(Vec3 p, int exponent) {
  return {std::ldexp(p.x, -exponent), std::ldexp(p.y, -exponent), std::ldexp(p.z, -exponent)};
}

}  // namespace lumbrical
