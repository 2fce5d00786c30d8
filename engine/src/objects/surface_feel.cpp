#include "objects/surface_feel.h"

#include <algorithm>
#include <cmath>

#include "base/shortened.h"
#include "model/corners.h"
#include "stages/broadphase.h"
#include "stages/exact_overlaps.h"
#include "stages/feel_model.h"
#include "stages/hand_pose.h"
#include "stages/narrowphase.h"

namespace lumbrical {
namespace {

// Most that shading adds to the direction of a force, the sine of 45 degrees.
constexpr double kMostTurn = 0.70710678118654757;

// Of a segment's force, where its field is less than this share of it: there what the field says counts less.
constexpr double kLeastField = 0.05;

// [m] Skin feels no slope over less than half a millimetre, however light its touch.
constexpr double kFinestRadius = 5e-4;

double area_of(Vec3 a, Vec3 b, Vec3 c, Vec3 normal) { return dot(cross(b - a, c - a), normal); }

// Of vectors at the corners, at a point of the triangle.
Vec3 interpolated(const std::array<Vec3, 3>& of_corner, const Corners& at, Vec3 normal, Vec3 point) {
  const double u = max(0, area_of(point, at.b, at.c, normal)), v = max(0, area_of(at.a, point, at.c, normal)),
               w = max(0, area_of(at.a, at.b, point, normal)), all = u + v + w;
  if (!(all > 0)) return {};
  return (u * of_corner[0] + v * of_corner[1] + w * of_corner[2]) / all;
}

// The radius of the paraboloid of pressure that has a patch's effective radius.
double pressure_radius(const ContactPatch& patch) {
  const double radius = 15.0 / 8 * patch.radius;
  return std::sqrt(radius * radius + kFinestRadius * kFinestRadius);
}

// [N] What the patch's force is compared with.
double field_of(const SurfacePart& part, const ContactPatch& patch) {
  return max(norm(part.field), kLeastField * patch.force);
}

Vec3 shaded(const SurfacePart& part, const ContactPatch& patch) {
  if (part.turn == Vec3{}) return patch.normal;  // to the bit
  const Vec3 normal = patch.normal + shortened(part.turn / field_of(part, patch), kMostTurn);
  return normal / norm(normal);
}

Vec3 tilted(const TextureMeans& bumps, const ContactPatch& patch) {
  const Vec3 slope = slope_under(bumps, patch.centre, patch.normal, pressure_radius(patch));
  const Vec3 normal = patch.normal - slope / std::sqrt(1 + dot(slope, slope));
  return normal / norm(normal);
}

// On the shortest way that takes one unit vector to another, less than half a turn away.
Vec3 turned(Vec3 v, Vec3 from, Vec3 to) {
  const Vec3 axis = cross(from, to), across = cross(axis, v);
  return v + across + cross(axis, across) / (1 + dot(from, to));
}

}  // namespace

SurfaceSums sum_surface(const FeltSurface& surface, const Model& shape, Scratch& felt, std::uint32_t& flags) {
  SurfaceSums sums;
  const Model& part = surface.part;
  Primitives& hand = *felt.primitives;
  if (surface.triangle.empty() || hand.out_of_reach) return sums;
  tile_hand(part.settings, hand);
  if (!find_candidates(part, hand, felt)) {
    flags |= kCandidateOverflow;
    return sums;
  }
  const std::uint32_t count =
      collide_pairs(part, hand, {felt.candidates.data(), felt.candidate_count}, felt.contacts);
  const std::span<Contact> contacts(felt.contacts.data(), count);
  // The shape has the same triangles, and a precision that ends the search for borders earlier.
  take_off_overlaps(shape, hand, segments_felt_once(shape), contacts, felt.sorting);
  for (const Contact& contact : contacts) {
    const auto found = std::lower_bound(surface.triangle.begin(), surface.triangle.end(), contact.triangle);
    const auto place = static_cast<std::size_t>(found - surface.triangle.begin());
    const std::size_t segment = hand.primitive[contact.primitive].segment;
    const double push = part.settings.stiffness * contact.volume;
    const Corners at = corners_of(part.triangles, contact.triangle);
    sums.turn[segment] += push * interpolated(surface.turn[place], at, contact.normal, contact.centre);
    sums.rub[segment] += (push * surface.rub[place]) * contact.normal;
  }
  return sums;
}

Material material_at(const FeltSurface& surface, const SurfacePart& part, const ContactPatch& patch,
                     Material material) {
  const double more = dot(part.rub, patch.normal) / field_of(part, patch);
  double factor = 1 + clamp(more, surface.least_rub, surface.most_rub);
  if (surface.grip.width > 0)
    factor *= value_under(surface.grip, patch.centre, patch.normal, pressure_radius(patch));
  material.static_friction *= factor;
  material.kinetic_friction *= factor;
  material.viscosity *= factor;
  return material;
}

void turn_force(const FeltSurface& surface, const SurfacePart& part, Vec3 base_joint, ContactPatch& patch,
                Wrench& pressed) {
  const Vec3 before = patch.normal;
  patch.normal = shaded(part, patch);
  if (surface.bumps.width > 0) patch.normal = tilted(surface.bumps, patch);
  const Vec3 force = turned(pressed.force, before, patch.normal), more = force - pressed.force;
  pressed = {force, pressed.torque + cross(patch.centre - base_joint, more)};
}

}  // namespace lumbrical
