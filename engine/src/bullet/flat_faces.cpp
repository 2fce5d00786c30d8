#include "bullet/flat_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "model/convex_hull.h"
#include "model/mesh_edges.h"
#include "model/vertex_merge.h"

namespace lumbrical {
namespace {

// [m] So near to a plane, or to a line in it, a vertex lies in it.
constexpr double kFlat = 1e-6;

struct JoinedMesh {
  Mesh mesh;
  std::vector<std::uint32_t> first;  // vertex_merge.h
  // Of each triangle those beyond its edges, or itself where no or more than one other shares an edge.
  std::vector<std::array<std::uint32_t, 3>> beside;
};

JoinedMesh join(Mesh mesh) {
  JoinedMesh joined{std::move(mesh), {}, {}};
  auto& [whole, first, beside] = joined;
  first = first_at_same_position(whole.vertices);
  beside.resize(whole.triangles.size());
  for (std::uint32_t t = 0; t < beside.size(); ++t) beside[t].fill(t);
  edges_of(whole, first).for_each([&joined](std::uint32_t, std::span<const HalfEdge> around) {
    if (around.size() != 2) return;
    for (const std::size_t i : {0, 1}) {
      const std::uint32_t t = around[i].triangle();
      auto& of = joined.beside[t];
      *std::find(of.begin(), of.end() - 1, t) = around[1 - i].triangle();
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
  double extent = 0;  // [m] of its corners' box
  std::vector<std::uint32_t> triangles;
};

constexpr std::uint32_t kNone = 0xffffffff;

bool lies_in(const Face& face, const Mesh& mesh, std::uint32_t t) {
  const auto is_near = [&](std::uint32_t i) {
    return std::fabs(dot(face.normal, mesh.vertices[i] - face.point)) <= kFlat;
  };
  return std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), is_near) &&
         dot(face.normal, area_of(mesh, t)) >= 0;
}

// `face_of`: each triangle's face, by its seed; kNone: none yet.
Face grow_face(const JoinedMesh& joined, std::uint32_t seed, std::vector<std::uint32_t>& face_of) {
  const Mesh& mesh = joined.mesh;
  Face face{seed, mesh.vertices[mesh.triangles[seed][0]], unit_or(area_of(mesh, seed), {}), 0, {seed}};
  face_of[seed] = seed;
  Box box;
  for (std::size_t i = 0; i < face.triangles.size(); ++i) {
    for (const std::uint32_t corner : mesh.triangles[face.triangles[i]]) box.add(mesh.vertices[corner], 0);
    for (const std::uint32_t t : joined.beside[face.triangles[i]]) {
      if (face_of[t] != kNone || !lies_in(face, mesh, t)) continue;
      face_of[t] = seed;
      face.triangles.push_back(t);
    }
  }
  face.extent = norm(box.upper - box.lower);
  return face;
}

// By Euler: without a hole, however small.
bool is_disc(const JoinedMesh& joined, const Face& face, const std::vector<std::uint32_t>& face_of) {
  std::vector<std::uint32_t> corners;
  std::size_t half_edges = 3 * face.triangles.size();  // those of the rim twice
  for (const std::uint32_t t : face.triangles) {
    for (const std::uint32_t corner : joined.mesh.triangles[t]) corners.push_back(joined.first[corner]);
    for (const std::uint32_t other : joined.beside[t])
      half_edges += other == t || face_of[other] != face.seed;
  }
  std::sort(corners.begin(), corners.end());
  const auto last = std::unique(corners.begin(), corners.end());
  const auto count = static_cast<std::size_t>(last - corners.begin());
  return count + face.triangles.size() == half_edges / 2 + 1;
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
  const JoinedMesh joined = join(std::move(mesh));
  Mesh whole{joined.mesh.vertices, {}};
  std::vector<std::uint32_t> face_of(joined.mesh.triangles.size(), kNone);
  for (const std::uint32_t seed : by_area(joined.mesh)) {
    if (face_of[seed] != kNone) continue;
    const Face face = grow_face(joined, seed, face_of);
    const std::vector<Vec3> corners =
        is_disc(joined, face, face_of) ? polygon_of(joined.mesh, face) : std::vector<Vec3>();
    if (corners.size() >= 3 && corners.size() - 2 < face.triangles.size()) {
      add_polygon(corners, whole);
    } else {
      for (const std::uint32_t t : face.triangles) whole.triangles.push_back(joined.mesh.triangles[t]);
    }
  }
  return whole;
}

}  // namespace lumbrical
