// Finds what is wrong with a triangle mesh. Vertices count as one where their positions are exactly equal,
// and every list is sorted by a key without ties, so that the report is the same everywhere.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>
#include <tuple>

#include "base/disjoint_sets.h"
#include "base/floating_point.h"
#include "lumbrical/mesh.h"
#include "model/mesh_edges.h"
#include "model/triangle_shape.h"
#include "model/vertex_merge.h"

namespace lumbrical {
namespace {

constexpr std::size_t kExamplesPerKind = 3;

struct Subject {
  const Mesh& mesh;
  std::vector<std::uint32_t> first;  // vertex -> the first vertex at its position
  int exponent = 0;                  // no coordinate exceeds 2^exponent metres
  Vec3 scaled(std::uint32_t vertex) const { return scaled_down(mesh.vertices[vertex], exponent); }
  Triangle merged(std::size_t triangle) const { return merged_corners(mesh.triangles[triangle], first); }
};

struct Examples {
  std::vector<std::string>& list;
  std::size_t given = 0;
  bool wanted() { return given++ < kExamplesPerKind; }
};

// ---- Vertices and bounding box ----

Subject look_at_vertices(const Mesh& mesh, MeshReport& report) {
  Subject subject{mesh, first_at_same_position(mesh.vertices)};
  report.triangles = mesh.triangles.size();
  report.vertices = mesh.vertices.size();
  std::vector<bool> used(mesh.vertices.size(), false);
  bool any = false;
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      assert(corner < mesh.vertices.size());
      if (used[corner]) continue;
      used[corner] = true;
      const Vec3& p = mesh.vertices[corner];
      report.lower =
          any ? Vec3{min(report.lower.x, p.x), min(report.lower.y, p.y), min(report.lower.z, p.z)} : p;
      report.upper =
          any ? Vec3{max(report.upper.x, p.x), max(report.upper.y, p.y), max(report.upper.z, p.z)} : p;
      any = true;
    }
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (subject.first[i] == i) ++report.merged_vertices;
    if (!used[i]) ++report.unused_vertices;
  }
  static_cast<void>(std::frexp(max(largest_of(report.lower), largest_of(report.upper)), &subject.exponent));
  return subject;
}

// ---- Shape of each triangle ----

std::string named(std::size_t triangle) { return "triangle " + std::to_string(triangle); }

std::string why_degenerate(const Subject& subject, std::size_t triangle) {
  const Triangle& t = subject.mesh.triangles[triangle];
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t a = t[i], b = t[(i + 1) % 3];
    if (subject.first[a] != subject.first[b]) continue;
    if (a == b) return "corner " + std::to_string(a) + " occurs twice";
    return "corners " + std::to_string(std::min(a, b)) + " and " + std::to_string(std::max(a, b)) +
           " coincide";
  }
  return "corners " + std::to_string(t[0]) + ", " + std::to_string(t[1]) + " and " + std::to_string(t[2]) +
         " are collinear";
}

struct Sums {  // in powers of 2^exponent metres
  double area = 0, volume = 0, shortest_edge = 0, longest_edge = 0;
};

void include_edges(const std::array<double, 3>& lengths, Sums& sums) {
  for (const double length : lengths) {
    if (length == 0) continue;  // coinciding corners are reported as such
    sums.shortest_edge = sums.shortest_edge == 0 ? length : min(sums.shortest_edge, length);
    sums.longest_edge = max(sums.longest_edge, length);
  }
}

void measure_triangles(const Subject& subject, MeshReport& report) {
  Sums sums;
  Examples degenerates{report.examples}, slivers{report.examples};
  const double half = std::ldexp(0.5, -subject.exponent);
  const Vec3 centre =
      half * report.lower + half * report.upper;  // an open mesh's volume depends on the origin
  for (std::size_t i = 0; i < subject.mesh.triangles.size(); ++i) {
    const Triangle& t = subject.mesh.triangles[i];
    const Vec3 p = subject.scaled(t[0]), q = subject.scaled(t[1]), r = subject.scaled(t[2]);
    const TriangleMeasures measures = measure_triangle(p, q, r);
    std::array<double, 3> lengths{};
    for (std::size_t k = 0; k < 3; ++k) lengths[k] = std::sqrt(measures.squared_edges[k]) * measures.unit;
    include_edges(lengths, sums);
    sums.area += 0.5 * measures.doubled_area * measures.unit * measures.unit;
    sums.volume += dot(p - centre, cross(q - centre, r - centre)) / 6.0;

    const TriangleShape shape = shape_of(measures);
    if (corners_coincide(subject.merged(i)) || shape == TriangleShape::collinear) {
      ++report.degenerate;
      if (degenerates.wanted()) {
        report.examples.push_back(named(i) + " is degenerate (" + why_degenerate(subject, i) + ")");
      }
    } else if (shape == TriangleShape::sliver) {
      ++report.sliver;
      if (slivers.wanted()) report.examples.push_back(named(i) + " is a sliver (an angle below 1 degree)");
    }
  }
  report.area = std::ldexp(sums.area, 2 * subject.exponent);
  report.volume = std::ldexp(sums.volume, 3 * subject.exponent);
  report.shortest_edge = std::ldexp(sums.shortest_edge, subject.exponent);
  report.longest_edge = std::ldexp(sums.longest_edge, subject.exponent);
}

