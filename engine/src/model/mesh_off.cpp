// Reads Geomview's OFF text format: counts, vertices, polygons; normals, colours and texture coordinates that
// follow on a line are passed over.

#include "base/text_cursor.h"
#include "model/mesh_formats.h"
#include "model/polygons.h"

namespace lumbrical {
namespace {

/// The part of a keyword line's first word behind "OFF", or the whole word where it is no OFF keyword.
std::string_view behind_keyword(std::string_view word) {
  std::string_view rest = word;
  for (const std::string_view prefix : {"ST", "C", "N"}) {
    if (rest.substr(0, prefix.size()) == prefix) rest.remove_prefix(prefix.size());
  }
  if (rest.substr(0, 3) != "OFF") return word;
  return rest.substr(3);
}

struct OffReader {
  TextCursor cursor;
  const std::string& name;
  Mesh& mesh;
  PolygonCutter polygons;
  std::size_t vertex_count = 0;
  std::size_t face_count = 0;
};

Status read_count(OffReader& reader, std::string_view word, const char* what, std::size_t& count) {
  std::int64_t value = 0;
  if (!read_integer(word, value) || value < 0) {
    return text_error(reader.name, reader.cursor.place(),
                      "expected the number of " + std::string(what) + ", found " + in_quotes(word) +
                          "; re-export the mesh");
  }
  // A vertex takes 6 bytes at least ("0 0 0" and a line end), a face 8: what cannot fit is not worth a try.
  if (static_cast<std::uint64_t>(value) > reader.cursor.remaining() / 6 + 1) {
    return text_error(reader.name, reader.cursor.place(),
                      std::to_string(value) + " " + what + " do not fit into the " +
                          std::to_string(reader.cursor.remaining()) + " bytes that follow; export it again");
  }
  count = static_cast<std::size_t>(value);
  return {};
}

/// The keyword is optional; the counts stand on its line, glued to it, or on the next line with a word.
Status read_header(OffReader& reader) {
  TextCursor& cursor = reader.cursor;
  cursor.next_line();
  std::string_view word = cursor.word();
  if (is_off_keyword(word)) {
    word = behind_keyword(word);
    if (word.empty()) word = cursor.word();
  } else if (word.size() > 3 && word.substr(word.size() - 3) == "OFF") {
    return text_error(reader.name, cursor.place(),
                      in_quotes(word) +
                          " is not supported, only OFF with the prefixes ST, C "
                          "and N in three dimensions; export as plain OFF");
  }
  if (word.empty() && cursor.next_line()) word = cursor.word();
  if (word == "BINARY") {
    return text_error(reader.name, cursor.place(), "binary OFF is not supported; export as text, PLY or STL");
  }
  if (Status status = read_count(reader, word, "vertices", reader.vertex_count); !status.ok()) return status;
  if (Status status = read_count(reader, cursor.word(), "faces", reader.face_count); !status.ok())
    return status;
  if (reader.vertex_count > kMaxVertexCount) {
    return text_error(reader.name, cursor.place(), "more than 2^32 - 2 vertices; split the mesh");
  }
  return {};  // the number of edges may follow; nobody keeps it right
}

/// Moves to the next line with words, which must be there.
Status start_row(OffReader& reader, const char* what, std::size_t index, std::size_t count) {
  if (reader.cursor.next_line()) return {};
  return text_error(reader.name, reader.cursor.place(),
                    "the file ends after " + std::to_string(index) + " of " + std::to_string(count) + " " +
                        what + "; export it again");
}

Status read_face(OffReader& reader, std::vector<std::uint32_t>& polygon) {
  TextCursor& cursor = reader.cursor;
  std::string_view word = cursor.word();
  std::int64_t corner_count = 0;
  if (!read_integer(word, corner_count) || corner_count < 3) {
    return text_error(reader.name, cursor.place(),
                      "a face begins with its number of corners, 3 or more, not with " + in_quotes(word) +
                          "; repair or re-export the mesh");
  }
  polygon.clear();
  for (std::int64_t i = 0; i < corner_count; ++i) {
    word = cursor.word();
    if (word.empty()) {
      return text_error(reader.name, cursor.place(),
                        "the line ends after " + std::to_string(i) + " of " + std::to_string(corner_count) +
                            " corners; re-export the mesh");
    }
    std::int64_t index = -1;
    if (!read_integer(word, index) || index < 0 || static_cast<std::uint64_t>(index) >= reader.vertex_count) {
      return text_error(reader.name, cursor.place(),
                        "vertex index " + in_quotes(word) + " is not one of the " +
                            std::to_string(reader.vertex_count) +
                            " vertices (counted from 0); re-export the mesh");
    }
    polygon.push_back(static_cast<std::uint32_t>(index));
  }
  reader.polygons.append(polygon, cursor.place().line);
  return {};
}

}  // namespace

bool is_off_keyword(std::string_view word) {
  const std::string_view rest = behind_keyword(word);
  return rest.size() < word.size() && (rest.empty() || (rest[0] >= '0' && rest[0] <= '9'));
}

Status parse_off(std::string_view content, const std::string& name, Mesh& mesh) {
  OffReader reader{TextCursor(content, {.hash_comments = true}), name, mesh, PolygonCutter(mesh)};
  if (Status status = read_header(reader); !status.ok()) return status;
  mesh.vertices.resize(reader.vertex_count);
  for (std::size_t i = 0; i < reader.vertex_count; ++i) {
    if (Status status = start_row(reader, "vertices", i, reader.vertex_count); !status.ok()) return status;
    if (Status status = read_point(reader.cursor, name, mesh.vertices[i]); !status.ok()) return status;
  }
  mesh.triangles.reserve(reader.face_count);
  std::vector<std::uint32_t> polygon;
  for (std::size_t i = 0; i < reader.face_count; ++i) {
    if (Status status = start_row(reader, "faces", i, reader.face_count); !status.ok()) return status;
    if (Status status = read_face(reader, polygon); !status.ok()) return status;
  }
  if (reader.cursor.next_line()) {
    return text_error(name, reader.cursor.place(),
                      "more follows than the " + std::to_string(reader.face_count) +
                          " faces the header counts; export it again");
  }
  if (const auto line = reader.polygons.finish()) return text_error(name, {*line, 1}, kTooConcave);
  return {};
}

}  // namespace lumbrical
