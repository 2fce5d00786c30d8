// Reads the polygons of a Wavefront OBJ file; everything else in it (materials, groups, normals, texture
// coordinates, lines, points, curves, unknown keywords) is passed over.
#include <algorithm>

#include "base/text_cursor.h"
#include "model/mesh_formats.h"
#include "model/polygons.h"

namespace lumbrical {
namespace {

/// A corner that names a vertex the file has not given yet; only the end of the file shows whether it will.
struct ForwardReference {
  std::int64_t index;
  TextPlace place;
};

struct ObjReader {
  TextCursor cursor;
  const std::string& name;
  Mesh& mesh;
  std::vector<std::uint32_t> polygon;                // of the current face
  std::vector<ForwardReference> forward_references;  // each larger than the one before
  PolygonCutter polygons;
};

Status out_of_range(const ObjReader& reader, TextPlace place, std::int64_t index) {
  const std::string count = std::to_string(reader.mesh.vertices.size());
  if (index < 0) {
    return text_error(reader.name, place,
                      "vertex index " + std::to_string(index) + " reaches back further than the " + count +
                          " vertices given so far; re-export the mesh");
  }
  return text_error(
      reader.name, place,
      "vertex index " + std::to_string(index) + " is out of range 1.." + count + "; re-export the mesh");
}

Status read_vertex(ObjReader& reader) {
  if (reader.mesh.vertices.size() == kMaxVertexCount) {
    return text_error(reader.name, reader.cursor.place(), "more than 2^32 - 2 vertices; split the mesh");
  }
  Vec3 point;
  if (Status status = read_point(reader.cursor, reader.name, point); !status.ok()) return status;
  reader.mesh.vertices.push_back(point);
  return {};  // a weight or a colour may follow; neither changes the shape
}

/// A corner is v, v/vt, v//vn or v/vt/vn; only v counts.
Status read_corner(ObjReader& reader, std::string_view word) {
  const TextPlace place = reader.cursor.place();
  const std::size_t slash = std::min(word.find('/'), word.size());
  std::int64_t index = 0;
  if (!read_integer(word.substr(0, slash), index) ||
      word.find_first_not_of("+-0123456789/", slash) != std::string_view::npos) {
    return text_error(reader.name, place,
                      "corner " + in_quotes(word) + " is not of the form 1, 1/2, 1//3 or 1/2/3");
  }
  if (index == 0) {
    return text_error(reader.name, place,
                      "vertex index 0; OBJ counts from 1, so add 1 to every index or re-export");
  }
  const auto given = static_cast<std::int64_t>(reader.mesh.vertices.size());
  if (index < -given || index > static_cast<std::int64_t>(kMaxVertexCount))
    return out_of_range(reader, place, index);
  if (index > given &&
      (reader.forward_references.empty() || index > reader.forward_references.back().index)) {
    reader.forward_references.push_back({index, place});
  }
  reader.polygon.push_back(static_cast<std::uint32_t>(index > 0 ? index - 1 : given + index));
  return {};
}

Status read_face(ObjReader& reader) {
  const TextPlace place = reader.cursor.place();
  reader.polygon.clear();
  for (std::string_view word = reader.cursor.word(); !word.empty(); word = reader.cursor.word()) {
    if (Status status = read_corner(reader, word); !status.ok()) return status;
  }
  if (reader.polygon.size() < 3) {
    return text_error(reader.name, place,
                      "a face needs at least 3 corners, this one has " +
                          std::to_string(reader.polygon.size()) + "; delete or repair the face");
  }
  reader.polygons.append(reader.polygon, place.line);
  return {};
}

/// The first bad reference of the file is larger than all references before it, so it is among those kept.
Status check_forward_references(const ObjReader& reader) {
  for (const ForwardReference& reference : reader.forward_references) {
    if (reference.index > static_cast<std::int64_t>(reader.mesh.vertices.size())) {
      return out_of_range(reader, reference.place, reference.index);
    }
  }
  return {};
}

}  // namespace

Status parse_obj(std::string_view content, const std::string& name, Mesh& mesh) {
  const TextRules rules{.hash_comments = true, .backslash_continues = true};
  ObjReader reader{TextCursor(content, rules), name, mesh, {}, {}, PolygonCutter(mesh)};
  while (reader.cursor.next_line()) {
    const std::string_view keyword = reader.cursor.word();
    Status status;
    if (keyword == "v") status = read_vertex(reader);
    if (keyword == "f" || keyword == "fo") status = read_face(reader);  // fo is the old spelling
    if (!status.ok()) return status;
  }
  if (Status status = check_forward_references(reader); !status.ok()) return status;
  if (const auto line = reader.polygons.finish()) return text_error(name, {*line, 1}, kTooConcave);
  return {};
}

}  // namespace lumbrical
