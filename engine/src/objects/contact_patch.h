// One segment's contact with one object as friction and motion see it: where it presses, which way, how hard,
// over how wide a patch, and how stiffly.
#pragma once

#include "lumbrical/model.h"
#include "model/primitive.h"

namespace lumbrical {

struct ContactPatch {
  Vec3 normal;           ///< unit, out of the object
  Vec3 centre;           ///< [m] of pressure
  double force = 0;      ///< [N] along the normal
  double radius = 0;     ///< [m] effective: integral of p r dA over that of p dA
  double stiffness = 0;  ///< [N/m] along the normal; of a palm's a guess (palm_stiffness.h)
};

/// The patch of a segment that feels `wrench` [N], [N m] about its base joint, in the frame of `hand`.
///
/// A wrench tells the line along which a segment is pushed, not where on it the surface lies. So the surface
/// is taken for the plane across that line which would push as hard by the field law of this stiffness
/// [N/m^3]: exact on planes, and near it where the contact is flatter than the finger is round. The palm's
/// patch lies on its skin, as narrow as a sphere of its radius would make it. The wrench is that of the field
/// alone, without `pad`'s layers; the patch's stiffness is with them.
ContactPatch contact_patch(const Primitives& hand, std::size_t segment, const Wrench& wrench,
                           double stiffness, const Pad& pad);

}  // namespace lumbrical
