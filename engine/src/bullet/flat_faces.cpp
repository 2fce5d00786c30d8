#include "bullet/flat_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/share_along.h"
#include "model/convex_hull.h"
#include "model/mesh_edges.h"
#include "model/vertex_merge.h"

namespace lumbrical {
namespace {

// [m] So near to a plane, or to a line in it, a vertex lies in it.
constexpr double kFlat = 1e-6;

// A polygon of more has them so short that it is no better to stand on than what it is made of.
constexpr std::size_t kMostSides = 1000;

struct JoinedMesh {
  Mesh mesh;
  std::vector<std::uint32_t> first;  // vertex_merge.h
  // Of each triangle those beyond its edges, from each corner to the next; itself where not just one is.
  std::vector<std::array<std::uint32_t, 3>> beside;
};

// Which of a triangle's edges has these ends.
std::size_t edge_between(std::uint32_t a, std::uint32_t b, const Triangle& t) {
  return t[0] != a && t[0] != b ? 1 : t[1] != a && t[1] != b ? 2 : 0;
}

JoinedMesh join(Mesh mesh) {
  JoinedMesh joined{std::move(mesh), {}, {}};
  auto& [whole, first, beside] = joined;
  first = first_at_same_position(whole.vertices);
  beside.resize(whole.triangles.size());
  for (std::uint32_t t = 0; t < beside.size(); ++t) beside[t].fill(t);
  edges_of(whole, first).for_each([&joined](std::uint32_t low, std::span<const HalfEdge> around) {
    if (around.size() != 2) return;
    for (const std::size_t i : {0, 1}) {
      const std::uint32_t t = around[i].triangle();
      const Triangle corners = merged_corners(joined.mesh.triangles[t], joined.first);
      joined.beside[t][edge_between(low, around[i].high(), corners)] = around[1 - i].triangle();
    }
  });
  return joined;
}

// Twice the area, along the normal.
Vec3 area_of(const Mesh& mesh, std::uint32_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]);
}

// What lies in the plane of one triangle and hangs together with it.
struct Face {
  std::uint32_t seed;
  Vec3 point, normal;
  std::vector<std::uint32_t> triangles;
};

// Of each triangle its face, by its seed; kNone: none yet.
using FaceOf = std::vector<std::uint32_t>;
constexpr std::uint32_t kNone = 0xffffffff;

bool lies_in(const Face& face, const Mesh& mesh, std::uint32_t t) {
  const auto is_near = [&](std::uint32_t i) {
    return std::fabs(dot(face.normal, mesh.vertices[i] - face.point)) <= kFlat;
  };
  const auto& [a, b, c] = mesh.triangles[t];  // which may be a hair, whose normal says nothing
  const double hair =
      kFlat * (norm(mesh.vertices[b] - mesh.vertices[a]) + norm(mesh.vertices[c] - mesh.vertices[a]));
  return std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), is_near) &&
         dot(face.normal, area_of(mesh, t)) >= -hair;
}

Face grow_face(const JoinedMesh& joined, std::uint32_t seed, FaceOf& face_of) {
  const Mesh& mesh = joined.mesh;
  Face face{seed, mesh.vertices[mesh.triangles[seed][0]], unit_or(area_of(mesh, seed), {}), {seed}};
  face_of[seed] = seed;
  for (std::size_t i = 0; i < face.triangles.size(); ++i) {
    for (const std::uint32_t t : joined.beside[face.triangles[i]]) {
      if (face_of[t] != kNone || !lies_in(face, mesh, t)) continue;
      face_of[t] = seed;
      face.triangles.push_back(t);
    }
  }
  return face;
}

// By Euler: without a hole, however small. A rim is where no triangle of the same face goes on.
bool is_disc(const JoinedMesh& joined, const Face& face, std::size_t rim_edges) {
  std::vector<std::uint32_t> corners;
  for (const std::uint32_t t : face.triangles)
    for (const std::uint32_t corner : joined.mesh.triangles[t]) corners.push_back(joined.first[corner]);
  std::sort(corners.begin(), corners.end());
  const auto count = static_cast<std::size_t>(std::unique(corners.begin(), corners.end()) - corners.begin());
  return count + face.triangles.size() == (3 * face.triangles.size() + rim_edges) / 2 + 1;
}

// Each coordinate moves to the next place, `times` times; three times are none.
Vec3 moved_on(Vec3 p, int times) {
  for (; times > 0; --times) p = {p.z, p.x, p.y};
  return p;
}

// Of points in a plane, the right way round about its normal. What that has most of goes to y, where hulls
// don't look.
std::vector<Vec3> hull_of(std::vector<Vec3> points, Vec3 normal) {
  const double x = std::fabs(normal.x), y = std::fabs(normal.y), z = std::fabs(normal.z);
  const int times = x > y && x > z ? 1 : y > z ? 0 : 2;
  for (Vec3& p : points) p = moved_on(p, times);
  std::vector<Vec3> hull = convex_hull(std::move(points), 0);
  if (moved_on(normal, times).y > 0) std::reverse(hull.begin(), hull.end());
  for (Vec3& p : hull) p = moved_on(p, 3 - times);
  return hull;
}

double distance(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 axis = b - a, from = p - a;
  return norm(from - share_along(axis, from) * axis);
}

