// Dry friction of one patch: Coulomb's, with stick and slip, for sliding and twisting together.
//
// While it sticks the skin is an elastic anchor: drawn sideways and turned about the normal by as much as the
// segment has moved relative to the object at the patch, so that rolling, which moves the patch but not the
// skin in it, draws nothing, and a skin at rest does not creep. Both together stay within the ellipsoid limit
// surface (Howe and Cutkosky 1996): (f / mu N)^2 + (tau / (mu N r))^2 <= 1; what is beyond slides. So
// friction begins and ends with the normal force, and no transition is a jump.
#pragma once

#include "lumbrical/object.h"
#include "objects/contact_patch.h"

namespace lumbrical {

/// On the segment, in the frame O of the object.
struct Friction {
  Vec3 force;                        ///< [N] at the patch's centre
  Vec3 torque;                       ///< [N m] along its normal
  double most = 0, most_torque = 0;  ///< [N], [N m] each without the other
};

/// Friction of a patch [O] whose segment is now at X_OS, `dt` [s] after `grip` was left; updates `grip`.
Friction rub(const Material& material, const ContactPatch& patch, const Pose& X_OS, double dt,
             GripState& grip);

/// [N m/rad] Of a patch that sticks, about its normal.
double twist_stiffness(const Material& material);

/// How much of a change of force and torque [O], 0 to 1, the skin takes part in before it slides; where it
/// slides already, until it would slide the other way.
double share_that_sticks(const Friction& friction, Vec3 force, Vec3 torque);

/// How much of a patch sticks in a step, 0 to 1: what it has at the speed that a step taken with it
/// ends with. Below 0: not known yet.
struct Share {
  double now = -1;                ///< of the step to come
  double taken = -1, found = -1;  ///< of the one before: with which, and what it then had
};

/// Of a step taken with `sticks.now`, at whose end `found` stick.
Share next_share(const Share& sticks, double found);

/// The largest s from 0 to 1 with |now + s more| <= 1, of the squares of both and their product.
double share_within(double now, double product, double more);

}  // namespace lumbrical
