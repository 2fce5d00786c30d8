// How stiff a palm's contact with an object is. A palm lies flat on what is smaller and on what is larger
// than itself, on rims and on what is round: its wrench does not tell, as a phalanx' does (contact_patch.h),
// how much of it touches. So the palm is felt once more, a little deeper.
#pragma once

#include <cstdint>

#include "lumbrical/tick.h"
#include "model/primitive.h"

namespace lumbrical {

struct PalmStiffness {
  double along = 0;  ///< [N/m] along the patch's normal
  double tilt = 0;   ///< [N m/rad] about the ways across it, as if the patch were square
  double reach = 0;  ///< [m] of that square
};

/// Whether a step of `dt` [s] asks: with all of the palm flat on it a heavy thing moves as an explicit step
/// would have it, too.
bool asks_for_palm_stiffness(const Model& model, const Mechanism& mechanism, const Primitives& hand,
                             double dt);

/// Of a palm that presses along `normal`, its layers included. `felt` has just felt the model: by its field
/// alone the palm felt `field` [N], with layers `force`. Leaves `felt` with the hand that was moved, and adds
/// to `evaluations`.
PalmStiffness palm_stiffness(const Model& model, Vec3 field, Vec3 force, Vec3 normal, Scratch& felt,
                             std::uint64_t& evaluations);

}  // namespace lumbrical
