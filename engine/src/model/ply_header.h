// What the header of a PLY file says about the values behind it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text_cursor.h"
#include "lumbrical/status.h"

namespace lumbrical {

enum class PlyEncoding : std::uint8_t { ascii, little_endian, big_endian };
enum class PlyType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };
/// What the engine reads a property for.
/// `corners` are of one face, `strip` those of triangle strips, which -1 parts.
enum class PlyRole : std::uint8_t { ignored, x, y, z, corners, strip };

struct PlyProperty {
  std::string name;
  PlyRole role = PlyRole::ignored;
  PlyType type = PlyType::f32;        // of the value, or of a list's items
  std::optional<PlyType> count_type;  // of a list's length; none for a single value
};

/// What the file has `count` of, one after the other.
struct PlyElement {
  std::string name;
  std::size_t count = 0;
  TextPlace place;  // of its line in the header
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t vertex_count = 0;  // of the element "vertex", wherever it stands
};

/// Reads the header with a cursor at the start of the file and leaves it right behind "end_header". On
/// success there are vertices with x, y and z, and faces or triangle strips with a list of corners; elements
/// keep the order of the file.
Status read_ply_header(TextCursor& cursor, const std::string& name, PlyHeader& header);

/// Offset of the first byte of data, where `at` is the offset right behind the word "end_header".
std::size_t ply_data_offset(std::string_view content, std::size_t at);

}  // namespace lumbrical
