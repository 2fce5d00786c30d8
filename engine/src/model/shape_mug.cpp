// Makes the demo's mug: a profile turned about the z axis, and a round tube swept along half an ellipse.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/elementary.h"
#include "base/floating_point.h"
#include "lumbrical/shapes.h"

namespace lumbrical {
namespace {

constexpr double kPi = std::numbers::pi;

/// A point of the profile in the half plane of the axis: distance r from it, height z.
struct ProfilePoint {
  double r, z;
};
using Profile = std::vector<ProfilePoint>;

/// In how many steps of about `step` a way of `length` is cut; at least `least`.
std::uint32_t step_count(double length, double step, std::uint32_t least) {
  return std::max(least, static_cast<std::uint32_t>(std::floor(length / step + 0.5)));
}

/// From the profile's end, which it has already, straight to `to`.
void append_line(Profile& profile, ProfilePoint to, double step) {
  const ProfilePoint from = profile.back();
  const double dr = to.r - from.r, dz = to.z - from.z;
  const std::uint32_t count = step_count(std::sqrt(dr * dr + dz * dz), step, 1);
  for (std::uint32_t i = 1; i < count; ++i) {
    const double t = static_cast<double>(i) / count;
    profile.push_back({from.r + t * dr, from.z + t * dz});
  }
  profile.push_back(to);
}

/// From the profile's end counter-clockwise round `centre`, starting at the angle `from`, to `to`, which is
/// given because the sum of cosines would miss it by a rounding error.
void append_arc(Profile& profile, ProfilePoint centre, double radius, double from, double turn,
                ProfilePoint to, std::uint32_t count) {
  for (std::uint32_t i = 1; i < count; ++i) {
    const SinCos direction = sin_cos(from + turn * i / count);
    profile.push_back({centre.r + radius * direction.cos, centre.z + radius * direction.sin});
  }
  profile.push_back(to);
}

/// From the axis below the bottom outwards, up, over the rim, down inside and back to the axis: a walk that
/// has the mug's material on its left.
Profile mug_profile(const MugShape& mug, double step) {
  const double round = 0.5 * mug.wall;  // radius of the rim's half circle and of the foot's edge
  const double inner = mug.radius - mug.wall;
  Profile profile{{0, 0}};
  append_line(profile, {mug.radius - round, 0}, step);
  append_arc(profile, {mug.radius - round, round}, round, -0.5 * kPi, 0.5 * kPi, {mug.radius, round}, 4);
  append_line(profile, {mug.radius, mug.height - round}, step);
  append_arc(profile, {mug.radius - round, mug.height - round}, round, 0, kPi, {inner, mug.height - round},
             8);
  append_line(profile, {inner, mug.wall}, step);
  append_line(profile, {0, mug.wall}, step);
  return profile;
}

std::uint32_t append_vertex(Mesh& mesh, Vec3 p) {
  mesh.vertices.push_back(p);
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

/// The band between two rings of `count` vertices that begin at `a` and `b`, facing outwards where the rings
/// turn counter-clockwise about the way from a to b.
void append_band(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t next = (i + 1) % count;
    mesh.triangles.push_back({a + i, a + next, b + next});
    mesh.triangles.push_back({a + i, b + next, b + i});
  }
}

/// A fan from `tip` to the ring at `ring`, facing along the axis the ring turns about counter-clockwise, or
/// against it.
void append_lid(Mesh& mesh, std::uint32_t tip, std::uint32_t ring, std::uint32_t count, bool along_axis) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t next = (i + 1) % count;
    if (along_axis) {
      mesh.triangles.push_back({tip, ring + i, ring + next});
    } else {
      mesh.triangles.push_back({tip, ring + next, ring + i});
    }
  }
}

/// Turns a profile that begins and ends on the axis.
void append_revolution(Mesh& mesh, const Profile& profile, std::uint32_t segments) {
  const std::uint32_t bottom = append_vertex(mesh, {0, 0, profile.front().z});
  const std::uint32_t first_ring = bottom + 1;
  for (std::size_t k = 1; k + 1 < profile.size(); ++k) {
    for (std::uint32_t i = 0; i < segments; ++i) {
      const SinCos direction = sin_cos(2.0 * kPi * i / segments);
      append_vertex(mesh, {profile[k].r * direction.cos, profile[k].r * direction.sin, profile[k].z});
    }
  }
  const std::uint32_t top = append_vertex(mesh, {0, 0, profile.back().z});
  append_lid(mesh, bottom, first_ring, segments, false);
  for (std::uint32_t ring = first_ring; ring + segments < top; ring += segments) {
    append_band(mesh, ring, ring + segments, segments);
  }
  append_lid(mesh, top, top - segments, segments, true);
}