// Without corners that lie next to the line from the one kept before them to the one after.
std::vector<Vec3> straightened(std::vector<Vec3> hull) {
  const auto is_nearer = [from = hull[0]](Vec3 a, Vec3 b) { return norm(a - from) < norm(b - from); };
  std::rotate(hull.begin(), std::max_element(hull.begin(), hull.end(), is_nearer), hull.end());  // a corner
  std::vector<Vec3> kept;
  for (std::size_t i = 0, next = 0; i < hull.size(); i = next) {
    kept.push_back(hull[i]);
    const auto is_straight = [&](std::size_t end) {
      return std::all_of(hull.begin() + static_cast<std::ptrdiff_t>(i),
                         hull.begin() + static_cast<std::ptrdiff_t>(end),
                         [&](Vec3 p) { return distance(p, hull[i], hull[end % hull.size()]) <= kFlat; });
    };
    for (next = i + 1; next < hull.size() && is_straight(next + 1);) ++next;
  }
  return kept;
}

// The edges where a face does not go on, two ends of each.
std::vector<std::uint32_t> rim_of(const JoinedMesh& joined, const Face& face, const FaceOf& face_of) {
  std::vector<std::uint32_t> rim;
  for (const std::uint32_t t : face.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t other = joined.beside[t][k];
      if (other != t && face_of[other] == face.seed) continue;
      rim.push_back(joined.mesh.triangles[t][k]);
      rim.push_back(joined.mesh.triangles[t][(k + 1) % 3]);
    }
  }
  return rim;
}

// The corners of the convex polygon that a face fills; none where it doesn't. One without a hole does where
// its whole rim lies on the polygon's.
std::vector<Vec3> polygon_of(const JoinedMesh& joined, const Face& face, const FaceOf& face_of) {
  const std::vector<std::uint32_t> rim = rim_of(joined, face, face_of);
  if (!is_disc(joined, face, rim.size() / 2)) return {};
  std::vector<Vec3> points;
  for (const std::uint32_t i : rim) points.push_back(joined.mesh.vertices[i]);
  std::vector<Vec3> hull = hull_of(points, face.normal);
  if (hull.size() < 3) return {};
  const std::vector<Vec3> corners = straightened(std::move(hull));
  if (corners.size() < 3 || corners.size() > kMostSides) return {};
  const auto is_on_outline = [&](Vec3 p) {
    for (std::size_t i = 0; i < corners.size(); ++i)
      if (distance(p, corners[i], corners[(i + 1) % corners.size()]) <= 2 * kFlat) return true;
    return false;
  };
  return std::all_of(points.begin(), points.end(), is_on_outline) ? corners : std::vector<Vec3>();
}

// What of a polygon lies between the corners from `first` to `last` and the line that joins them.
void cut_between(std::uint32_t first, std::uint32_t last, std::uint32_t start, std::uint32_t count,
                 Mesh& to) {
  if (last - first < 2) return;
  const std::uint32_t middle = (first + last) / 2;
  to.triangles.push_back({start + first, start + middle, start + last % count});
  cut_between(first, middle, start, count, to);
  cut_between(middle, last, start, count, to);
}

void add_polygon(const std::vector<Vec3>& corners, Mesh& to) {
  const auto start = static_cast<std::uint32_t>(to.vertices.size()),
             count = static_cast<std::uint32_t>(corners.size());
  to.vertices.insert(to.vertices.end(), corners.begin(), corners.end());
  const std::uint32_t a = count / 3, b = 2 * count / 3;
  to.triangles.push_back({start, start + a, start + b});
  cut_between(0, a, start, count, to);
  cut_between(a, b, start, count, to);
  cut_between(b, count, start, count, to);
}

// The largest first: their planes are known best.
std::vector<std::uint32_t> by_area(const Mesh& mesh) {
  std::vector<double> square;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 area = area_of(mesh, t);
    square.push_back(dot(area, area));
  }
  std::vector<std::uint32_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto s, auto t) { return square[s] > square[t]; });
  while (!order.empty() && !(square[order.back()] > 0)) order.pop_back();
  return order;
}

}  // namespace

Mesh with_whole_faces(const Triangles& triangles, const std::vector<std::uint32_t>& chosen) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < triangles.x.size(); ++i) mesh.vertices.push_back(triangles.vertex(i));
  for (const std::uint32_t t : chosen)
    mesh.triangles.push_back({triangles.a[t], triangles.b[t], triangles.c[t]});
  const JoinedMesh joined = join(std::move(mesh));
  Mesh whole{joined.mesh.vertices, {}};
  FaceOf face_of(joined.mesh.triangles.size(), kNone);
  for (const std::uint32_t seed : by_area(joined.mesh)) {
    if (face_of[seed] != kNone) continue;
    const Face face = grow_face(joined, seed, face_of);
    const std::vector<Vec3> corners = polygon_of(joined, face, face_of);
    if (corners.size() >= 3 && corners.size() - 2 < face.triangles.size()) {
      add_polygon(corners, whole);
    } else {
      for (const std::uint32_t t : face.triangles) whole.triangles.push_back(joined.mesh.triangles[t]);
    }
  }
  return whole;
}

}  // namespace lumbrical
