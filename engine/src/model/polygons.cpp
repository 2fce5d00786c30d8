// See polygons.h. Ears are cut off one after the other (Meisters 1975): an ear is a convex corner whose
// triangle holds no other corner.
#include "model/polygons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "model/mesh_formats.h"

namespace lumbrical {
namespace {

/// Of a polygon's area squared: folds below it are rounding of the file's numbers and are not felt.
constexpr double kFold = 1e-6;

constexpr double kFlat = 1e-10;  // of a triangle's height over its width

/// How many corners to look at for each of a polygon's, in the mean: the time is that of the file's size. A
/// third as many corners never take more, and larger polygons hardly ever: only what is beside an ear is
/// looked at.
constexpr std::size_t kLooksPerCorner = 4096;

struct FlatPoint {
  double x = 0, y = 0;
  friend bool operator==(const FlatPoint&, const FlatPoint&) = default;
};

// Twice the area, positive where the corners go counter-clockwise.
double doubled_area(FlatPoint a, FlatPoint b, FlatPoint c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double squared_distance(FlatPoint a, FlatPoint b) {
  return (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
}

Vec3 area_vector(const Mesh& mesh, const Triangle& t) {
  const Vec3 a = mesh.vertices[t[0]];
  return cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
}

Vec3 area_vector(const Mesh& mesh, std::span<const Triangle> triangles) {
  Vec3 sum;
  for (const Triangle& t : triangles) sum += area_vector(mesh, t);
  return sum;
}

// What of the triangles faces against all of them together, as a share. 0 where numbers overflow.
double folded_share(const Mesh& mesh, std::span<const Triangle> triangles) {
  const Vec3 sum = area_vector(mesh, triangles);
  double folded = 0;
  for (const Triangle& t : triangles) {
    const double along = dot(area_vector(mesh, t), sum);
    if (along < 0) folded -= along;
  }
  const double share = folded / dot(sum, sum);
  return share > 0 ? share : 0;
}

// Without the coordinate that says least, so that the others keep their bits; counter-clockwise.
FlatPoint flattened(Vec3 p, Vec3 normal) {
  const double x = std::fabs(normal.x), y = std::fabs(normal.y), z = std::fabs(normal.z);
  FlatPoint flat{p.x, p.y};
  double up = normal.z;
  if (x >= y && x >= z) {
    flat = {p.y, p.z};
    up = normal.x;
  } else if (y >= z) {
    flat = {p.z, p.x};
    up = normal.y;
  }
  return up > 0 ? flat : FlatPoint{flat.y, flat.x};
}

// What is left of a polygon from which ears are cut.
struct Outline {
  std::vector<std::uint32_t> vertex;
  std::vector<FlatPoint> point;
  std::vector<std::uint32_t> before, after;  // the neighbours that are left
  std::vector<std::uint32_t> by_x;
  std::vector<bool> gone;
  std::size_t looks_left = 0;
  bool flat_too = false;
};

Outline outline_of(const Mesh& mesh, std::span<const Triangle> fan) {
  Outline outline;
  outline.vertex = {fan[0][0], fan[0][1]};
  for (const Triangle& t : fan) outline.vertex.push_back(t[2]);
  const Vec3 normal = area_vector(mesh, fan);
  const auto count = static_cast<std::uint32_t>(outline.vertex.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    outline.point.push_back(flattened(mesh.vertices[outline.vertex[i]], normal));
    outline.before.push_back((i + count - 1) % count);
    outline.after.push_back((i + 1) % count);
    outline.by_x.push_back(i);
  }
  const std::vector<FlatPoint>& point = outline.point;
  std::sort(outline.by_x.begin(), outline.by_x.end(), [&point](std::uint32_t a, std::uint32_t b) {
    return point[a].x != point[b].x ? point[a].x < point[b].x : a < b;
  });
  outline.gone.resize(count);
  outline.looks_left = kLooksPerCorner * count;
  return outline;
}

// Does the triangle hold a corner that is left, on its edges or beyond them by an area as small as
// `rounding`? Those at its own corners are the other ends of cuts to holes.
bool holds_a_corner(Outline& outline, FlatPoint a, FlatPoint b, FlatPoint c, double rounding) {
  const auto [low, high] = std::minmax({a.x, b.x, c.x});
  auto at = std::partition_point(outline.by_x.begin(), outline.by_x.end(),
                                 [&outline, low = low](std::uint32_t i) { return outline.point[i].x < low; });
  for (; at != outline.by_x.end() && outline.looks_left > 0; ++at) {
    --outline.looks_left;
    const FlatPoint p = outline.point[*at];
    if (p.x > high) return false;
    if (outline.gone[*at] || p == a || p == b || p == c) continue;
    if (doubled_area(a, b, p) >= -rounding && doubled_area(b, c, p) >= -rounding &&
        doubled_area(c, a, p) >= -rounding)
      return true;
  }
  return false;
}

// Where two of the three coincide there is nothing to hold: that is cut off wherever it is. So is what is
// flat, once there is no other ear.
bool is_ear(Outline& outline, std::uint32_t corner) {
  const FlatPoint a = outline.point[outline.before[corner]], b = outline.point[corner],
                  c = outline.point[outline.after[corner]];
  if (a == b || b == c || c == a) return true;
  const double longest = max(squared_distance(a, b), max(squared_distance(b, c), squared_distance(c, a)));
  const double area = doubled_area(a, b, c), rounding = kFlat * longest;
  if (outline.flat_too && std::fabs(area) <= rounding) return true;
  return area > 0 && !holds_a_corner(outline, a, b, c, outline.flat_too ? 0 : rounding);
}

Triangle cut_off(Outline& outline, std::uint32_t corner) {
  const std::uint32_t before = outline.before[corner], after = outline.after[corner];
  outline.after[before] = after;
  outline.before[after] = before;
  outline.gone[corner] = true;
  return {outline.vertex[before], outline.vertex[corner], outline.vertex[after]};
}

std::uint32_t a_corner_left(const Outline& outline) {
  return static_cast<std::uint32_t>(std::find(outline.gone.begin(), outline.gone.end(), false) -
                                    outline.gone.begin());
}

// A list of whose turn it is to be cut off. Corners beside an ear that was cut have to wait for all others:
// so triangles stay compact. A corner of which neither neighbour is cut remains no ear.
struct Turns {
  std::vector<std::uint32_t> corner;
  std::vector<std::size_t> last;  // of each corner

  explicit Turns(std::size_t corner_count) : last(corner_count) {}
  void append(std::uint32_t next) {
    last[next] = corner.size();
    corner.push_back(next);
  }
  void append_left(const Outline& outline) {
    for (std::uint32_t i = 0; i < last.size(); ++i)
      if (!outline.gone[i]) append(i);
  }
};

// Fewer triangles than the polygon has where it crosses itself.
std::vector<Triangle> cut_ears(Outline& outline) {
  const std::size_t count = outline.vertex.size();
  Turns turns(count);
  turns.append_left(outline);
  std::vector<Triangle> cut;
  for (std::size_t i = 0; i < turns.corner.size() && cut.size() + 3 < count && outline.looks_left > 0; ++i) {
    const std::uint32_t corner = turns.corner[i];
    if (!outline.gone[corner] && turns.last[corner] == i && is_ear(outline, corner)) {
      cut.push_back(cut_off(outline, corner));
      turns.append(outline.before[corner]);
      turns.append(outline.after[corner]);
    }
    if (i + 1 == turns.corner.size() && !outline.flat_too) {
      outline.flat_too = true;
      turns.append_left(outline);
    }
  }
  if (cut.size() + 3 == count) cut.push_back(cut_off(outline, a_corner_left(outline)));
  return cut;
}

}  // namespace

void PolygonCutter::append(const std::vector<std::uint32_t>& corners, std::size_t place) {
  const std::size_t first = mesh_.triangles.size();
  append_fan(corners, mesh_);
  if (corners.size() == 3) return;
  const Waiting polygon{first, static_cast<std::uint32_t>(corners.size() - 2), place};
  if (*std::max_element(corners.begin(), corners.end()) < mesh_.vertices.size())
    recut(polygon);
  else
    waiting_.push_back(polygon);
}

std::optional<std::size_t> PolygonCutter::finish() {
  for (const Waiting& polygon : waiting_) recut(polygon);
  return refused_;
}

void PolygonCutter::recut(const Waiting& polygon) {
  const std::span<Triangle> fan(&mesh_.triangles[polygon.first], polygon.triangle_count);
  const double folded = folded_share(mesh_, fan);
  if (refused_ || !(folded > kFold)) return;
  Outline outline = outline_of(mesh_, fan);
  const std::vector<Triangle> cut = cut_ears(outline);
  if (outline.looks_left == 0) refused_ = polygon.place;
  if (cut.size() == fan.size() && folded_share(mesh_, cut) < folded)
    std::copy(cut.begin(), cut.end(), fan.begin());
}

}  // namespace lumbrical