// ---- Duplicates ----

struct SortedCorners {
  Triangle corners;
  std::size_t triangle;
  friend bool operator<(const SortedCorners& a, const SortedCorners& b) {
    return std::tie(a.corners, a.triangle) < std::tie(b.corners, b.triangle);
  }
};

void count_duplicates(const Subject& subject, MeshReport& report) {
  std::vector<SortedCorners> sorted;
  sorted.reserve(subject.mesh.triangles.size());
  for (std::size_t i = 0; i < subject.mesh.triangles.size(); ++i) {
    sorted.push_back({subject.merged(i), i});
    std::sort(sorted.back().corners.begin(), sorted.back().corners.end());
  }
  std::sort(sorted.begin(), sorted.end());
  Examples examples{report.examples};
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i].corners != sorted[i - 1].corners) continue;
    ++report.duplicate;
    if (examples.wanted()) {
      report.examples.push_back(named(sorted[i].triangle) + " repeats " + named(sorted[i - 1].triangle));
    }
  }
}

// ---- Edges ----

std::string named(std::uint32_t low, HalfEdge half) {
  return "edge " + std::to_string(low) + "-" + std::to_string(half.high());
}

struct EdgeExamples {
  Examples boundary, non_manifold, misoriented;
};

void judge_edge(std::uint32_t low, std::span<const HalfEdge> edge, MeshReport& report,
                EdgeExamples& examples) {
  if (edge.size() == 1) {
    ++report.boundary_edges;
    if (examples.boundary.wanted()) {
      report.examples.push_back(named(low, edge[0]) + " is open (only " + named(edge[0].triangle()) +
                                " has it)");
    }
  } else if (edge.size() > 2) {
    ++report.non_manifold_edges;
    if (examples.non_manifold.wanted()) {
      report.examples.push_back(named(low, edge[0]) + " is not manifold (" + std::to_string(edge.size()) +
                                " triangles share it, the first is " + named(edge[0].triangle()) + ")");
    }
  } else if (edge[0].upwards() == edge[1].upwards()) {
    ++report.misoriented_edges;
    if (examples.misoriented.wanted()) {
      report.examples.push_back(named(low, edge[0]) + " is misoriented (" + named(edge[0].triangle()) +
                                " and " + named(edge[1].triangle()) +
                                " run through it in the same direction)");
    }
  }
}

void count_edges(const Subject& subject, MeshReport& report) {
  const MeshEdges edges = edges_of(subject.mesh, subject.first);
  DisjointSets parts(subject.mesh.triangles.size());
  EdgeExamples examples{{report.examples}, {report.examples}, {report.examples}};
  edges.for_each([&](std::uint32_t low, std::span<const HalfEdge> edge) {
    for (const HalfEdge half : edge) parts.join(edge[0].triangle(), half.triangle());
    judge_edge(low, edge, report, examples);
  });
  for (std::size_t i = 0; i < subject.mesh.triangles.size(); ++i) {
    const bool counted = !corners_coincide(subject.merged(i));
    if (counted && parts.find(static_cast<std::uint32_t>(i)) == i) ++report.components;
  }
  report.watertight = !edges.half.empty() && report.boundary_edges == 0 && report.non_manifold_edges == 0 &&
                      report.misoriented_edges == 0;
}

}  // namespace

Box bounding_box(const Mesh& mesh) {
  Box box;
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) box.add(mesh.vertices[corner]);
  }
  return box;
}

MeshReport inspect_mesh(const Mesh& mesh) {
  const FloatingPointGuard guard;
  MeshReport report;
  const Subject subject = look_at_vertices(mesh, report);
  measure_triangles(subject, report);
  count_duplicates(subject, report);
  count_edges(subject, report);
  return report;
}

}  // namespace lumbrical
