// The readers behind load_mesh, one per file format, and what they share.
//
// All readers fill an empty mesh with the numbers of the file as they stand (no unit), answer errors with the
// place in the file, and allocate no more than a small multiple of the file's size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "lumbrical/mesh.h"
#include "lumbrical/status.h"

namespace lumbrical {

Status parse_obj(std::string_view content, const std::string& name, Mesh& mesh);
Status parse_stl(std::string_view content, const std::string& name, Mesh& mesh);
Status parse_ply(std::string_view content, const std::string& name, Mesh& mesh);
Status parse_off(std::string_view content, const std::string& name, Mesh& mesh);
/// `folder` is where files that it names are looked for; empty: it may name none.
Status parse_gltf(std::string_view content, const std::string& name, const std::string& folder, Mesh& mesh);

/// [bytes] Larger files would be more than a machine of today should be asked to feel; a sparse file of a
/// terabyte must not eat its memory.
inline constexpr std::uintmax_t kLargestMeshFile = std::uintmax_t{8} << 30;

/// Is this certainly STL: a binary file of exactly the size its count asks for, or text that begins with
/// "solid"?
bool is_stl_content(std::string_view content);

/// OFF with any of the prefixes ST (texture), C (colour), N (normal), possibly with the first count glued on.
bool is_off_keyword(std::string_view word);

/// Vertex indices are 32 bits wide, and the largest one is left free for "none".
constexpr std::size_t kMaxVertexCount = 0xFFFFFFFEu;

/// "name: byte N: what" for binary files; byte counts from 0.
inline Status byte_error(const std::string& name, std::size_t byte, const std::string& what) {
  return Status::error(name + ": byte " + std::to_string(byte) + ": " + what);
}

/// The unsigned number in `size` bytes of a binary file, 8 at most, from `at` on.
inline std::uint64_t binary_number(std::string_view content, std::size_t at, std::size_t size,
                                   bool big_endian = false) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t from_high = big_endian ? i : size - 1 - i;
    value = value << 8 | static_cast<unsigned char>(content[at + from_high]);
  }
  return value;
}
inline std::uint32_t little_endian_u32(std::string_view content, std::size_t at) {
  return static_cast<std::uint32_t>(binary_number(content, at, 4));
}

/// Cuts a polygon of at least three corners into a fan from its first corner.
inline void append_fan(const std::vector<std::uint32_t>& polygon, Mesh& mesh) {
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    mesh.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }
}

/// Between the strips of a list of vertices, where no vertex can be.
constexpr std::uint32_t kStripEnd = 0xFFFFFFFFu;

/// Cuts triangle strips, parted by kStripEnd, into triangles; every other one is turned round. Those of which
/// two corners are the same vertex only join strips and are left out.
inline void append_strips(const std::vector<std::uint32_t>& corners, Mesh& mesh) {
  std::size_t start = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] == kStripEnd) start = i + 1;
    if (i < start + 2) continue;
    const bool turned = (i - start) % 2 != 0;
    const std::uint32_t a = corners[i - 2], b = corners[turned ? i : i - 1], c = corners[turned ? i - 1 : i];
    if (a != b && b != c && c != a) mesh.triangles.push_back({a, b, c});
  }
}

}  // namespace lumbrical
