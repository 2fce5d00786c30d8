// Embree 3: its point query finds the triangles near a phalanx, the scalar contact does the rest.
#include <embree3/rtcore.h>

#include <cmath>
#include <memory>

#include "peer.h"
#include "scalar_contact.h"

namespace lumbrical::bench {
namespace {

struct EmbreeScene {
  Mesh mesh;
  std::vector<std::uint32_t> asked;  // by triangle: the number of the phalanx query that looked at it last
  std::uint32_t query = 0;
  RTCDevice device = rtcNewDevice("threads=1");
  RTCScene scene = rtcNewScene(device);
  explicit EmbreeScene(const Mesh& source) : mesh(source), asked(source.triangles.size()) {
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* const points = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
    auto* const corners = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), mesh.triangles.size()));
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      const Vec3 p = mesh.vertices[i];
      points[3 * i] = static_cast<float>(kMillimetres * p.x);
      points[3 * i + 1] = static_cast<float>(kMillimetres * p.y);
      points[3 * i + 2] = static_cast<float>(kMillimetres * p.z);
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) corners[3 * i + k] = mesh.triangles[i][k];
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
  }
  ~EmbreeScene() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;
};

struct Asking {
  EmbreeScene& world;
  const Primitive& phalanx;
  std::uint64_t primitive;
  std::vector<PeerContact>& contacts;
};

bool on_triangle(RTCPointQueryFunctionArguments* arguments) {
  Asking& asking = *static_cast<Asking*>(arguments->userPtr);
  EmbreeScene& world = asking.world;
  if (world.asked[arguments->primID] == world.query) return false;
  world.asked[arguments->primID] = world.query;
  const Triangle& t = world.mesh.triangles[arguments->primID];
  ScalarContact contact;
  if (scalar_contact(asking.phalanx, world.mesh.vertices[t[0]], world.mesh.vertices[t[1]],
                     world.mesh.vertices[t[2]], contact))
    asking.contacts.push_back({asking.primitive << 32 | arguments->primID, contact.depth, contact.area});
  return false;
}

// Points along the axis, a diameter apart at most, and spheres about them that cover the phalanx.
void ask(Asking& asking) {
  const Vec3 span = asking.phalanx.end2 - asking.phalanx.end1;
  const double radius = asking.phalanx.radius1, length = norm(span);
  const int pieces = static_cast<int>(std::ceil(length / (2 * radius))) + (length > 0 ? 0 : 1);
  const double reach = radius + 0.5 * length / pieces;
  for (int i = 0; i < pieces; ++i) {
    const Vec3 p = kMillimetres * (asking.phalanx.end1 + (i + 0.5) / pieces * span);
    RTCPointQuery query;
    query.x = static_cast<float>(p.x);
    query.y = static_cast<float>(p.y);
    query.z = static_cast<float>(p.z);
    query.time = 0;
    query.radius = static_cast<float>(kMillimetres * reach * (1 + 1e-5));
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(asking.world.scene, &query, &context, on_triangle, &asking);
  }
}

}  // namespace

Peer make_embree(const Mesh& mesh) {
  const auto world = std::make_shared<EmbreeScene>(mesh);
  return {"Embree 3's query + scalar area", true,
          [world](std::span<const Primitive> hand, std::vector<PeerContact>& contacts) {
            for (std::size_t i = 0; i < hand.size(); ++i) {
              ++world->query;
              Asking asking{*world, hand[i], i, contacts};
              ask(asking);
            }
          }};
}

}  // namespace lumbrical::bench
