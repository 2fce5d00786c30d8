// The Jacobian of any contact of a hand, by differences: for the few that have no closed form.
#pragma once

#include "exact/exact_kernels.h"
#include "lumbrical/contact.h"
#include "model/corners.h"
#include "model/primitive.h"

namespace lumbrical {

/// Adds to `sum` the derivative of (force, torque about `joint`) / K_s of the contact of contact.primitive
/// with the triangle `at`, as `add_contact_jacobian` does, by central differences of twelve contacts: good to
/// six digits as a rule. False, and `sum` untouched, where these contacts may be off by too much for that.
bool add_contact_differences(const ExactKernels& kernels, const Primitives& hand, const Contact& contact,
                             Vec3 joint, const Corners& at, Matrix6& sum);

}  // namespace lumbrical
