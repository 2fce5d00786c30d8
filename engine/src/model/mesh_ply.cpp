// Reads PLY, the Stanford polygon format: ASCII and binary of both byte orders, with any further elements and
// properties around the vertices' x, y, z and the faces' vertex_indices, which are passed over.
#include <bit>
#include <cmath>

#include "base/text_cursor.h"
#include "model/mesh_formats.h"
#include "model/ply_header.h"
#include "model/polygons.h"

namespace lumbrical {
namespace {

std::size_t size_of(PlyType type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

/// Hands out the values behind the header one by one, from text or bytes. After a failure it answers false
/// for ever, and `status` says what was wrong first.
struct BodyReader {
  std::string_view content;
  const std::string& name;
  PlyEncoding encoding;
  TextCursor cursor;     // ascii: continues behind the header
  std::size_t at;        // binary: the next byte
  std::size_t value_at;  // binary: the last value's first byte
  Status status;

  std::size_t remaining() const {
    return encoding == PlyEncoding::ascii ? cursor.remaining() : content.size() - at;
  }

  bool fail(const std::string& what) {
    if (!status.ok()) return false;
    status = encoding == PlyEncoding::ascii ? text_error(name, cursor.place(), what)
                                            : byte_error(name, value_at, what);
    return false;
  }

  /// The line, or the byte of the last value.
  std::size_t place() const { return encoding == PlyEncoding::ascii ? cursor.place().line : value_at; }
};

double decode(PlyType type, std::uint64_t raw) {
  switch (type) {
    case PlyType::i8:
      return static_cast<std::int8_t>(raw);
    case PlyType::i16:
      return static_cast<std::int16_t>(raw);
    case PlyType::i32:
      return static_cast<std::int32_t>(raw);
    case PlyType::f32:
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
    case PlyType::f64:
      return std::bit_cast<double>(raw);
    default:
      return static_cast<double>(raw);  // the unsigned types, of 32 bits at most
  }
}

bool read_binary_value(BodyReader& body, PlyType type, double& value) {
  const std::size_t size = size_of(type);
  body.value_at = body.at;
  if (body.remaining() < size) return body.fail("the file ends within an element; copy or export it again");
  const bool big_endian = body.encoding == PlyEncoding::big_endian;
  const std::uint64_t raw = binary_number(body.content, body.at, size, big_endian);
  body.at += size;
  value = decode(type, raw);
  return true;
}

bool read_word(BodyReader& body, std::string_view& word) {
  word = body.cursor.word();
  return !word.empty() || body.fail("the line ends before its last value; export it again");
}

/// A value that must be a finite number; integers come as doubles, which hold all of them exactly.
bool read_value(BodyReader& body, PlyType type, double& value) {
  if (body.encoding == PlyEncoding::ascii) {
    std::string_view word;
    if (!read_word(body, word)) return false;
    const char* const fault = read_finite(word, value);
    return fault == nullptr ||
           body.fail("value " + in_quotes(word) + " " + fault + "; repair or re-export the mesh");
  }
  if (!read_binary_value(body, type, value)) return false;
  return std::isfinite(value) || body.fail("a value is not finite; repair or re-export the mesh");
}

bool skip_values(BodyReader& body, PlyType type, std::size_t count) {
  if (body.encoding == PlyEncoding::ascii) {
    std::string_view word;
    for (std::size_t i = 0; i < count; ++i) {
      if (!read_word(body, word)) return false;
    }
    return true;
  }
  body.value_at = body.at;
  if (count > body.remaining() / size_of(type)) {
    return body.fail("the file ends within an element; copy or export it again");
  }
  body.at += count * size_of(type);
  return true;
}

/// A list's length: not negative and not more than the rest of the file can hold.
bool read_length(BodyReader& body, const PlyProperty& property, std::size_t& length) {
  double value = 0;
  if (!read_value(body, *property.count_type, value)) return false;
  const std::size_t item_size =
      body.encoding == PlyEncoding::ascii ? 2 : size_of(property.type);  // digit and blank
  if (value < 0 || value != std::floor(value) ||
      value > static_cast<double>(body.remaining() / item_size + 1)) {
    return body.fail(
        "a list's length is negative, broken or more than the file can hold; re-export the mesh");
  }
  length = static_cast<std::size_t>(value);
  return true;
}

bool read_corners(BodyReader& body, const PlyProperty& property, std::size_t vertex_count,
                  std::vector<std::uint32_t>& polygon) {
  const bool strip = property.role == PlyRole::strip;
  std::size_t length = 0;
  if (!read_length(body, property, length)) return false;
  if (length < 3 && !strip) {
    return body.fail("a face needs at least 3 corners, this one has " + std::to_string(length) +
                     "; delete or repair the face");
  }
  polygon.clear();
  for (std::size_t i = 0; i < length; ++i) {
    double index = 0;
    if (!read_value(body, property.type, index)) return false;
    if (strip && index == -1) {
      polygon.push_back(kStripEnd);
      continue;
    }
    if (!(index >= 0 && index < static_cast<double>(vertex_count)) || index != std::floor(index)) {
      return body.fail("a vertex index is not one of the " + std::to_string(vertex_count) +
                       " vertices (counted from 0); re-export the mesh");
    }
    polygon.push_back(static_cast<std::uint32_t>(index));
  }
  return true;
}

struct Row {
  Vec3 point;
  std::vector<std::uint32_t> polygon;
};

bool read_property_value(BodyReader& body, const PlyProperty& property, std::size_t vertex_count, Row& row) {
  switch (property.role) {
    case PlyRole::x:
      return read_value(body, property.type, row.point.x);
    case PlyRole::y:
      return read_value(body, property.type, row.point.y);
    case PlyRole::z:
      return read_value(body, property.type, row.point.z);
    case PlyRole::corners:
    case PlyRole::strip:
      return read_corners(body, property, vertex_count, row.polygon);
    case PlyRole::ignored:
      break;
  }
  std::size_t length = 1;
  if (property.count_type && !read_length(body, property, length)) return false;
  return skip_values(body, property.type, length);
}

/// In ASCII every element has a line of its own.
bool start_row(BodyReader& body, const PlyElement& element, std::size_t index) {
  if (body.encoding != PlyEncoding::ascii || body.cursor.next_line()) return true;
  return body.fail("the file ends after " + std::to_string(index) + " of " + std::to_string(element.count) +
                   " " + in_quotes(element.name) + " elements; copy or export it again");
}

/// Faces may have more values than declared: VCG writes colours of the corners that its header forgets. For
/// any other element a value too many means that values and properties are out of step.
bool end_row(BodyReader& body, const PlyElement& element) {
  if (body.encoding != PlyEncoding::ascii || element.name == "face" || body.cursor.word().empty())
    return true;
  return body.fail("the line has more values than the header gives " + in_quotes(element.name) +
                   "; re-export the mesh");
}

/// The least that one element takes in the file: no count that cannot fit is believed.
std::size_t smallest_size(PlyEncoding encoding, const PlyElement& element) {
  std::size_t size = 0;
  for (const PlyProperty& property : element.properties) {
    size += encoding == PlyEncoding::ascii ? 2 : size_of(property.count_type.value_or(property.type));
  }
  return size;
}

bool read_rows(BodyReader& body, const PlyElement& element, std::size_t vertex_count, Mesh& mesh,
               PolygonCutter& polygons) {
  const std::size_t size = smallest_size(body.encoding, element);
  if (size == 0) return true;  // no properties, no bytes
  body.value_at = body.at;
  if (element.count > (body.remaining() + 1) / size) {  // the last line of a text may lack its end
    return body.fail(std::to_string(element.count) + " " + in_quotes(element.name) +
                     " elements do not fit into the " + std::to_string(body.remaining()) +
                     " bytes that are left; copy or export the file again");
  }
  const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
  const bool is_strip = element.name == "tristrips";
  if (is_vertex) mesh.vertices.reserve(element.count);
  if (is_face) mesh.triangles.reserve(element.count);
  Row row;
  for (std::size_t i = 0; i < element.count; ++i) {
    if (!start_row(body, element, i)) return false;
    for (const PlyProperty& property : element.properties) {
      if (!read_property_value(body, property, vertex_count, row)) return false;
    }
    if (!end_row(body, element)) return false;
    if (is_vertex) mesh.vertices.push_back(row.point);
    if (is_face) polygons.append(row.polygon, body.place());
    if (is_strip) append_strips(row.polygon, mesh);
  }
  return true;
}

/// Bytes behind the last element mean that the header does not fit the data; only white space may follow.
bool check_end(BodyReader& body) {
  const char* const what = "more follows than the header counts; export it again";
  if (body.encoding == PlyEncoding::ascii) return !body.cursor.next_line() || body.fail(what);
  body.value_at = body.content.find_first_not_of(" \t\r\n", body.at);
  return body.value_at == std::string_view::npos || body.fail(what);
}

}  // namespace

Status parse_ply(std::string_view content, const std::string& name, Mesh& mesh) {
  TextCursor cursor(content);
  PlyHeader header;
  if (Status status = read_ply_header(cursor, name, header); !status.ok()) return status;
  const std::size_t data = ply_data_offset(content, cursor.offset());
  BodyReader body{content, name, header.encoding, cursor, data, data, {}};
  PolygonCutter polygons(mesh);
  for (const PlyElement& element : header.elements) {
    if (!read_rows(body, element, header.vertex_count, mesh, polygons)) return body.status;
  }
  if (!check_end(body)) return body.status;
  const auto refused = polygons.finish();
  if (!refused) return {};
  return body.encoding == PlyEncoding::ascii ? text_error(name, {*refused, 1}, kTooConcave)
                                             : byte_error(name, *refused, kTooConcave);
}

}  // namespace lumbrical
