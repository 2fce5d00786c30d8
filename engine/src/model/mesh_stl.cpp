// Reads STL, binary and ASCII, whatever the header or the file name claims: a file is binary when its size is
// exactly what its triangle count asks for, and otherwise when it is not text that begins with "solid".
#include <bit>
#include <cmath>

#include "base/text_cursor.h"
#include "model/mesh_formats.h"
#include "model/vertex_merge.h"

namespace lumbrical {
namespace {

constexpr std::size_t kHeaderSize = 84;    // 80 bytes of anything, then the triangle count
constexpr std::size_t kTriangleSize = 50;  // normal and three corners as floats, then two bytes of attributes
constexpr std::size_t kNormalSize = 12;

bool has_binary_size(std::string_view content) {
  return content.size() >= kHeaderSize &&
         content.size() == kHeaderSize + kTriangleSize * std::uint64_t{little_endian_u32(content, 80)};
}

/// Text that begins with "solid". The count and the first triangle of a binary file lie within the bytes
/// looked at, and have control characters unless they are made up to deceive.
bool is_ascii_stl(std::string_view content) {
  constexpr std::size_t kLookedAt = 1024;
  for (const char c : content.substr(0, kLookedAt)) {
    if (static_cast<unsigned char>(c) < ' ' && !(c >= '\t' && c <= '\r')) return false;
  }
  TextCursor cursor(content.substr(0, kLookedAt));
  return lower_case(cursor.word_across_lines()) == "solid";
}

// ---- Binary ----

Status check_binary_size(std::string_view content, const std::string& name) {
  if (content.size() < kHeaderSize) {
    return byte_error(name, content.size(),
                      "the file ends within the 84 bytes of a binary STL header; export it again");
  }
  const std::uint64_t counted = little_endian_u32(content, 80);
  const std::uint64_t held = (content.size() - kHeaderSize) / kTriangleSize;
  const std::string counted_text = "the header counts " + std::to_string(counted) + " triangles";
  if (held < counted) {
    return byte_error(name, content.size(),
                      "the file ends here, but " + counted_text + "; " + std::to_string(counted - held) +
                          " are missing or incomplete; copy or export it again");
  }
  if (!has_binary_size(content)) {
    const std::uint64_t end = kHeaderSize + kTriangleSize * counted;
    return byte_error(name, end,
                      counted_text + ", but " + std::to_string(content.size() - end) +
                          " more bytes follow; export it again");
  }
  return {};
}

Status read_binary_corner(std::string_view content, const std::string& name, std::size_t at, Vec3& corner) {
  double coordinate[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t byte = at + 4 * axis;
    coordinate[axis] = static_cast<double>(std::bit_cast<float>(little_endian_u32(content, byte)));
    if (!std::isfinite(coordinate[axis])) {
      return byte_error(name, byte,
                        "a coordinate of triangle " + std::to_string((at - kHeaderSize) / kTriangleSize) +
                            " (from 0) is not finite; repair or re-export the mesh");
    }
  }
  corner = {coordinate[0], coordinate[1], coordinate[2]};
  return {};
}

Status parse_binary(std::string_view content, const std::string& name, std::vector<Vec3>& corners) {
  if (Status status = check_binary_size(content, name); !status.ok()) return status;
  const std::size_t triangle_count = (content.size() - kHeaderSize) / kTriangleSize;
  corners.resize(3 * triangle_count);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::size_t at = kHeaderSize + i / 3 * kTriangleSize + kNormalSize + i % 3 * 12;
    if (Status status = read_binary_corner(content, name, at, corners[i]); !status.ok()) return status;
  }
  return {};
}

// ---- ASCII ----

Status unexpected(const TextCursor& cursor, const std::string& name, std::string_view word,
                  const char* wanted) {
  const std::string found = word.empty() ? "the file ends" : "found " + in_quotes(word);
  return text_error(name, cursor.place(), found + " where '" + wanted + "' is expected; export it again");
}

Status expect(TextCursor& cursor, const std::string& name, const char* keyword) {
  const std::string_view word = cursor.word_across_lines();
  return lower_case(word) == keyword ? Status() : unexpected(cursor, name, word, keyword);
}

/// From behind "facet" to "endfacet". The normal is passed over, however it looks: the corners' order tells.
Status read_facet(TextCursor& cursor, const std::string& name, std::vector<Vec3>& corners) {
  if (Status status = expect(cursor, name, "normal"); !status.ok()) return status;
  std::string_view word = cursor.word_across_lines();
  for (int i = 0; i < 3 && lower_case(word) != "outer"; ++i) word = cursor.word_across_lines();
  if (lower_case(word) != "outer") return unexpected(cursor, name, word, "outer loop");
  if (Status status = expect(cursor, name, "loop"); !status.ok()) return status;
  for (int i = 0; i < 3; ++i) {
    if (Status status = expect(cursor, name, "vertex"); !status.ok()) return status;
    if (Status status = read_point(cursor, name, corners.emplace_back()); !status.ok()) return status;
  }
  if (Status status = expect(cursor, name, "endloop"); !status.ok()) return status;
  return expect(cursor, name, "endfacet");
}

/// Leaves the line that closes a solid: "endsolid" or, as some write, "end solid".
Status read_end(TextCursor& cursor, const std::string& name, std::string_view word) {
  const bool two_words = lower_case(word) == "end";
  if (two_words) word = cursor.word();
  if (lower_case(word) == (two_words ? "solid" : "endsolid")) return {};
  return unexpected(cursor, name, word, "facet' or 'endsolid");
}

/// One or more solids; their names may be anything up to the end of the line.
Status parse_ascii(std::string_view content, const std::string& name, std::vector<Vec3>& corners) {
  TextCursor cursor(content);
  for (;;) {
    if (Status status = expect(cursor, name, "solid"); !status.ok()) return status;
    cursor.skip_line();
    std::string_view word = cursor.word_across_lines();
    while (lower_case(word) == "facet") {
      if (Status status = read_facet(cursor, name, corners); !status.ok()) return status;
      word = cursor.word_across_lines();
    }
    if (Status status = read_end(cursor, name, word); !status.ok()) return status;
    if (!cursor.next_line()) return {};
  }
}

}  // namespace

bool is_stl_content(std::string_view content) { return has_binary_size(content) || is_ascii_stl(content); }

Status parse_stl(std::string_view content, const std::string& name, Mesh& mesh) {
  const bool ascii = !has_binary_size(content) && is_ascii_stl(content);
  std::vector<Vec3>& corners = mesh.vertices;
  const Status status = ascii ? parse_ascii(content, name, corners) : parse_binary(content, name, corners);
  if (!status.ok()) return status;
  if (corners.size() > kMaxVertexCount) {
    return Status::error(name + ": more than 2^32 - 2 corners; split the mesh");
  }
  mesh.triangles.reserve(corners.size() / 3);
  for (std::uint32_t i = 0; i < corners.size(); i += 3) mesh.triangles.push_back({i, i + 1, i + 2});
  merge_vertices(mesh);
  return {};
}

}  // namespace lumbrical
