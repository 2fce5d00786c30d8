#include "lumbrical/mesh_fix.h"

#include <array>
#include <charconv>
#include <new>

#include "files/text_output.h"
#include "model/vertex_merge.h"

namespace lumbrical {
namespace {

// As inspect_mesh judges it, alone.
bool is_degenerate(const Mesh& mesh, const Triangle& triangle) {
  Mesh alone;
  for (const std::uint32_t corner : triangle) alone.vertices.push_back(mesh.vertices[corner]);
  alone.triangles.push_back({0, 1, 2});
  return inspect_mesh(alone).degenerate > 0;
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
  Mesh fixed = mesh;
  report.winding =
      wind_outwards(fixed);  // with all triangles: those without area still join their neighbours
  Mesh kept{fixed.vertices, {}};
  for (const Triangle& triangle : fixed.triangles) {
    if (!is_degenerate(fixed, triangle)) kept.triangles.push_back(triangle);
  }
  report.degenerate_triangles = fixed.triangles.size() - kept.triangles.size();
  merge_vertices(kept);
  report.merged_vertices = fixed.vertices.size() - kept.vertices.size();
  return kept;
}

Status save_obj(const std::string& path, const Mesh& mesh) try {
  TextOutput out;
  if (Status status = out.open(path); !status.ok()) return status;
  Status status = write_obj(mesh, out);
  if (status.ok()) status = out.close();
  if (!status.ok()) out.discard();
  return status;
} catch (const std::bad_alloc&) {
  return Status::error(path + ": not enough memory to write the mesh");
}

}  // namespace lumbrical
