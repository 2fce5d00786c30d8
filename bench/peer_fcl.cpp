// FCL 0.7: its capsules against its tree of boxes and rectangle-swept spheres.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>

#include <memory>

#include "peer.h"

namespace lumbrical::bench {
namespace {

using Tree = fcl::BVHModel<fcl::OBBRSSd>;

fcl::Vector3d to_fcl(Vec3 p) { return kMillimetres * fcl::Vector3d(p.x, p.y, p.z); }

}  // namespace

Peer make_fcl(const Mesh& mesh) {
  const auto tree = std::make_shared<Tree>();
  std::vector<fcl::Vector3d> points;
  std::vector<fcl::Triangle> triangles;
  for (const Vec3 p : mesh.vertices) points.push_back(to_fcl(p));
  for (const Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  tree->beginModel(static_cast<int>(triangles.size()), static_cast<int>(points.size()));
  tree->addSubModel(points, triangles);
  tree->endModel();
  const auto ground = std::make_shared<fcl::CollisionObjectd>(tree);
  return {"FCL 0.7", false, [ground](std::span<const Primitive> hand, std::vector<PeerContact>& contacts) {
            const fcl::CollisionRequestd request(10'000'000, true);
            for (std::size_t i = 0; i < hand.size(); ++i) {
              const fcl::Vector3d a = to_fcl(hand[i].end1), b = to_fcl(hand[i].end2);
              fcl::Transform3d pose = fcl::Transform3d::Identity();
              pose.translation() = (a + b) / 2;
              pose.linear() =
                  Eigen::Quaterniond::FromTwoVectors(fcl::Vector3d::UnitZ(), b - a).toRotationMatrix();
              const auto capsule =
                  std::make_shared<fcl::Capsuled>(kMillimetres * hand[i].radius1, (b - a).norm());
              const fcl::CollisionObjectd object(capsule, pose);
              fcl::CollisionResultd result;
              fcl::collide(ground.get(), &object, request, result);
              for (std::size_t k = 0; k < result.numContacts(); ++k) {
                const fcl::Contactd& contact = result.getContact(k);
                const auto triangle = static_cast<std::uint32_t>(
                    contact.o1 == ground->collisionGeometry().get() ? contact.b1 : contact.b2);
                contacts.push_back({static_cast<std::uint64_t>(i) << 32 | triangle,
                                    contact.penetration_depth / kMillimetres, 0});
              }
            }
          }};
}

}  // namespace lumbrical::bench
