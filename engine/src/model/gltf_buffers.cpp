// See gltf_buffers.h. Section numbers are of the glTF 2.0 specification.
#include "model/gltf_buffers.h"

#include <array>
#include <bit>
#include <filesystem>
#include <optional>

#include "base/text_cursor.h"
#include "base/whole_file.h"
#include "model/json_text.h"
#include "model/mesh_formats.h"

namespace lumbrical {

using nlohmann::json;

namespace {

constexpr std::size_t kGlbHeaderSize = 12, kChunkHeaderSize = 8;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr int kDeepest = 64;  // nesting of JSON; extensions of real files stay far below

Status parse_text(std::string_view text, const std::string& name, std::size_t offset, json& root) {
  if (const JsonFault fault = parse_json_text(text, kDeepest, root); !fault.what.empty())
    return byte_error(name, offset + fault.byte, fault.what + "; export it again");
  const json* const asset = gltf_member(root, "asset");
  const json* const version = asset == nullptr ? nullptr : gltf_member(*asset, "version");
  if (version == nullptr || !version->is_string())
    return Status::error(name + ": it has no asset.version, so it is no glTF file");
  if (version->get_ref<const std::string&>().substr(0, 2) != "2.")
    return Status::error(name + ": only glTF 2 is read; export it as that, or as OBJ, PLY or STL");
  return {};
}

// Bytes of one component (3.6.2.2); 0 for what is no type.
std::size_t component_size(std::int64_t type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

double component(std::string_view bytes, std::size_t at, std::int64_t type, bool normalized) {
  const std::uint64_t raw = binary_number(bytes, at, component_size(type));
  switch (type) {
    case 5120: {
      const double value = static_cast<std::int8_t>(raw);
      return normalized ? max(value / 127, -1.0) : value;
    }
    case 5121:
      return normalized ? static_cast<double>(raw) / 255 : static_cast<double>(raw);
    case 5122: {
      const double value = static_cast<std::int16_t>(raw);
      return normalized ? max(value / 32767, -1.0) : value;
    }
    case 5123:
      return normalized ? static_cast<double>(raw) / 65535 : static_cast<double>(raw);
    case 5126:
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
    default:
      return static_cast<double>(raw);
  }
}

int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

bool decode_base64(std::string_view text, std::string& bytes) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const int value = base64_value(c);
    if (value < 0) return false;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes += static_cast<char>(bits >> held & 0xFF);
  }
  return true;
}

// "my%20mesh.bin" -> "my mesh.bin"; nothing where it leads out of the folder or is no file's name.
std::optional<std::string> file_of_uri(std::string_view uri) {
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned value = static_cast<unsigned char>(uri[i]);
    if (uri[i] == '%') {
      const auto result =
          std::from_chars(uri.data() + i + 1, uri.data() + std::min(i + 3, uri.size()), value, 16);
      if (result.ec != std::errc() || result.ptr != uri.data() + i + 3) return std::nullopt;
      i += 2;
    }
    path += static_cast<char>(value);
  }
  if (path.empty() || path.find(':') != path.npos || path.find('\0') != path.npos) return std::nullopt;
  const std::filesystem::path relative(path);
  if (relative.is_absolute()) return std::nullopt;
  for (const auto& part : relative)
    if (part == "..") return std::nullopt;
  return path;
}

// A whole number 0 .. 2^53; `fallback` where there is none.
bool read_count(const json& object, const char* key, std::optional<std::uint64_t> fallback,
                std::uint64_t& value) {
  const json* const found = gltf_member(object, key);
  if (found == nullptr) {
    value = fallback.value_or(0);
    return fallback.has_value();
  }
  if (!found->is_number_unsigned()) return false;
  value = found->get<std::uint64_t>();
  return value <= std::uint64_t{1} << 53;
}

}  // namespace

