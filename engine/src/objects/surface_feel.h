// How a surface that is not plain (surface.h) turns a segment's force, and how rough it is there.
//
// The force by the field law is the integral of pressure times the triangles' normals. Shading takes the
// normals interpolated between a triangle's corners in their place, for the direction alone: these are linear
// in each triangle, so each contact's is the one at its centre of pressure, without any rule or sample.
// Whichever triangles turn by however much, the integral's direction is as continuous as the force. Friction
// factors are the same mean of pressure. Bumps tilt the direction by their slope under the patch.
#pragma once

#include "lumbrical/tick.h"
#include "model/felt_surface.h"
#include "objects/contact_patch.h"

namespace lumbrical {

/// What the triangles of FeltSurface::part say, of each segment.
struct SurfaceSums {
  std::array<Vec3, kSegmentCount> turn{};  ///< [N] O, what shading would add to the force
  std::array<Vec3, kSegmentCount> rub{};   ///< [N] O, the force times the factor of friction minus 1
};

/// Of the hand that `felt` has placed and felt the object of this `shape` with; takes the candidates and
/// contacts in it for its own. What several bodies hold counts as in the field. Adds TickFlag bits to
/// `flags`.
SurfaceSums sum_surface(const FeltSurface& surface, const Model& shape, Scratch& felt, std::uint32_t& flags);

/// A segment's part of it, and the force [N] O that the object's field has on it, without pads' layers and
/// what else pushes.
struct SurfacePart {
  Vec3 turn, rub, field;
};

/// What rubs at a patch of an object of this material.
Material material_at(const FeltSurface& surface, const SurfacePart& part, const ContactPatch& patch,
                     Material material);

/// Turns a patch's normal, by at most 45 degrees for shading and as much for bumps, and with it the wrench
/// [N], [N m] on its segment, about the base joint [m] O; the force stays as large as it was.
void turn_force(const FeltSurface& surface, const SurfacePart& part, Vec3 base_joint, ContactPatch& patch,
                Wrench& pressed);

}  // namespace lumbrical
