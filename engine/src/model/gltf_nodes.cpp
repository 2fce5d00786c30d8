#include "model/gltf_nodes.h"

#include <algorithm>

namespace lumbrical {
namespace {

using nlohmann::json;

constexpr std::size_t kMostInfluences = 4;  // sets of four joints that move a vertex

Vec3 axis(const GltfMatrix& m, std::size_t column) {
  return {m[4 * column], m[4 * column + 1], m[4 * column + 2]};
}

Status fault(const std::string& place, const std::string& what) { return Status::error(place + ": " + what); }

// `count` finite numbers of an object's member; `values` stays where there is none.
Status read_numbers(const std::string& place, const json& object, const char* key, std::size_t count,
                    double* values) {
  const json* const found = gltf_member(object, key);
  if (found == nullptr) return {};
  if (!found->is_array() || found->size() != count)
    return fault(place, std::string(key) + " must be " + std::to_string(count) + " numbers");
  for (std::size_t i = 0; i < count; ++i) {
    if (!(*found)[i].is_number() || !is_finite((*found)[i].get<double>()))
      return fault(place, std::string(key) + " must be finite numbers");
    values[i] = (*found)[i].get<double>();
  }
  return {};
}

}  // namespace

GltfMatrix product(const GltfMatrix& a, const GltfMatrix& b) {
  GltfMatrix c{};
  for (std::size_t column = 0; column < 4; ++column)
    for (std::size_t row = 0; row < 4; ++row)
      for (std::size_t k = 0; k < 4; ++k) c[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return c;
}

Vec3 transformed(const GltfMatrix& m, const Vec3& p) {
  return axis(m, 0) * p.x + axis(m, 1) * p.y + axis(m, 2) * p.z + axis(m, 3);
}

bool mirrors(const GltfMatrix& m) { return dot(cross(axis(m, 0), axis(m, 1)), axis(m, 2)) < 0; }

Status read_gltf_transformation(const std::string& place, const json& node, GltfMatrix& m) {
  m = kGltfIdentity;
  if (gltf_member(node, "matrix") != nullptr) return read_numbers(place, node, "matrix", 16, m.data());
  std::array<double, 3> t{}, s{1, 1, 1};
  std::array<double, 4> q{0, 0, 0, 1};
  Status status = read_numbers(place, node, "translation", 3, t.data());
  if (status.ok()) status = read_numbers(place, node, "rotation", 4, q.data());
  if (status.ok()) status = read_numbers(place, node, "scale", 3, s.data());
  if (!status.ok()) return status;
  const Quat rotation{q[3], q[0], q[1], q[2]};
  const double length = dot(rotation, rotation);
  if (!(length > 0.9 && length < 1.1)) return fault(place, "rotation must be a unit quaternion");
  const std::array<Vec3, 3> axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 a = rotate(normalized(rotation), axes[i]) * s[i];
    std::copy_n(std::array{a.x, a.y, a.z}.begin(), 3, m.begin() + static_cast<std::ptrdiff_t>(4 * i));
  }
  std::copy(t.begin(), t.end(), m.begin() + 12);
  return {};
}

Status read_gltf_references(const std::string& place, const json& root, const json& object, const char* key,
                            const char* list, std::vector<std::size_t>& numbers) {
  const json* const found = gltf_member(object, key);
  if (found == nullptr) return {};
  if (!found->is_array()) return fault(place, std::string(key) + " must be a list");
  for (const json& entry : *found) {
    std::size_t number = 0;
    if (!gltf_reference(root, entry, list, number))
      return fault(place, "one of its " + std::string(key) + " is none of the file's " + list);
    numbers.push_back(number);
  }
  return {};
}

Status GltfSkins::find_joints(std::size_t skin, const std::vector<GltfMatrix>*& joints) {
  const auto [found, is_new] = joints_.try_emplace(skin);
  joints = &found->second;
  return is_new ? read_joints(skin, found->second) : Status{};
}

Status GltfSkins::find_parents() {
  const std::size_t count = gltf_count(root_, "nodes");
  parent_.assign(count, count);
  world_.resize(count);
  known_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<std::size_t> children;
    const std::string place = name_ + ": node " + std::to_string(i);
    Status status = read_gltf_references(place, root_, root_["nodes"][i], "children", "nodes", children);
    if (!status.ok()) return status;
    for (const std::size_t child : children) parent_[child] = i;
  }
  return {};
}

