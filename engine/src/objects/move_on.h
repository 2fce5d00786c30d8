// How an object moves on at the end of a tick: by what touches it, its weight and the ground.
#pragma once

#include "lumbrical/model.h"
#include "lumbrical/tick.h"
#include "objects/body_motion.h"
#include "objects/ground.h"
#include "objects/touches.h"

namespace lumbrical {

/// Moves an object by `dt` [s], whoever's segments touch it; their forces become those at its end. `handle`
/// opens its latch.
///
/// Springs are softened by the speed that the object has, and up to twice more, the step taken anew, by that
/// to which it comes.
void move_on(const Model& model, const ApartObject& object, const ObjectState& handle, double dt,
             std::span<Touch> touches, ObjectState& state);

}  // namespace lumbrical
