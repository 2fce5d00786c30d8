#include "index/block_samples.h"

#include <array>
#include <cmath>

namespace lumbrical {
namespace {

// What the rule leaves out, fields quadratic along two axes at once, vanishes where all patches face one way.
// Blocks count as larger by the sixteenth power of how flat they are, at most so many times.
constexpr double kLeastFlatness = 1e-6;

// Integrals over a block's patches, h counted from the centre.
struct BlockMoments {
  Vec3 centre;                   // [m] W, of the area
  double area = 0;               // [m^2] twice
  Vec3 normal;                   // [m^2] of n, twice
  std::array<Vec3, 3> spread{};  // [m^4] rows of the area's h h, twice
};

Vec3 row_of(const Vec3 (&h)[4], double Vec3::*axis, double twice_area) {
  // Of a triangle: corners by a twelfth, the centroid by nine.
  return (twice_area / 12) *
         (h[0].*axis * h[0] + h[1].*axis * h[1] + h[2].*axis * h[2] + 9 * (h[3].*axis) * h[3]);
}

BlockMoments moments_of(std::span<const Corners> patches) {
  BlockMoments m;
  const Vec3 origin = patches[0].a;
  Vec3 first;
  for (const Corners& at : patches) {
    const Vec3 normal = cross(at.b - at.a, at.c - at.a);
    const double area = norm(normal);
    m.area += area;
    m.normal += normal;
    first += area * ((at.a - origin) + ((at.b - at.a) + (at.c - at.a)) / 3.0);
  }
  m.centre = origin + first / m.area;
  for (const Corners& at : patches) {
    const Vec3 a = at.a - m.centre, b = a + (at.b - at.a), c = a + (at.c - at.a);
    const Vec3 h[4] = {a, b, c, a + ((b - a) + (c - a)) / 3.0};
    const double area = norm(cross(b - a, c - a));
    m.spread[0] += row_of(h, &Vec3::x, area);
    m.spread[1] += row_of(h, &Vec3::y, area);
    m.spread[2] += row_of(h, &Vec3::z, area);
  }
  return m;
}

// Principal directions of the spread within the plane across `normal`, and that.
std::array<Vec3, 3> axes_of(const BlockMoments& m) {
  const Vec3 z = unit_or(m.normal, {0, 0, 1});
  const Vec3 x = unit_or(cross(z, std::fabs(z.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}), {1, 0, 0}),
             y = cross(z, x);
  const auto along = [&](Vec3 u, Vec3 v) {
    return dot(u, Vec3{dot(m.spread[0], v), dot(m.spread[1], v), dot(m.spread[2], v)});
  };
  const double a = along(x, x), b = along(x, y), d = along(y, y), half = 0.5 * (a - d);
  const double root = std::sqrt(half * half + b * b);
  // Of the two ways to write the larger one's direction the one that does not cancel.
  const Vec3 u = unit_or(half > 0 ? (half + root) * x + b * y : b * x + (root - half) * y, x);
  return {u, cross(z, u), z};
}

}  // namespace

BlockSamples samples_of(std::span<const Corners> patches) {
  const BlockMoments m = moments_of(patches);
  BlockSamples samples{};
  samples.centre = split_point(m.centre);
  double radius = 0;
  for (const Corners& at : patches) {
    for (const Vec3 corner : {at.a, at.b, at.c}) radius = max(radius, norm(corner - m.centre));
  }
  samples.radius = static_cast<float>((1 + 1e-6) * radius);
  double flatness = norm(m.normal) / m.area;
  for (int k = 0; k < 4; ++k) flatness *= flatness;
  samples.size = static_cast<float>(radius / max(flatness, kLeastFlatness));
  const std::array<Vec3, 3> axes = axes_of(m);
  Vec3 rest = m.normal;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 axis = axes[k];
    const double spread =
        dot(axis, Vec3{dot(m.spread[0], axis), dot(m.spread[1], axis), dot(m.spread[2], axis)}) / m.area;
    // As far out as Gauss's rule has its nodes.
    const double length = max(std::sqrt(3 * max(spread, 0)), 1e-3 * radius);
    Vec3 first, second;
    for (const Corners& at : patches) {
      const Vec3 normal = cross(at.b - at.a, at.c - at.a);
      const double a = dot(axis, at.a - m.centre), b = dot(axis, at.b - m.centre),
                   c = dot(axis, at.c - m.centre);
      const double middle = (a + b + c) / 3;
      first += middle * normal;
      second += ((a * a + b * b + c * c + 9 * middle * middle) / 12) * normal;
    }
    put(length * axis, samples.arm[k]);
    const Vec3 even = (0.5 / (length * length)) * second, odd = (0.5 / length) * first;
    put(even + odd, samples.weight[0][k]);
    put(even - odd, samples.weight[1][k]);
    rest -= 2.0 * even;
  }
  put(rest, samples.centre_weight);
  return samples;
}

}  // namespace lumbrical
