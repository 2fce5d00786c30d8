#include "index/block_samples.h"

#include <cmath>

namespace lumbrical {
namespace {

// What the rule leaves out, fields quadratic along two axes at once, vanishes where all patches face one way.
// Blocks count as larger by the sixteenth power of how flat they are, at most so many times.
constexpr double kLeastFlatness = 1e-6;

// Coordinates of second moments.
constexpr std::size_t kOf[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

using Triple = std::array<double, 3>;
Triple triple(Vec3 v) { return {v.x, v.y, v.z}; }

template <class Weight>
void add(const Moments<Weight>& more, Moments<Weight>& to) {
  to.sum += more.sum;
  for (std::size_t i = 0; i < 3; ++i) to.first[i] += more.first[i];
  for (std::size_t k = 0; k < 6; ++k) to.second[k] += more.second[k];
}

// With h counted from an origin from which the old one is seen at `at`.
template <class Weight>
Moments<Weight> moved(Moments<Weight> m, const Triple& at) {
  for (std::size_t k = 0; k < 6; ++k) {
    const auto [i, j] = kOf[k];
    m.second[k] += at[i] * m.first[j] + at[j] * m.first[i] + (at[i] * at[j]) * m.sum;
  }
  for (std::size_t i = 0; i < 3; ++i) m.first[i] += at[i] * m.sum;
  return m;
}

BlockMoments seen_from(Vec3 origin, const BlockMoments& block) {
  const Triple at = triple(block.origin - origin);
  return {origin, moved(block.area, at), moved(block.normal, at)};
}

/// Means over a triangle of h and h h: of its corners by a twelfth each, of its centroid by nine.
struct Means {
  Triple first;
  double second[6];
};
Means means_of(const Triple& a, const Triple& b, const Triple& c) {
  Means means;
  for (std::size_t i = 0; i < 3; ++i) means.first[i] = (a[i] + b[i] + c[i]) / 3;
  for (std::size_t k = 0; k < 6; ++k) {
    const auto [i, j] = kOf[k];
    means.second[k] = (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + 9 * (means.first[i] * means.first[j])) / 12;
  }
  return means;
}

template <class Weight>
void add(const Means& means, const Weight& weight, Moments<Weight>& to) {
  to.sum += weight;
  for (std::size_t i = 0; i < 3; ++i) to.first[i] += means.first[i] * weight;
  for (std::size_t k = 0; k < 6; ++k) to.second[k] += means.second[k] * weight;
}

// Along directions.
template <class Weight>
Weight first_along(const Moments<Weight>& m, const Triple& u) {
  return u[0] * m.first[0] + u[1] * m.first[1] + u[2] * m.first[2];
}
template <class Weight>
Weight second_along(const Moments<Weight>& m, const Triple& u, const Triple& v) {
  Weight sum{};
  for (std::size_t k = 0; k < 6; ++k) {
    const auto [i, j] = kOf[k];
    sum += (i == j ? u[i] * v[i] : u[i] * v[j] + u[j] * v[i]) * m.second[k];
  }
  return sum;
}

// Principal directions of the area's spread within the plane across `normal`, and that.
std::array<Vec3, 3> axes_of(const Moments<double>& area, Vec3 normal) {
  const Vec3 z = unit_or(normal, {0, 0, 1});
  const Vec3 x = unit_or(cross(z, std::fabs(z.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}), {1, 0, 0}),
             y = cross(z, x);
  const double a = second_along(area, triple(x), triple(x)), b = second_along(area, triple(x), triple(y)),
               d = second_along(area, triple(y), triple(y)), half = 0.5 * (a - d);
  const double root = std::sqrt(half * half + b * b);
  // Of the two ways to write the larger one's direction the one that does not cancel.
  const Vec3 u = unit_or(half > 0 ? (half + root) * x + b * y : b * x + (root - half) * y, x);
  return {u, cross(z, u), z};
}

}  // namespace

BlockMoments moments_of(std::span<const Corners> patches) {
  BlockMoments block{patches[0].a, {}, {}};
  for (const Corners& at : patches) {
    const Vec3 a = at.a - block.origin, b = at.b - block.origin, c = at.c - block.origin;
    const Vec3 normal = cross(b - a, c - a);
    const Means means = means_of(triple(a), triple(b), triple(c));
    add(means, norm(normal), block.area);
    add(means, normal, block.normal);
  }
  return block;
}

BlockMoments moments_of(std::span<const BlockMoments> blocks) {
  BlockMoments all{blocks[0].origin, {}, {}};
  for (const BlockMoments& block : blocks) {
    const BlockMoments seen = seen_from(all.origin, block);
    add(seen.area, all.area);
    add(seen.normal, all.normal);
  }
  return all;
}

Vec3 centre_of(const BlockMoments& block) {
  const auto& [x, y, z] = block.area.first;
  return block.area.sum > 0 ? block.origin + Vec3{x, y, z} / block.area.sum : block.origin;
}

BlockSamples samples_of(const BlockMoments& block, double radius) {
  const auto [centre, area, normal] = seen_from(centre_of(block), block);
  BlockSamples samples{};
  samples.centre = split_point(centre);
  samples.radius = static_cast<float>((1 + 1e-6) * radius);
  double flatness = norm(normal.sum) / area.sum;
  for (int k = 0; k < 4; ++k) flatness *= flatness;
  samples.size = static_cast<float>(radius / max(flatness, kLeastFlatness));
  put(normal.sum, samples.normal);
  const std::array<Vec3, 3> axes = axes_of(area, normal.sum);
  Vec3 rest = normal.sum;
  for (std::size_t k = 0; k < 3; ++k) {
    const Triple axis = triple(axes[k]);
    const double spread = second_along(area, axis, axis) / area.sum;
    // As far out as Gauss's rule has its nodes.
    const double length = max(std::sqrt(3 * max(spread, 0)), 1e-3 * radius);
    if (!(length > 0)) continue;  // all of it is at the centre
    put(length * axes[k], samples.arm[k]);
    const Vec3 even = (0.5 / (length * length)) * second_along(normal, axis, axis),
               odd = (0.5 / length) * first_along(normal, axis);
    put(even + odd, samples.weight[0][k]);
    put(even - odd, samples.weight[1][k]);
    rest -= 2.0 * even;
  }
  put(rest, samples.centre_weight);
  return samples;
}

}  // namespace lumbrical