/// The handle's centre line: half an ellipse in the plane y = 0 that begins and ends within the wall, where
/// it runs along x, so that the flat ends of the tube are upright and hidden in the wall.
struct HandleLine {
  double start_x, middle_z, reach, rise;  // x = start_x + reach sin t, z = middle_z - rise cos t, t in 0..pi
};

HandleLine handle_line(const MugShape& mug) {
  const double start_x = mug.radius - 0.5 * mug.wall;
  return {start_x, 0.5 * mug.height, mug.radius + mug.handle_reach - start_x, 0.3 * mug.height};
}

void append_handle(Mesh& mesh, const MugShape& mug, double step) {
  const HandleLine line = handle_line(mug);
  const double length = kPi * std::sqrt(0.5 * (line.reach * line.reach + line.rise * line.rise));  // about
  const std::uint32_t steps = step_count(length, step, 16);
  const std::uint32_t around = std::max(12u, mug.segments / 4);
  const std::uint32_t start = append_vertex(mesh, {line.start_x, 0, line.middle_z - line.rise});
  for (std::uint32_t k = 0; k <= steps; ++k) {
    const SinCos t = sin_cos(kPi * k / steps);
    const Vec3 centre{line.start_x + line.reach * t.sin, 0, line.middle_z - line.rise * t.cos};
    const Vec3 along = unit_or({line.reach * t.cos, 0, line.rise * t.sin}, {1, 0, 0});
    const Vec3 side{0, 1, 0};
    const Vec3 up = cross(along, side);  // along, side, up are right-handed
    for (std::uint32_t i = 0; i < around; ++i) {
      const SinCos direction = sin_cos(2.0 * kPi * i / around);
      append_vertex(mesh, centre + mug.handle_radius * (direction.cos * side + direction.sin * up));
    }
  }
  const std::uint32_t first_ring = start + 1, last_ring = first_ring + steps * around;
  append_lid(mesh, start, first_ring, around, false);
  for (std::uint32_t ring = first_ring; ring < last_ring; ring += around)
    append_band(mesh, ring, ring + around, around);
  const std::uint32_t end = append_vertex(mesh, {line.start_x, 0, line.middle_z + line.rise});
  append_lid(mesh, end, last_ring, around, true);
}

/// At least how far from the axis' plane x = 0 the wall's outside is at a distance y from the handle's plane.
double wall_behind(const MugShape& mug, double y) {
  const SinCos half_turn = sin_cos(kPi / mug.segments), turn = sin_cos(2.0 * kPi / mug.segments);
  // The wall's polygon has a corner in the handle's plane; from there it falls back along an edge.
  if (y < mug.radius * turn.sin) return mug.radius - y * half_turn.sin / half_turn.cos;
  const double inside = mug.radius * half_turn.cos;  // radius of the circle all edges are outside of
  return y < inside ? std::sqrt(inside * inside - y * y) : 0;
}

/// Can the mug be made? The tube must not bend tighter than its own radius, and its ends must fit into the
/// wall.
bool is_sound(const MugShape& mug) {
  for (const double length : {mug.radius, mug.height, mug.wall, mug.handle_radius, mug.handle_reach}) {
    if (!(length > 0 && length < 1e3)) return false;
  }
  if (mug.segments < 8 || mug.segments > 2048) return false;
  if (!(mug.wall < 0.5 * mug.radius && 2.0 * mug.wall < mug.height)) return false;
  const HandleLine line = handle_line(mug);
  const double tightest = min(line.rise * line.rise / line.reach, line.reach * line.reach / line.rise);
  const bool bends = mug.handle_radius < 0.9 * tightest;
  const bool hidden = wall_behind(mug, mug.handle_radius) > line.start_x;
  const bool within_height = line.rise + mug.handle_radius < 0.5 * mug.height - mug.wall;
  return bends && hidden && within_height;
}

}  // namespace

Mesh make_mug(const MugShape& shape) {
  const FloatingPointGuard guard;
  if (!is_sound(shape)) return {};
  const double step = 2.0 * kPi * shape.radius / shape.segments;
  // A tall thin mug could ask for any number of rings.
  if (shape.height / step > 4096 || shape.handle_reach / step > 4096) return {};
  Mesh mesh;
  append_revolution(mesh, mug_profile(shape, step), shape.segments);
  append_handle(mesh, shape, step);
  return mesh;
}

}  // namespace lumbrical
