// The Jacobian of one contact under the field law: how its wrench changes when the segment it belongs to
// moves. What moving means is said in lumbrical/jacobian.h, the formula stands in docs/mechanics.md.
#pragma once

#include "lumbrical/contact.h"
#include "model/corners.h"
#include "model/swept_polygon.h"
#include "section/pressure.h"

namespace lumbrical {

/// Adds to `sum` the derivative of (force, torque about `joint`) / K_s of `contact`, which the field law
/// found between the triangle `at` [m, W] and a round primitive or a slab. Blocks [m^2 m^3; m^3 m^4].
/// False, and `sum` untouched, where they don't touch and for a flat primitive, whose field doesn't vanish on
/// its ends.
///
/// Of a tile `primitive` has the cuts of this triangle and `bulge` what lies beyond (border_cut.h).
bool add_contact_jacobian(const Primitive& primitive, const Contact& contact, Vec3 joint, const Corners& at,
                          Matrix6& sum, const SlopeMoments& bulge = {});
bool add_contact_jacobian(const Slab& slab, const Contact& contact, Vec3 joint, const Corners& at,
                          Matrix6& sum);

}  // namespace lumbrical
