// What the paper's related work does for a hand, each in its simplest form: contact of points and spheres, by
// the triangle nearest to each (bracketed numbers are the paper's references).
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "model/corner_normals.h"
#include "nearest_grid.h"
#include "peer.h"

namespace lumbrical::bench {
namespace {

constexpr double kPi = std::numbers::pi, kGoldenAngle = kPi * (3 - 2.23606797749978969);

using Contacts = std::vector<PeerContact>;

bool is_fingertip(const Primitive& phalanx) { return phalanx.segment % 3 == 2; }

// A ball is in by its radius less the distance of its centre in front of the surface.
void add_ball(const NearestGrid& grid, std::size_t primitive, Vec3 centre, double radius,
              Contacts& contacts) {
  NearestTriangle nearest;
  if (grid.find(centre, radius, nearest))
    contacts.push_back({primitive << 32 | nearest.triangle, radius - nearest.distance, 0});
}

// A point is in where it is behind the surface.
void add_point(const NearestGrid& grid, std::size_t primitive, Vec3 point, double reach, Contacts& contacts) {
  NearestTriangle nearest;
  if (grid.find(point, reach, nearest) && nearest.distance < 0)
    contacts.push_back({primitive << 32 | nearest.triangle, -nearest.distance, 0});
}

// A phalanx's axis and two directions across it.
struct Frame {
  Vec3 along, across1, across2;
};
Frame frame_of(const Primitive& phalanx) {
  const Vec3 along = unit_or(phalanx.end2 - phalanx.end1, {1, 0, 0});
  const Vec3 side = std::fabs(along.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 across = unit_or(cross(along, side), {});
  return {along, across, cross(along, across)};
}

// Calls take(point) for points evenly on a capsule, each for `area` [m^2] of it.
template <class Take>
void for_skin(const Primitive& phalanx, double area, const Take& take) {
  const Frame frame = frame_of(phalanx);
  const double length = norm(phalanx.end2 - phalanx.end1), radius = phalanx.radius1,
               height = length + 2 * radius;
  // A capsule's skin has as much area per height as a cylinder's (Archimedes).
  const auto count = static_cast<std::size_t>(2 * kPi * radius * height / area);
  for (std::size_t i = 0; i < count; ++i) {
    const double at = height * (static_cast<double>(i) + 0.5) / static_cast<double>(count) - radius;
    const double axial = clamp(at, 0, length), beyond = at - axial;
    const double ring = std::sqrt(max(0, radius * radius - beyond * beyond));
    const double angle = kGoldenAngle * static_cast<double>(i);
    take(phalanx.end1 + at * frame.along +
         ring * (std::cos(angle) * frame.across1 + std::sin(angle) * frame.across2));
  }
}

/// Voxels within kBand of the surface, each with the triangle nearest to its centre.
struct Voxels {
  static constexpr double kSize = 0.002, kBand = 0.005;
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  Mesh mesh;
  std::vector<Vec3> normal;
  Vec3 low;
  std::array<std::size_t, 3> count{};
  std::vector<std::uint32_t> triangle;

  explicit Voxels(const Mesh& source);
  [[nodiscard]] std::uint32_t at(Vec3 p) const {
    const Vec3 place = (p - low) / kSize;
    if (!(place.x >= 0 && place.y >= 0 && place.z >= 0)) return kNone;
    const std::array<std::size_t, 3> cell = {static_cast<std::size_t>(place.x),
                                             static_cast<std::size_t>(place.y),
                                             static_cast<std::size_t>(place.z)};
    if (cell[0] >= count[0] || cell[1] >= count[1] || cell[2] >= count[2]) return kNone;
    return triangle[cell[0] + count[0] * (cell[1] + count[1] * cell[2])];
  }
};

Voxels::Voxels(const Mesh& source) : mesh(source) {
  Vec3 high = low = mesh.vertices.front();
  for (const Vec3 p : mesh.vertices) {
    low = {min(low.x, p.x), min(low.y, p.y), min(low.z, p.z)};
    high = {max(high.x, p.x), max(high.y, p.y), max(high.z, p.z)};
  }
  const Vec3 band{kBand, kBand, kBand};
  low = low - band;
  const Vec3 extent = high + band - low;
  count = {static_cast<std::size_t>(extent.x / kSize) + 1, static_cast<std::size_t>(extent.y / kSize) + 1,
           static_cast<std::size_t>(extent.z / kSize) + 1};
  triangle.assign(count[0] * count[1] * count[2], kNone);
  for (const Triangle& t : mesh.triangles) normal.push_back(triangle_normal(mesh, t));
  const NearestGrid grid(mesh);
  NearestTriangle nearest;
  for (std::size_t i = 0; i < triangle.size(); ++i) {
    const std::size_t x = i % count[0], y = i / count[0] % count[1], z = i / count[0] / count[1];
    const Vec3 centre = low + kSize * Vec3{static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5,
                                           static_cast<double>(z) + 0.5};
    if (grid.find(centre, kBand, nearest)) triangle[i] = nearest.triangle;
  }
}

Peer baseline(const char* name, const char* leaves_out,
              std::function<void(std::span<const Primitive>, Contacts&)> find) {
  return {name, false, std::move(find), leaves_out};
}

}  // namespace

Peer make_point_probes(const Mesh& mesh) {
  const auto grid = std::make_shared<NearestGrid>(mesh);
  return baseline("fingertip probes [8,10,19]", "all but one point of each fingertip",
                  [grid](std::span<const Primitive> hand, Contacts& contacts) {
                    for (std::size_t i = 0; i < hand.size(); ++i) {
                      if (is_fingertip(hand[i])) add_ball(*grid, i, hand[i].end2, hand[i].radius2, contacts);
                    }
                  });
}

Peer make_point_meshes(const Mesh& mesh) {
  constexpr double kArea = 8e-6;    // [m^2] a point: some fifty on a fingertip
  constexpr double kReach = 0.004;  // [m] how deep a point may be in
  const auto grid = std::make_shared<NearestGrid>(mesh);
  return baseline("points on fingertips [15]", "all but the fingertips; areas, volumes and torques",
                  [grid](std::span<const Primitive> hand, Contacts& contacts) {
                    for (std::size_t i = 0; i < hand.size(); ++i) {
                      if (!is_fingertip(hand[i])) continue;
                      Primitive tip = hand[i];
                      tip.end1 = tip.end2;
                      for_skin(tip, kArea, [&](Vec3 p) { add_point(*grid, i, p, kReach, contacts); });
                    }
                  });
}

Peer make_sphere_hand(const Mesh& mesh) {
  const auto grid = std::make_shared<NearestGrid>(mesh);
  return baseline("hand of spheres [22]", "areas, volumes and torques: of every sphere one point",
                  [grid](std::span<const Primitive> hand, Contacts& contacts) {
                    for (std::size_t i = 0; i < hand.size(); ++i) {
                      const Vec3 axis = hand[i].end2 - hand[i].end1;
                      const double steps = std::ceil(2 * norm(axis) / hand[i].radius1);
                      for (double k = 0; k <= steps; ++k)
                        add_ball(*grid, i, hand[i].end1 + k / max(steps, 1) * axis, hand[i].radius1,
                                 contacts);
                    }
                  });
}

Peer make_point_shell(const Mesh& mesh) {
  const auto voxels = std::make_shared<Voxels>(mesh);
  return baseline("voxels and a point shell [11,17]", "what is finer than 2 mm; areas, volumes and torques",
                  [voxels](std::span<const Primitive> hand, Contacts& contacts) {
                    for (std::size_t i = 0; i < hand.size(); ++i) {
                      for_skin(hand[i], Voxels::kSize * Voxels::kSize, [&](Vec3 p) {
                        const std::uint32_t t = voxels->at(p);
                        if (t == Voxels::kNone) return;
                        const Vec3 corner = voxels->mesh.vertices[voxels->mesh.triangles[t][0]];
                        const double depth = dot(corner - p, voxels->normal[t]);
                        if (depth > 0) contacts.push_back({std::uint64_t{i} << 32 | t, depth, 0});
                      });
                    }
                  });
}

}  // namespace lumbrical::bench
