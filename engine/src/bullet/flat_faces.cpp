#include "bullet/flat_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "model/convex_hull.h"
#include "model/mesh_edges.h"
#include "model/vertex_merge.h"

namespace lumbrical {
namespace {

// [m] So near to a plane, or to a line in it, a vertex lies in it.
constexpr double kFlat = 1e-6;

// Of each triangle those beyond its edges, or itself where no or more than one other shares an edge.
using Neighbours = std::vector<std::array<std::uint32_t, 3>>;

Neighbours neighbours_of(const Mesh& mesh) {
  Neighbours beside(mesh.triangles.size());
  for (std::uint32_t t = 0; t < beside.size(); ++t) beside[t].fill(t);
  const auto put = [&](std::uint32_t of, std::uint32_t other) {
    *std::find(beside[of].begin(), beside[of].end() - 1, of) = other;
  };
  edges_of(mesh, first_at_same_position(mesh.vertices))
      .for_each([&](std::uint32_t, std::span<const HalfEdge> around) {
        if (around.size() != 2) return;
        put(around[0].triangle(), around[1].triangle());
        put(around[1].triangle(), around[0].triangle());
      });
  return beside;
}

// Twice the area, along the normal.
Vec3 area_of(const Mesh& mesh, std::uint32_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]);
}

// What lies in the plane of one triangle and hangs together with it.
struct Face {
  Vec3 point, normal;
  double extent = 0;  // [m] of its corners' box
  std::vector<std::uint32_t> triangles;
};

bool lies_in(const Face& face, const Mesh& mesh, std::uint32_t t) {
  const auto is_near = [&](std::uint32_t i) {
    return std::fabs(dot(face.normal, mesh.vertices[i] - face.point)) <= kFlat;
  };
  return std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), is_near) &&
         dot(face.normal, area_of(mesh, t)) >= 0;
}

Face grow_face(const Mesh& mesh, const Neighbours& beside, std::uint32_t seed, std::vector<bool>& taken) {
  Face face{mesh.vertices[mesh.triangles[seed][0]], unit_or(area_of(mesh, seed), {}), 0, {seed}};
  taken[seed] = true;
  Box box;
  for (std::size_t i = 0; i < face.triangles.size(); ++i) {
    for (const std::uint32_t corner : mesh.triangles[face.triangles[i]]) box.add(mesh.vertices[corner], 0);
    for (const std::uint32_t t : beside[face.triangles[i]]) {
      if (taken[t] || !lies_in(face, mesh, t)) continue;
      taken[t] = true;
      face.triangles.push_back(t);
    }
  }
  face.extent = norm(box.upper - box.lower);
  return face;
}

// Turns the coordinate that a face's normal has most of to the middle, where hulls don't look; and back.
struct View {
  int middle;
  explicit View(Vec3 normal) {
    const Vec3 size{std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)};
    middle = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
  }
  [[nodiscard]] Vec3 seen(Vec3 p) const {
    return middle == 0 ? Vec3{p.z, p.x, p.y} : middle == 1 ? p : Vec3{p.y, p.z, p.x};
  }
  [[nodiscard]] Vec3 back(Vec3 p) const {
    return middle == 0 ? Vec3{p.y, p.z, p.x} : middle == 1 ? p : Vec3{p.z, p.x, p.y};
  }
};

// The corners of the convex polygon that a face fills; none where it doesn't.
std::vector<Vec3> polygon_of(const Mesh& mesh, const Face& face) {
  const View view(face.normal);
  std::vector<Vec3> points;
  double area = 0;
  for (const std::uint32_t t : face.triangles) {
    area += std::fabs(view.seen(area_of(mesh, t)).y);
    for (const std::uint32_t corner : mesh.triangles[t]) points.push_back(view.seen(mesh.vertices[corner]));
  }
  std::vector<Vec3> hull = convex_hull(std::move(points), kFlat * face.extent);
  double hull_area = 0;
  for (std::size_t i = 2; i < hull.size(); ++i)
    hull_area += std::fabs(cross(hull[i - 1] - hull[0], hull[i] - hull[0]).y);
  if (hull.size() < 3 || std::fabs(hull_area - area) > 8 * kFlat * face.extent) return {};
  if (view.seen(face.normal).y > 0) std::reverse(hull.begin(), hull.end());
  for (Vec3& p : hull) p = view.back(p);
  return hull;
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
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    square.push_back(dot(area_of(mesh, t), area_of(mesh, t)));
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
  const Neighbours beside = neighbours_of(mesh);
  Mesh whole{mesh.vertices, {}};
  std::vector<bool> taken(mesh.triangles.size());
  for (const std::uint32_t seed : by_area(mesh)) {
    if (taken[seed]) continue;
    const Face face = grow_face(mesh, beside, seed, taken);
    const std::vector<Vec3> corners = polygon_of(mesh, face);
    if (corners.size() >= 3 && corners.size() - 2 < face.triangles.size()) {
      add_polygon(corners, whole);
    } else {
      for (const std::uint32_t t : face.triangles) whole.triangles.push_back(mesh.triangles[t]);
    }
  }
  return whole;
}

}  // namespace lumbrical
