#include "sphere_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "triangle_bound.h"

namespace lumbrical {
namespace {

constexpr std::uint32_t kWidth = SphereTree::kWidth;

// Single precision moves centres and radii by less than this share of their size; bounds are widened by it.
constexpr double kFloatSlack = 4e-7;

struct Sphere {
  Vec3 centre;  // relative to the tree's origin
  double radius = 0;
};

// Bits of a 21-bit number spread three apart.
std::uint64_t spread(std::uint64_t bits) {
  bits &= 0x1fffff;
  bits = (bits | bits << 32) & 0x1f00000000ffffu;
  bits = (bits | bits << 16) & 0x1f0000ff0000ffu;
  bits = (bits | bits << 8) & 0x100f00f00f00f00fu;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3u;
  bits = (bits | bits << 2) & 0x1249249249249249u;
  return bits;
}

struct Key {
  std::uint64_t morton;
  std::uint32_t triangle;
  friend bool operator<(const Key& a, const Key& b) {
    return a.morton != b.morton ? a.morton < b.morton : a.triangle < b.triangle;
  }
};

struct Box {
  Vec3 lower{1e300, 1e300, 1e300}, upper{-1e300, -1e300, -1e300};
  void add(Vec3 p, double r) {
    lower = {min(lower.x, p.x - r), min(lower.y, p.y - r), min(lower.z, p.z - r)};
    upper = {max(upper.x, p.x + r), max(upper.y, p.y + r), max(upper.z, p.z + r)};
  }
  [[nodiscard]] Vec3 middle() const { return 0.5 * lower + 0.5 * upper; }
};

std::uint64_t morton_of(Vec3 p, const Box& box) {
  const Vec3 size = box.upper - box.lower;
  const double longest = max(size.x, max(size.y, size.z));
  const double scale = longest > 0 ? 2097151.0 / longest : 0;
  const auto cell = [&](double x, double low) {
    return static_cast<std::uint64_t>(clamp((x - low) * scale, 0, 2097151));
  };
  return spread(cell(p.x, box.lower.x)) | spread(cell(p.y, box.lower.y)) << 1 |
         spread(cell(p.z, box.lower.z)) << 2;
}

Sphere bound(std::span<const Sphere> spheres) {
  Box box;
  for (const Sphere& sphere : spheres) box.add(sphere.centre, sphere.radius);
  Sphere result{box.middle(), 0};
  for (const Sphere& sphere : spheres) {
    result.radius = max(result.radius, norm(sphere.centre - result.centre) + sphere.radius);
  }
  return result;
}

std::vector<Sphere> bound_groups(const std::vector<Sphere>& spheres, std::size_t size) {
  std::vector<Sphere> groups;
  groups.reserve(spheres.size() / size + 1);
  for (std::size_t i = 0; i < spheres.size(); i += size) {
    groups.push_back(bound(std::span(spheres).subspan(i, std::min(size, spheres.size() - i))));
  }
  return groups;
}

SphereTree::Level to_level(const std::vector<Sphere>& spheres) {
  SphereTree::Level level;
  level.count = static_cast<std::uint32_t>(spheres.size());
  const std::size_t padded = (spheres.size() + kWidth - 1) / kWidth * kWidth;
  level.x.resize(padded);
  level.y.resize(padded);
  level.z.resize(padded);
  level.r.assign(padded, -1e30f);  // padding: no reach makes up for this
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const Vec3 c = spheres[i].centre;
    level.x[i] = static_cast<float>(c.x);
    level.y[i] = static_cast<float>(c.y);
    level.z[i] = static_cast<float>(c.z);
    const double size = max(std::fabs(c.x), max(std::fabs(c.y), std::fabs(c.z))) + spheres[i].radius;
    level.r[i] = static_cast<float>(spheres[i].radius + kFloatSlack * size);
  }
  return level;
}

// A primitive as the traversal sees it: a thick segment in single precision, widened for its rounding.
struct Query {
  float x, y, z, dx, dy, dz, inverse, reach;
};

Query query_of(const SphereTree& tree, const Primitive& primitive) {
  const Vec3 from = primitive.end1 - tree.origin, axis = primitive.end2 - primitive.end1;
  const double square = dot(axis, axis);
  const double size = max(std::fabs(from.x), max(std::fabs(from.y), std::fabs(from.z))) + norm(axis);
  const double reach = 1.00001 * max(primitive.radius1, primitive.radius2) + 4 * kFloatSlack * size;
  return {static_cast<float>(from.x),
          static_cast<float>(from.y),
          static_cast<float>(from.z),
          static_cast<float>(axis.x),
          static_cast<float>(axis.y),
          static_cast<float>(axis.z),
          static_cast<float>(square > 1e-20 ? 1 / square : 0),
          static_cast<float>(reach)};
}

// Which of eight spheres the thick segment may meet. Written so that the compiler makes it one vector
// operation each.
unsigned test_group(const SphereTree::Level& level, std::size_t first, const Query& q) {
  float excess[kWidth];
  for (std::size_t k = 0; k < kWidth; ++k) {
    const float px = level.x[first + k] - q.x, py = level.y[first + k] - q.y, pz = level.z[first + k] - q.z;
    float t = (px * q.dx + py * q.dy + pz * q.dz) * q.inverse;
    t = t < 0.0f ? 0.0f : t;
    t = t > 1.0f ? 1.0f : t;
    const float gx = px - t * q.dx, gy = py - t * q.dy, gz = pz - t * q.dz;
    const float reach = level.r[first + k] + q.reach;
    const float square = reach > 0.0f ? reach * reach : -1.0f;
    excess[k] = (gx * gx + gy * gy + gz * gz) * 0.99999f - square;
  }
  unsigned mask = 0;
  for (std::size_t k = 0; k < kWidth; ++k) mask |= static_cast<unsigned>(excess[k] <= 0.0f) << k;
  return mask;
}

}  // namespace