const json* gltf_member(const json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

std::size_t gltf_count(const json& root, const char* list) {
  const json* const found = gltf_member(root, list);
  return found != nullptr && found->is_array() ? found->size() : 0;
}

bool gltf_reference(const json& root, const json& value, const char* list, std::size_t& number) {
  if (!value.is_number_unsigned()) return false;
  const std::uint64_t given = value.get<std::uint64_t>();
  number = static_cast<std::size_t>(given);
  return given < gltf_count(root, list);
}

Status read_gltf_container(std::string_view content, const std::string& name, json& root,
                           std::string_view& binary) {
  if (content.substr(0, 4) != "glTF") return parse_text(content, name, 0, root);
  if (content.size() < kGlbHeaderSize + kChunkHeaderSize)
    return byte_error(name, content.size(), "the file ends within its header; copy or export it again");
  if (little_endian_u32(content, 4) != 2)
    return byte_error(name, 4, "only version 2 of glTF is read; export it as that");
  if (little_endian_u32(content, 8) > content.size())
    return byte_error(name, content.size(),
                      "the file ends before its stated length; copy or export it again");
  std::string_view text;
  for (std::size_t at = kGlbHeaderSize; content.size() - at >= kChunkHeaderSize;) {
    const std::size_t length = little_endian_u32(content, at), start = at + kChunkHeaderSize;
    const std::uint32_t type = little_endian_u32(content, at + 4);
    if (length > content.size() - start)
      return byte_error(name, at, "a chunk is longer than the file; copy or export it again");
    if (type == kJsonChunk && text.empty()) text = content.substr(start, length);
    if (type == kBinaryChunk && binary.data() == nullptr) binary = content.substr(start, length);
    at = start + length;
  }
  if (text.empty()) return byte_error(name, kGlbHeaderSize, "there is no JSON; export it again");
  return parse_text(text, name, static_cast<std::size_t>(text.data() - content.data()), root);
}

GltfBuffers::GltfBuffers(const json& root, const std::string& name, const std::string& folder,
                         std::string_view binary)
    : root_(root),
      name_(name),
      folder_(folder),
      binary_(binary),
      held_(gltf_count(root, "buffers")),
      buffer_(held_.size()) {}

Status GltfBuffers::fault(const std::string& place, const std::string& what) const {
  return Status::error(name_ + ": " + place + ": " + what);
}

Status GltfBuffers::load_buffer(std::size_t number) {
  if (buffer_[number].data() != nullptr) return {};
  const std::string place = "buffer " + std::to_string(number);
  const json* const uri = gltf_member(root_["buffers"][number], "uri");
  if (uri == nullptr) {
    if (number != 0 || binary_.data() == nullptr)
      return fault(place, "it names no file, and is not in this one; export the mesh as .glb");
    buffer_[number] = binary_;
    return {};
  }
  if (!uri->is_string()) return fault(place, "its uri is no text; export the mesh as .glb");
  const std::string& text = uri->get_ref<const std::string&>();
  std::string& bytes = held_[number];
  if (text.substr(0, 5) == "data:") {
    const std::size_t comma = text.find(";base64,");
    if (comma == text.npos || !decode_base64(std::string_view(text).substr(comma + 8), bytes))
      return fault(place, "its data are no base64; export the mesh as .glb");
  } else {
    const std::optional<std::string> file = file_of_uri(text);
    if (!file || folder_.empty())
      return fault(place, "its uri " + in_quotes(std::string_view(text)) +
                              " is no file beside this one; export the mesh as .glb");
    const std::filesystem::path path = std::filesystem::path(folder_) / *file;  // never "-"
    const std::size_t holder = holder_.try_emplace(path.lexically_normal().string(), number).first->second;
    if (holder != number) {
      buffer_[number] = held_[holder];
      return {};
    }
    if (Status status = read_whole_file(path.string(), kLargestMeshFile, "a file of bytes", bytes);
        !status.ok())
      return status;
    bytes_beside_ += bytes.size();
  }
  buffer_[number] = bytes;
  return {};
}

// Where the elements of an accessor lie (3.6.2.4): all within their buffer.
struct GltfBuffers::View {
  std::string place;
  std::string_view bytes;  // from the first element on
  std::size_t count = 0, stride = 0;
  std::int64_t type = 0;
  bool normalized = false;
};

Status GltfBuffers::find_view(const json& accessor, const char* type, std::size_t components, View& view) {
  std::size_t number = 0;
  if (!gltf_reference(root_, accessor, "accessors", number))
    return fault("accessor", "there is none of that number");
  view.place = "accessor " + std::to_string(number);
  const json& object = root_["accessors"][number];
  if (gltf_member(object, "sparse") != nullptr)
    return fault(view.place, "sparse accessors are not read; export the mesh without morph targets");
  const json* const given = gltf_member(object, "type");
  if (given == nullptr || *given != type) return fault(view.place, std::string("it must be of type ") + type);
  const json* const component_type = gltf_member(object, "componentType");
  if (component_type != nullptr && component_type->is_number_integer())
    view.type = component_type->get<std::int64_t>();
  const std::size_t size = component_size(view.type) * components;
  if (size == 0) return fault(view.place, "its componentType is unknown");
  const json* const normalized = gltf_member(object, "normalized");
  view.normalized = normalized != nullptr && *normalized == true;

  std::size_t view_number = 0;
  const json* const reference = gltf_member(object, "bufferView");
  if (reference == nullptr || !gltf_reference(root_, *reference, "bufferViews", view_number))
    return fault(view.place, "its bufferView is none of the file's");
  const json& buffer_view = root_["bufferViews"][view_number];
  const json* const extensions = gltf_member(buffer_view, "extensions");
  if (extensions != nullptr && (gltf_member(*extensions, "EXT_meshopt_compression") != nullptr ||
                                gltf_member(*extensions, "KHR_meshopt_compression") != nullptr))
    return fault(view.place, "its data are compressed by meshopt; export without compression");
  std::size_t buffer = 0;
  const json* const buffer_reference = gltf_member(buffer_view, "buffer");
  if (buffer_reference == nullptr || !gltf_reference(root_, *buffer_reference, "buffers", buffer))
    return fault(view.place, "its buffer is none of the file's");
  if (Status status = load_buffer(buffer); !status.ok()) return status;

  std::uint64_t start = 0, length = 0, offset = 0, count = 0, stride = 0;
  if (!read_count(buffer_view, "byteOffset", 0, start) ||
      !read_count(buffer_view, "byteLength", {}, length) ||
      !read_count(buffer_view, "byteStride", size, stride) || !read_count(object, "byteOffset", 0, offset) ||
      !read_count(object, "count", {}, count))
    return fault(view.place, "count, offsets, length and stride must be whole numbers");
  const std::uint64_t held = buffer_[buffer].size();
  const bool inside =
      start <= held && length <= held - start && offset <= length && stride >= size &&
      (count == 0 || (size <= length - offset && (count - 1) <= (length - offset - size) / stride));
  if (!inside)
    return fault(view.place, "its elements do not fit into its buffer; copy or export the file again");
  view.bytes = buffer_[buffer].substr(start + offset);
  view.count = static_cast<std::size_t>(count);
  view.stride = static_cast<std::size_t>(stride);
  return {};
}

Status GltfBuffers::read_positions(const json& accessor, std::vector<Vec3>& points) {
  View view;
  if (Status status = find_view(accessor, "VEC3", 3, view); !status.ok()) return status;
  const std::size_t size = component_size(view.type);
  points.reserve(points.size() + view.count);
  for (std::size_t i = 0; i < view.count; ++i) {
    std::array<double, 3> value{};
    for (std::size_t k = 0; k < 3; ++k)
      value[k] = component(view.bytes, i * view.stride + k * size, view.type, view.normalized);
    points.push_back({value[0], value[1], value[2]});
    if (!is_finite(points.back()))
      return fault(view.place,
                   "vertex " + std::to_string(i) + " is not finite; repair or re-export the mesh");
  }
  return {};
}

Status GltfBuffers::read_indices(const json& accessor, std::vector<std::uint32_t>& indices) {
  View view;
  if (Status status = find_view(accessor, "SCALAR", 1, view); !status.ok()) return status;
  if (view.type != 5121 && view.type != 5123 && view.type != 5125)
    return fault(view.place, "indices must be unsigned integers");
  indices.reserve(view.count);
  for (std::size_t i = 0; i < view.count; ++i)
    indices.push_back(
        static_cast<std::uint32_t>(binary_number(view.bytes, i * view.stride, component_size(view.type))));
  return {};
}

Status GltfBuffers::read_values(const json& accessor, const char* type, std::size_t components,
                                std::size_t count, std::vector<double>& values) {
  View view;
  if (Status status = find_view(accessor, type, components, view); !status.ok()) return status;
  if (view.count < count)
    return fault(view.place, std::to_string(view.count) + " elements where " + std::to_string(count) +
                                 " are needed; export again");
  const std::size_t size = component_size(view.type);
  values.reserve(count * components);
  for (std::size_t i = 0; i < count * components; ++i) {
    const std::size_t at = i / components * view.stride + i % components * size;
    values.push_back(component(view.bytes, at, view.type, view.normalized));
    if (!is_finite(values.back()))
      return fault(view.place, "element " + std::to_string(i / components) +
                                   " is not finite; repair or re-export the mesh");
  }
  return {};
}

}  // namespace lumbrical
