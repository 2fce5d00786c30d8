// See mesh_fix.h.
#include "lumbrical/mesh_fix.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <new>
#include <utility>
#include <vector>

#include "base/floating_point.h"
#include "files/text_output.h"
#include "model/mesh_winding.h"
#include "model/triangle_shape.h"
#include "model/vertex_merge.h"

namespace lumbrical {
namespace {

bool is_degenerate(const Mesh& mesh, const Triangle& triangle) {
  double largest = 0;
  for (const std::uint32_t corner : triangle) largest = max(largest, largest_of(mesh.vertices[corner]));
  int exponent = 0;
  static_cast<void>(std::frexp(largest, &exponent));
  std::array<Vec3, 3> p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = scaled_down(mesh.vertices[triangle[k]], exponent);
  return shape_of(measure_triangle(p[0], p[1], p[2])) == TriangleShape::collinear;
}

// The same whichever corner a triangle begins with, but not whichever way it is wound.
Triangle from_least_corner(Triangle triangle) {
  std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
  return triangle;
}

// Leaves out what stands in the list already.
std::size_t leave_out_duplicates(std::vector<Triangle>& triangles) {
  std::vector<std::pair<Triangle, std::size_t>> sorted;
  for (const Triangle& triangle : triangles) sorted.emplace_back(from_least_corner(triangle), sorted.size());
  std::sort(sorted.begin(), sorted.end());
  std::vector<bool> is_second(triangles.size(), false);
  for (std::size_t i = 1; i < sorted.size(); ++i)
    is_second[sorted[i].second] = sorted[i].first == sorted[i - 1].first;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (!is_second[i]) triangles[kept++] = triangles[i];
  const std::size_t left_out = triangles.size() - kept;
  triangles.resize(kept);
  return left_out;
}

void append(double number, std::string& text) {
  std::array<char, 32> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), number);
  text += ' ';
  text.append(digits.data(), end);
}

Status write_obj(const Mesh& mesh, TextOutput& out) {
  std::string line;
  for (const Vec3& vertex : mesh.vertices) {
    line = "v";
    for (const double coordinate : {vertex.x, vertex.y, vertex.z}) append(coordinate, line);
    if (Status status = out.line(line); !status.ok()) return status;
  }
  for (const Triangle& triangle : mesh.triangles) {
    line = "f";
    for (const std::uint32_t corner : triangle) line += ' ' + std::to_string(std::uint64_t{corner} + 1);
    if (Status status = out.line(line); !status.ok()) return status;
  }
  return {};
}

}  // namespace

Mesh fixed_mesh(const Mesh& mesh, FixReport& report) {
  const FloatingPointGuard guard;
  Mesh fixed = mesh;
  report.winding =
      wind_outwards(fixed);  // with all triangles: those without area still join their neighbours
  close_cracks(fixed);
  Mesh kept{fixed.vertices, {}};
  for (const Triangle& triangle : fixed.triangles) {
    if (!is_degenerate(fixed, triangle)) kept.triangles.push_back(triangle);
  }
  report.degenerate_triangles = fixed.triangles.size() - kept.triangles.size();
  merge_vertices(kept);
  report.merged_vertices = fixed.vertices.size() - kept.vertices.size();
  report.duplicate_triangles = leave_out_duplicates(kept.triangles);
  return kept;
}

Status save_obj(const std::string& path, const Mesh& mesh) try {
  return write_whole<TextOutput>(path, [&mesh](TextOutput& out) { return write_obj(mesh, out); });
} catch (const std::bad_alloc&) {
  return Status::error(path + ": not enough memory to write the mesh");
}

}  // namespace lumbrical
