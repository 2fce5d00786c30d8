// Casts a ray along +x from the extreme vertices of every part, and counts which parts it crosses, and which
// way: their winding number there. Points are put into bins of the plane across the rays, so each triangle is
// looked at once.
#include "model/part_nesting.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>

namespace lumbrical {
namespace {

constexpr std::size_t kMostBins = 1024;                       // along each side
constexpr std::uint64_t kMostWork = std::uint64_t{1} << 30;   // pairs of point and triangle, at most
constexpr std::size_t kMostCrossings = std::size_t{1} << 22;  // at most, or two per triangle

struct Ray {
  Vec3 from;
  std::uint32_t part, number;
};

// Twice the area of the projected triangle (from, to, p), with the ends of the edge in one order, so that
// both triangles of an edge come to the same sign. A point on the line counts as shifted a little to +y, then
// to +z: no ray meets an edge or a vertex.
struct Side {
  double area = 0;
  int sign = 0;
};

Side side_of(const Vec3& from, const Vec3& to, const Vec3& p) {
  const bool swapped = std::pair(to.y, to.z) < std::pair(from.y, from.z);
  const Vec3 &low = swapped ? to : from, &high = swapped ? from : to;
  const double dy = high.y - low.y, dz = high.z - low.z;
  const double area = dy * (p.z - low.z) - dz * (p.y - low.y);
  const double decides = area != 0 ? area : dz != 0 ? -dz : dy;
  const int sign = decides > 0 ? 1 : decides < 0 ? -1 : 0;
  return swapped ? Side{-area, -sign} : Side{area, sign};
}

// +1 where the ray leaves a triangle's back, -1 where it enters its front, 0 where it misses.
int crossing(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Side ab = side_of(a, b, ray.from), bc = side_of(b, c, ray.from), ca = side_of(c, a, ray.from);
  if (ab.sign == 0 || ab.sign != bc.sign || bc.sign != ca.sign) return 0;
  const double sum = ab.area + bc.area + ca.area;
  const double x = sum == 0 ? a.x : (bc.area * a.x + ca.area * b.x + ab.area * c.x) / sum;
  return x > ray.from.x ? ab.sign : 0;
}

/// Rays by where they stand in y and z.
struct Bins {
  double y = 0, z = 0, y_size = 1, z_size = 1;
  std::size_t side = 1;
  std::vector<std::uint32_t> start;
  std::vector<Ray> ray;

  explicit Bins(const std::vector<Ray>& rays) {
    Box box;
    for (const Ray& r : rays) box.add(r.from);
    side = std::clamp<std::size_t>(static_cast<std::size_t>(std::sqrt(rays.size())), 1, kMostBins);
    y = box.lower.y;
    z = box.lower.z;
    const double y_step = (box.upper.y - box.lower.y) / static_cast<double>(side);
    const double z_step = (box.upper.z - box.lower.z) / static_cast<double>(side);
    if (y_step > 0) y_size = y_step;
    if (z_step > 0) z_size = z_step;
    start.assign(side * side + 1, 0);
    for (const Ray& r : rays) ++start[place(r.from) + 1];
    for (std::size_t i = 0; i < side * side; ++i) start[i + 1] += start[i];
    std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
    ray.resize(rays.size());
    for (const Ray& r : rays) ray[next[place(r.from)]++] = r;
  }
  [[nodiscard]] std::size_t along(double offset, double size) const {
    return static_cast<std::size_t>(std::clamp(offset / size, 0.0, static_cast<double>(side - 1)));
  }
  [[nodiscard]] std::size_t place(const Vec3& p) const {
    return along(p.y - y, y_size) * side + along(p.z - z, z_size);
  }
};

bool holds(const Box& outer, const Box& inner) {
  return outer.lower.x <= inner.lower.x && inner.upper.x <= outer.upper.x && outer.lower.y <= inner.lower.y &&
         inner.upper.y <= outer.upper.y && outer.lower.z <= inner.lower.z && inner.upper.z <= outer.upper.z;
}

struct Crossing {
  Nested pair;
  std::uint32_t ray;
  int sign;
};

// Pairs whose crossings come to a winding number other than 0 on each of the inner part's rays.
void keep_wound(std::vector<Crossing>& crossings, std::size_t rays_per_part, std::vector<Nested>& nested) {
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    return std::pair(a.pair, a.ray) < std::pair(b.pair, b.ray);
  });
  for (std::size_t i = 0; i < crossings.size();) {
    const Nested pair = crossings[i].pair;
    std::size_t wound = 0;
    while (i < crossings.size() && crossings[i].pair == pair) {
      const std::uint32_t ray = crossings[i].ray;
      int winding = 0;
      for (; i < crossings.size() && crossings[i].pair == pair && crossings[i].ray == ray; ++i)
        winding += crossings[i].sign;
      wound += winding != 0 ? 1 : 0;
    }
    if (wound == rays_per_part) nested.push_back(pair);
  }
}

}  // namespace

bool MeshPart::closed() const {
  // A hole of a few hundredths of the surface leaves no doubt which side is outside; a volume of nothing
  // does.
  constexpr double kMostHoles = 0.05, kLeastVolume = 1e-9;
  return triangles >= kFewestEnclosing && !twisted && hole_area <= kMostHoles * area &&
         std::fabs(volume) > kLeastVolume * area * std::sqrt(area);
}

bool find_nested(const Mesh& mesh, const std::vector<std::uint32_t>& part_of,
                 const std::vector<std::uint8_t>& reversed, const std::vector<MeshPart>& parts,
                 std::vector<Nested>& nested) {
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    if (!parts[i].closed()) continue;
    for (std::uint32_t k = 0; k < parts[i].extreme.size(); ++k) rays.push_back({parts[i].extreme[k], i, k});
  }
  nested.clear();
  if (rays.size() <= std::tuple_size_v<decltype(MeshPart::extreme)>) return true;
  const Bins bins(rays);
  std::vector<Crossing> crossings;
  const std::size_t most_crossings = std::max(kMostCrossings, 2 * mesh.triangles.size());
  std::uint64_t work = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t outer = part_of[i];
    if (outer == kNoPart || !parts[outer].closed()) continue;
    const Triangle& t = mesh.triangles[i];
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    Box box;
    for (const Vec3& p : {a, b, c}) box.add(p);
    const std::size_t y_end = bins.along(box.upper.y - bins.y, bins.y_size) + 1;
    const std::size_t z_end = bins.along(box.upper.z - bins.z, bins.z_size) + 1;
    const std::size_t z_begin = bins.along(box.lower.z - bins.z, bins.z_size);
    for (std::size_t y = bins.along(box.lower.y - bins.y, bins.y_size); y < y_end; ++y) {
      const std::uint32_t end = bins.start[y * bins.side + z_end];
      const std::uint32_t begin = bins.start[y * bins.side + z_begin];
      if ((work += 1 + end - begin) > kMostWork || crossings.size() > most_crossings)
        return nested.clear(), false;
      for (std::uint32_t k = begin; k < end; ++k) {
        const Ray& ray = bins.ray[k];
        if (ray.part == outer || !holds(parts[outer].box, parts[ray.part].box)) continue;
        const int sign = crossing(ray, a, b, c);
        if (sign != 0) crossings.push_back({{ray.part, outer}, ray.number, reversed[i] ? -sign : sign});
      }
    }
  }
  keep_wound(crossings, std::tuple_size_v<decltype(MeshPart::extreme)>, nested);
  return true;
}

}  // namespace lumbrical