SphereTree build_tree(const Triangles& triangles, std::uint32_t leaf_size, std::uint32_t levels) {
  SphereTree tree;
  tree.leaf_size = leaf_size;
  const auto count = static_cast<std::uint32_t>(triangles.size());
  if (count == 0) return tree;
  std::vector<TriangleBound> bounds(count);
  Box box;
  for (std::uint32_t i = 0; i < count; ++i) {
    bounds[i] = bound_triangle(triangles, i);
    box.add(bounds[i].centre, 0);
  }
  tree.origin = box.middle();
  std::vector<Key> keys(count);
  for (std::uint32_t i = 0; i < count; ++i) keys[i] = {morton_of(bounds[i].centre, box), i};
  std::sort(keys.begin(), keys.end());

  std::vector<Sphere> spheres(count);
  tree.triangle.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    tree.triangle[i] = keys[i].triangle;
    spheres[i] = {bounds[keys[i].triangle].centre - tree.origin, bounds[keys[i].triangle].radius};
  }
  spheres = bound_groups(spheres, leaf_size);
  tree.levels.push_back(to_level(spheres));
  while (spheres.size() > kWidth && (levels == 0 || tree.levels.size() < levels)) {
    spheres = bound_groups(spheres, kWidth);
    tree.levels.push_back(to_level(spheres));
  }
  return tree;
}

std::size_t frontier_capacity(const SphereTree& tree) {
  return tree.levels.empty() ? 0 : tree.levels.front().count + kWidth;
}

std::span<const std::uint32_t> query_tree(const SphereTree& tree, const Primitive& primitive,
                                          std::array<std::vector<std::uint32_t>, 2>& frontier) {
  if (tree.levels.empty()) return {};
  const Query query = query_of(tree, primitive);
  std::size_t level = tree.levels.size() - 1;
  std::size_t hit_count = 0;
  const auto test = [&](std::uint32_t group, std::vector<std::uint32_t>& hits) {
    unsigned mask = test_group(tree.levels[level], std::size_t{group} * kWidth, query);
    for (; mask != 0; mask &= mask - 1) {
      hits[hit_count++] = group * kWidth + static_cast<std::uint32_t>(std::countr_zero(mask));
    }
  };
  const auto groups = static_cast<std::uint32_t>(tree.levels[level].x.size() / kWidth);
  for (std::uint32_t group = 0; group < groups; ++group) test(group, frontier[0]);
  while (level > 0) {
    --level;
    // A sphere that was hit is the bound of the group of the same number one level down.
    const std::size_t parents = hit_count;
    hit_count = 0;
    for (std::size_t i = 0; i < parents; ++i) test(frontier[0][i], frontier[1]);
    std::swap(frontier[0], frontier[1]);
  }
  return {frontier[0].data(), hit_count};
}

}  // namespace lumbrical
