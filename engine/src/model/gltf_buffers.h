// The container of a glTF file and what its accessors say: JSON, buffers, numbers in them.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "lumbrical/math.h"
#include "lumbrical/status.h"

namespace lumbrical {

/// Parts a .glb file, or takes a .gltf file as it is. `binary` is the part of `content` that holds the first
/// buffer of a .glb file. `root` is an object whose asset is of version 2.
Status read_gltf_container(std::string_view content, const std::string& name, nlohmann::json& root,
                           std::string_view& binary);

/// The member of an object; null where `object` is no object or has no such member.
const nlohmann::json* gltf_member(const nlohmann::json& object, const char* key);

/// How many root[list] has; 0 where that is no list.
std::size_t gltf_count(const nlohmann::json& root, const char* list);

/// A number that says which of root[list] is meant. False where it is none of them.
bool gltf_reference(const nlohmann::json& root, const nlohmann::json& value, const char* list,
                    std::size_t& number);

/// The bytes behind accessors: of the .glb file, of data: URIs, of files beside it. Each is read once.
class GltfBuffers {
 public:
  /// `folder` is where files beside it are; empty: nowhere. All arguments outlive this.
  GltfBuffers(const nlohmann::json& root, const std::string& name, const std::string& folder,
              std::string_view binary);
  /// Appends nothing but finite points.
  Status read_positions(const nlohmann::json& accessor, std::vector<Vec3>& points);
  Status read_indices(const nlohmann::json& accessor, std::vector<std::uint32_t>& indices);
  /// The components of the first `count` elements, which must be there, of type "VEC4" or "MAT4"; all finite.
  Status read_values(const nlohmann::json& accessor, const char* type, std::size_t components,
                     std::size_t count, std::vector<double>& values);
  /// [bytes] of the files beside it that were read so far.
  [[nodiscard]] std::size_t bytes_beside() const { return bytes_beside_; }

 private:
  struct View;
  [[nodiscard]] Status fault(const std::string& place, const std::string& what) const;
  Status load_buffer(std::size_t number);
  Status find_view(const nlohmann::json& accessor, const char* type, std::size_t components, View& view);

  const nlohmann::json& root_;
  const std::string& name_;
  const std::string& folder_;
  std::string_view binary_;
  std::vector<std::string> held_;              // of buffers that are not in the .glb file
  std::vector<std::string_view> buffer_;       // by number; without data until it is loaded
  std::map<std::string, std::size_t> holder_;  // of a file's bytes, by its path
  std::size_t bytes_beside_ = 0;
};

}  // namespace lumbrical