Status GltfSkins::find_world(std::size_t node) {
  std::vector<std::size_t> chain;
  for (std::size_t at = node; at < parent_.size() && !known_[at]; at = parent_[at]) {
    chain.push_back(at);
    if (chain.size() > parent_.size())
      return fault(name_ + ": node " + std::to_string(at), "it is below itself; export again");
  }
  for (std::size_t i = chain.size(); i-- > 0;) {
    const std::size_t at = chain[i], parent = parent_[at];
    const std::string place = name_ + ": node " + std::to_string(at);
    GltfMatrix own;
    if (Status status = read_gltf_transformation(place, root_["nodes"][at], own); !status.ok()) return status;
    world_[at] = parent < parent_.size() ? product(world_[parent], own) : own;
    known_[at] = true;
  }
  return {};
}

Status GltfSkins::read_joints(std::size_t skin, std::vector<GltfMatrix>& joints) {
  if (parent_.empty())
    if (Status status = find_parents(); !status.ok()) return status;
  const std::string place = name_ + ": skin " + std::to_string(skin);
  const json& object = root_["skins"][skin];
  std::vector<std::size_t> nodes;
  if (Status status = read_gltf_references(place, root_, object, "joints", "nodes", nodes); !status.ok())
    return status;
  std::vector<double> unbind;
  if (const json* const accessor = gltf_member(object, "inverseBindMatrices")) {
    if (Status status = buffers_.read_values(*accessor, "MAT4", 16, nodes.size(), unbind); !status.ok())
      return status;
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (Status status = find_world(nodes[i]); !status.ok()) return status;
    GltfMatrix m = kGltfIdentity;
    if (!unbind.empty()) std::copy_n(unbind.begin() + static_cast<std::ptrdiff_t>(16 * i), 16, m.begin());
    joints.push_back(product(world_[nodes[i]], m));
  }
  return {};
}

// Weights that don't sum up to 1 are shares of their sum; without any the first joint has the vertex.
Status pose_by_joints(const std::string& place, const json& attributes, const std::vector<GltfMatrix>& joints,
                      GltfBuffers& buffers, std::vector<Vec3>& vertices) {
  std::vector<Vec3> sum(vertices.size()), first(vertices.size());
  std::vector<double> weight_sum(vertices.size());
  for (std::size_t set = 0; set < kMostInfluences; ++set) {
    const std::string number = std::to_string(set);
    const json* const joint_accessor = gltf_member(attributes, ("JOINTS_" + number).c_str());
    const json* const weight_accessor = gltf_member(attributes, ("WEIGHTS_" + number).c_str());
    if (joint_accessor == nullptr || weight_accessor == nullptr) {
      if (set > 0) break;
      return fault(place,
                   "its node has a skin, but it has no JOINTS_0 and WEIGHTS_0; export without the skin");
    }
    std::vector<double> joint, weight;
    Status status = buffers.read_values(*joint_accessor, "VEC4", 4, vertices.size(), joint);
    if (status.ok()) status = buffers.read_values(*weight_accessor, "VEC4", 4, vertices.size(), weight);
    if (!status.ok()) return status;
    for (std::size_t i = 0; i < joint.size(); ++i) {
      if (!(joint[i] >= 0 && joint[i] < static_cast<double>(joints.size())))
        return fault(place, "vertex " + std::to_string(i / 4) + " hangs on none of its skin's " +
                                std::to_string(joints.size()) + " joints; export again");
      const Vec3 moved = transformed(joints[static_cast<std::size_t>(joint[i])], vertices[i / 4]);
      if (set == 0 && i % 4 == 0) first[i / 4] = moved;
      sum[i / 4] += weight[i] * moved;
      weight_sum[i / 4] += weight[i];
    }
  }
  for (std::size_t v = 0; v < vertices.size(); ++v)
    vertices[v] = weight_sum[v] > 0 ? sum[v] / weight_sum[v] : first[v];
  return {};
}

}  // namespace lumbrical
