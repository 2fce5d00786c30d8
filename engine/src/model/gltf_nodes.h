// Where the nodes of a glTF file put what hangs on them, and where its skins put their meshes. Section
// numbers are of the glTF 2.0 specification.
#pragma once

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lumbrical/mesh.h"
#include "model/gltf_buffers.h"

namespace lumbrical {

using GltfMatrix = std::array<double, 16>;  // column-major
inline constexpr GltfMatrix kGltfIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

GltfMatrix product(const GltfMatrix& a, const GltfMatrix& b);
Vec3 transformed(const GltfMatrix& m, const Vec3& p);
bool mirrors(const GltfMatrix& m);

/// A node's own transformation (3.5.3): a matrix, or scale, then rotation, then translation. `place` opens
/// messages.
Status read_gltf_transformation(const std::string& place, const nlohmann::json& node, GltfMatrix& m);

/// The numbers of a list of indices into root[list].
Status read_gltf_references(const std::string& place, const nlohmann::json& root,
                            const nlohmann::json& object, const char* key, const char* list,
                            std::vector<std::size_t>& numbers);

/// A skinned mesh stands where its joints' nodes put it, wherever its own node is (3.7.3).
class GltfSkins {
 public:
  /// All arguments outlive this.
  GltfSkins(const nlohmann::json& root, const std::string& name, GltfBuffers& buffers)
      : root_(root), name_(name), buffers_(buffers) {}

  /// From a skin's mesh to the scene, by each of its joints.
  Status find_joints(std::size_t skin, const std::vector<GltfMatrix>*& joints);

 private:
  Status find_parents();
  Status find_world(std::size_t node);
  Status read_joints(std::size_t skin, std::vector<GltfMatrix>& joints);

  const nlohmann::json& root_;
  const std::string& name_;
  GltfBuffers& buffers_;
  std::vector<std::size_t> parent_;  // of each node; their number where there is none
  std::vector<GltfMatrix> world_;    // of each node that was asked for
  std::vector<bool> known_;
  std::map<std::size_t, std::vector<GltfMatrix>> joints_;  // by skin
};

/// Moves the vertices of a primitive to where the joints of its skin put them.
Status pose_by_joints(const std::string& place, const nlohmann::json& attributes,
                      const std::vector<GltfMatrix>& joints, GltfBuffers& buffers,
                      std::vector<Vec3>& vertices);

}  // namespace lumbrical
