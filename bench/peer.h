// Other libraries and methods doing the hand's job, each behind one function: which triangles does each
// phalanx touch, and how deep?
//
// They are fed millimetres: in metres Bullet misses a third of the pairs. Shapes are whole capsules, one for
// each phalanx.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "lumbrical/mesh.h"
#include "model/primitive.h"

namespace lumbrical::bench {

inline constexpr double kMillimetres = 1000;

struct PeerContact {
  std::uint64_t pair = 0;  ///< primitive << 32 | triangle; may occur again
  double depth = 0;        ///< [m]
  double area = 0;         ///< [m^2] of what has one; otherwise 0
};

struct Peer {
  std::string name;
  bool has_area = false;  ///< area, and the depth is that of its centroid
  /// Finds the contacts of the posed phalanges; adds them to the list, which is empty.
  std::function<void(std::span<const Primitive>, std::vector<PeerContact>&)> find;
  std::string leaves_out =
      has_area ? "the volume, for which area times depth at the centroid stands; torques"
               : "areas, volumes and torques: it finds points and their depths";  ///< of what our tick does
};

// The paper's related work (baselines.cpp).
Peer make_point_probes(const Mesh& mesh);
Peer make_point_meshes(const Mesh& mesh);
Peer make_sphere_hand(const Mesh& mesh);
Peer make_point_shell(const Mesh& mesh);

// Each is there if the library was found; `mesh` need not outlive the call unless said.
Peer make_bullet(const Mesh& mesh);
Peer make_bullet_tree(const Mesh& mesh);  ///< its tree, then scalar_contact
Peer make_fcl(const Mesh& mesh);
Peer make_ode(const Mesh& mesh);
Peer make_embree(const Mesh& mesh);  ///< its point query, then scalar_contact

}  // namespace lumbrical::bench
