// Bullet 3: its capsules against its triangle mesh, and its tree alone with the scalar contact behind it.
#include <btBulletCollisionCommon.h>

#include <memory>

#include "peer.h"
#include "scalar_contact.h"

namespace lumbrical::bench {
namespace {

btVector3 to_bullet(Vec3 p) {
  return {static_cast<btScalar>(kMillimetres * p.x), static_cast<btScalar>(kMillimetres * p.y),
          static_cast<btScalar>(kMillimetres * p.z)};
}

// Bullet keeps pointers into vertices and indices.
struct BulletMesh {
  std::vector<float> points;
  std::vector<int> corners;
  std::unique_ptr<btTriangleIndexVertexArray> arrays;
  std::unique_ptr<btBvhTriangleMeshShape> shape;
  explicit BulletMesh(const Mesh& mesh) {
    for (const Vec3 p : mesh.vertices) {
      const btVector3 q = to_bullet(p);
      points.insert(points.end(), {q.x(), q.y(), q.z()});
    }
    for (const Triangle& t : mesh.triangles)
      corners.insert(corners.end(), {static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
    arrays = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(mesh.triangles.size()), corners.data(), static_cast<int>(3 * sizeof(int)),
        static_cast<int>(mesh.vertices.size()), points.data(), static_cast<int>(3 * sizeof(float)));
    shape = std::make_unique<btBvhTriangleMeshShape>(arrays.get(), true);
    shape->setMargin(0);
  }
};

struct BulletWorld {
  BulletMesh mesh;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btCollisionWorld world{&dispatcher, &broadphase, &configuration};
  btCollisionObject ground;
  explicit BulletWorld(const Mesh& source) : mesh(source) { ground.setCollisionShape(mesh.shape.get()); }
};

struct Collector : btCollisionWorld::ContactResultCallback {
  std::uint64_t primitive = 0;
  std::vector<PeerContact>* contacts = nullptr;
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                           const btCollisionObjectWrapper*, int, int triangle) override {
    if (point.getDistance() <= 0) {
      contacts->push_back({primitive << 32 | static_cast<std::uint32_t>(triangle),
                           static_cast<double>(-point.getDistance()) / kMillimetres, 0});
    }
    return 0;
  }
};

// Bullet's capsules lie along y.
btTransform pose_of(const Primitive& phalanx) {
  const btVector3 a = to_bullet(phalanx.end1), b = to_bullet(phalanx.end2);
  btTransform pose;
  pose.setIdentity();
  pose.setOrigin((a + b) / 2);
  if ((b - a).length2() > 0) pose.setRotation(shortestArcQuat(btVector3(0, 1, 0), (b - a).normalized()));
  return pose;
}

struct TreeHits : btTriangleCallback {
  const Mesh* mesh = nullptr;
  const Primitive* phalanx = nullptr;
  std::uint64_t primitive = 0;
  std::vector<PeerContact>* contacts = nullptr;
  void processTriangle(btVector3*, int, int triangle) override {
    const Triangle& t = mesh->triangles[static_cast<std::size_t>(triangle)];
    ScalarContact contact;
    if (scalar_contact(*phalanx, mesh->vertices[t[0]], mesh->vertices[t[1]], mesh->vertices[t[2]], contact))
      contacts->push_back(
          {primitive << 32 | static_cast<std::uint32_t>(triangle), contact.depth, contact.area});
  }
};

}  // namespace

Peer make_bullet(const Mesh& mesh) {
  const auto world = std::make_shared<BulletWorld>(mesh);
  return {"Bullet 3", false, [world](std::span<const Primitive> hand, std::vector<PeerContact>& contacts) {
            for (std::size_t i = 0; i < hand.size(); ++i) {
              const btVector3 span = to_bullet(hand[i].end2 - hand[i].end1);
              btCapsuleShape capsule(static_cast<btScalar>(kMillimetres * hand[i].radius1), span.length());
              btCollisionObject object;
              object.setCollisionShape(&capsule);
              object.setWorldTransform(pose_of(hand[i]));
              Collector collector;
              collector.primitive = i;
              collector.contacts = &contacts;
              world->world.contactPairTest(&object, &world->ground, collector);
            }
          }};
}

Peer make_bullet_tree(const Mesh& mesh) {
  const auto tree = std::make_shared<BulletMesh>(mesh);
  const auto source = std::make_shared<Mesh>(mesh);
  return {"Bullet's tree + scalar area", true,
          [tree, source](std::span<const Primitive> hand, std::vector<PeerContact>& contacts) {
            for (std::size_t i = 0; i < hand.size(); ++i) {
              TreeHits hits;
              hits.mesh = source.get();
              hits.phalanx = &hand[i];
              hits.primitive = i;
              hits.contacts = &contacts;
              const btVector3 a = to_bullet(hand[i].end1), b = to_bullet(hand[i].end2);
              const auto reach = static_cast<btScalar>(kMillimetres * hand[i].radius1 * (1 + 1e-5));
              btVector3 low = a, high = a;
              low.setMin(b);
              high.setMax(b);
              const btVector3 margin(reach, reach, reach);
              tree->shape->processAllTriangles(&hits, low - margin, high + margin);
            }
          }};
}

}  // namespace lumbrical::bench
