// Reads the header of a PLY file: which elements follow in which encoding, and what their properties are.
#include "model/ply_header.h"

#include <algorithm>

#include "model/mesh_formats.h"

namespace lumbrical {
namespace {

bool is_integer(PlyType type) { return type != PlyType::f32 && type != PlyType::f64; }

std::optional<PlyType> scalar_type(std::string_view word) {
  constexpr std::string_view kNames[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                            {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                            {"float", "float32"}, {"double", "float64"}};
  for (std::size_t i = 0; i < std::size(kNames); ++i) {
    if (word == kNames[i][0] || word == kNames[i][1]) return static_cast<PlyType>(i);
  }
  return std::nullopt;
}

struct HeaderReader {
  TextCursor& cursor;
  const std::string& name;
  PlyHeader& header;
  Status fault(const std::string& what) const { return text_error(name, cursor.place(), what); }
};

Status read_format(HeaderReader& reader) {
  const std::string_view word = reader.cursor.word();
  if (word == "ascii") {
    reader.header.encoding = PlyEncoding::ascii;
  } else if (word == "binary_little_endian") {
    reader.header.encoding = PlyEncoding::little_endian;
  } else if (word == "binary_big_endian") {
    reader.header.encoding = PlyEncoding::big_endian;
  } else {
    return reader.fault("format " + in_quotes(word) +
                        " is unknown; it must be ascii, binary_little_endian or binary_big_endian");
  }
  const std::string_view version = reader.cursor.word();
  return version == "1.0" ? Status()
                          : reader.fault("version " + in_quotes(version) + " is unknown; it must be 1.0");
}

Status read_element(HeaderReader& reader) {
  const TextPlace place = reader.cursor.place();
  PlyElement element{std::string(reader.cursor.word()), 0, place, {}};
  if (element.name == "vertex" || element.name == "face" || element.name == "tristrips") {
    for (const PlyElement& other : reader.header.elements) {
      if (other.name != element.name) continue;
      return reader.fault("element " + in_quotes(element.name) + " is declared twice; re-export the mesh");
    }
  }
  const std::string_view word = reader.cursor.word();
  std::int64_t count = 0;
  if (!read_integer(word, count) || count < 0) {
    return reader.fault(in_quotes(word) + " is not a count of elements; re-export the mesh");
  }
  element.count = static_cast<std::size_t>(count);
  if (element.name == "vertex") {
    if (element.count > kMaxVertexCount) return reader.fault("more than 2^32 - 2 vertices; split the mesh");
    reader.header.vertex_count = element.count;
  }
  reader.header.elements.push_back(std::move(element));
  return {};
}

PlyRole role_of(const std::string& element, const std::string& property) {
  if (element == "vertex" && property == "x") return PlyRole::x;
  if (element == "vertex" && property == "y") return PlyRole::y;
  if (element == "vertex" && property == "z") return PlyRole::z;
  const bool corners = property == "vertex_indices" || property == "vertex_index";
  if (corners && element == "face") return PlyRole::corners;
  return corners && element == "tristrips" ? PlyRole::strip : PlyRole::ignored;
}

Status read_type(HeaderReader& reader, std::string_view word, PlyType& type) {
  const std::optional<PlyType> known = scalar_type(word);
  if (!known) return reader.fault("type " + in_quotes(word) + " is unknown; re-export the mesh");
  type = *known;
  return {};
}

Status read_property(HeaderReader& reader) {
  if (reader.header.elements.empty())
    return reader.fault("a property before the first element; re-export the mesh");
  PlyProperty property;
  std::string_view word = reader.cursor.word();
  const bool is_list = word == "list";
  if (is_list) {
    PlyType count_type = PlyType::u8;
    if (Status status = read_type(reader, reader.cursor.word(), count_type); !status.ok()) return status;
    if (!is_integer(count_type))
      return reader.fault("a list's length must have an integer type; re-export the mesh");
    property.count_type = count_type;
    word = reader.cursor.word();
  }
  if (Status status = read_type(reader, word, property.type); !status.ok()) return status;

  PlyElement& element = reader.header.elements.back();
  property.name = reader.cursor.word();
  if (property.name.empty()) return reader.fault("a property without a name; re-export the mesh");
  property.role = role_of(element.name, property.name);
  const bool corners = property.role == PlyRole::corners || property.role == PlyRole::strip;
  if (corners && !(is_list && is_integer(property.type))) {
    return reader.fault("vertex indices must be a list of an integer type; re-export the mesh");
  }
  if (!corners && property.role != PlyRole::ignored && is_list) {
    return reader.fault("a coordinate must be a single value, not a list; re-export the mesh");
  }
  element.properties.push_back(std::move(property));
  return {};
}

std::size_t count_role(const PlyElement& element, PlyRole role) {
  return static_cast<std::size_t>(std::count_if(element.properties.begin(), element.properties.end(),
                                                [role](const PlyProperty& p) { return p.role == role; }));
}

/// Each of the properties the engine reads must be there once.
Status check_elements(const HeaderReader& reader) {
  bool has_vertices = false, has_faces = false;
  for (const PlyElement& element : reader.header.elements) {
    if (element.name == "vertex") {
      has_vertices = true;
      for (const PlyRole role : {PlyRole::x, PlyRole::y, PlyRole::z}) {
        if (count_role(element, role) == 1) continue;
        return text_error(reader.name, element.place,
                          "vertices need the properties x, y and z, each once; re-export the mesh");
      }
    } else if (element.name == "face" || element.name == "tristrips") {
      has_faces = true;
      const PlyRole role = element.name == "face" ? PlyRole::corners : PlyRole::strip;
      if (count_role(element, role) == 1) continue;
      return text_error(reader.name, element.place,
                        (element.name == "face" ? "faces" : element.name) +
                            " need one list vertex_indices or vertex_index; re-export the mesh");
    }
  }
  if (!has_vertices) return reader.fault("no element 'vertex'; re-export the mesh");
  if (!has_faces)
    return reader.fault("no element 'face', so this is a cloud of points; export the mesh with faces");
  return {};
}

Status read_header(HeaderReader& reader) {
  TextCursor& cursor = reader.cursor;
  if (!cursor.next_line() || cursor.word() != "ply") return reader.fault("a PLY file begins with 'ply'");
  bool has_format = false;
  while (cursor.next_line()) {
    const std::string_view keyword = cursor.word();
    if (keyword == "comment" || keyword == "obj_info") continue;
    if (keyword == "end_header") {
      if (!has_format) return reader.fault("the header has no 'format' line; re-export the mesh");
      if (Status status = check_elements(reader); !status.ok()) return status;
      return cursor.word().empty() ? Status() : reader.fault("'end_header' must stand alone on its line");
    }
    Status status;
    if (keyword == "format") {
      status = read_format(reader);
      has_format = true;
    } else if (keyword == "element") {
      status = read_element(reader);
    } else if (keyword == "property") {
      status = read_property(reader);
    } else {
      status = reader.fault("unknown line " + in_quotes(keyword) + " in the header; re-export the mesh");
    }
    if (!status.ok()) return status;
  }
  return reader.fault("the file ends within the header; copy or export it again");
}

}  // namespace

Status read_ply_header(TextCursor& cursor, const std::string& name, PlyHeader& header) {
  HeaderReader reader{cursor, name, header};
  return read_header(reader);
}

/// The data begin right behind the line end. A lone CR ends a line only where it does so from the first line
/// on, for the byte after "end_header" and its line end may be data that look like another line end.
std::size_t ply_data_offset(std::string_view content, std::size_t at) {
  while (at < content.size() && (content[at] == ' ' || content[at] == '\t')) ++at;
  const std::size_t first_end = content.find_first_of("\r\n");
  const bool lone_cr = content[first_end] == '\r' && content.substr(first_end, 2) != "\r\n";
  const std::size_t size = !lone_cr && content.substr(at, 2) == "\r\n" ? 2 : 1;
  return std::min(at + size, content.size());
}

}  // namespace lumbrical
