// ODE 0.16: its capsules against its triangle mesh. Its triangles have one side, and contacts that lie close
// together are merged, so it can't find all.
#include <ode/ode.h>

#include <memory>

#include "peer.h"

namespace lumbrical::bench {
namespace {

constexpr int kMost = 65535;  // contacts of one call; all that ODE's flags can say

struct OdeMesh {
  std::vector<float> points;
  std::vector<dTriIndex> corners;
  std::vector<dContactGeom> found = std::vector<dContactGeom>(kMost);
  dTriMeshDataID data = nullptr;
  dGeomID ground = nullptr;
  explicit OdeMesh(const Mesh& mesh) {
    static const int started = dInitODE2(0);
    static_cast<void>(started);
    for (const Vec3 p : mesh.vertices) {
      for (const double x : {p.x, p.y, p.z}) points.push_back(static_cast<float>(kMillimetres * x));
    }
    for (const Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
    data = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildSingle(data, points.data(), 3 * sizeof(float),
                                static_cast<int>(mesh.vertices.size()), corners.data(),
                                static_cast<int>(corners.size()), 3 * sizeof(dTriIndex));
    ground = dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr);
  }
  ~OdeMesh() {
    dGeomDestroy(ground);
    dGeomTriMeshDataDestroy(data);
  }
  OdeMesh(const OdeMesh&) = delete;
  OdeMesh& operator=(const OdeMesh&) = delete;
};

// ODE's capsules lie along z.
void place(dGeomID capsule, const Primitive& phalanx) {
  const Vec3 middle = 0.5 * kMillimetres * (phalanx.end1 + phalanx.end2);
  const Vec3 axis = unit_or(phalanx.end2 - phalanx.end1, {0, 0, 1});
  dGeomSetPosition(capsule, middle.x, middle.y, middle.z);
  dMatrix3 rotation;
  dRFromZAxis(rotation, axis.x, axis.y, axis.z);
  dGeomSetRotation(capsule, rotation);
}

}  // namespace

Peer make_ode(const Mesh& mesh) {
  const auto world = std::make_shared<OdeMesh>(mesh);
  return {"ODE 0.16", false, [world](std::span<const Primitive> hand, std::vector<PeerContact>& contacts) {
            for (std::size_t i = 0; i < hand.size(); ++i) {
              const dGeomID capsule = dCreateCapsule(nullptr, kMillimetres * hand[i].radius1,
                                                     kMillimetres * norm(hand[i].end2 - hand[i].end1));
              place(capsule, hand[i]);
              const int count =
                  dCollide(world->ground, capsule, kMost, world->found.data(), sizeof(dContactGeom));
              for (int k = 0; k < count; ++k) {
                const dContactGeom& contact = world->found[static_cast<std::size_t>(k)];
                contacts.push_back(
                    {static_cast<std::uint64_t>(i) << 32 | static_cast<std::uint32_t>(contact.side1),
                     contact.depth / kMillimetres, 0});
              }
              dGeomDestroy(capsule);
            }
          }};
}

}  // namespace lumbrical::bench
