// How an object moves on at the end of a tick: by what touches it, its weight and the ground.
#pragma once

#include "lumbrical/model.h"
#include "lumbrical/tick.h"
#include "objects/body_motion.h"
#include "objects/ground.h"

namespace lumbrical {

/// Moves an object by a tick under `wrench` [about its centre of mass, W] of those who touch it and give way
/// like `springs`, to which the ground's are added. `handle` opens its latch. Returns the speed it then has.
Twist move_on(const Model& model, const ApartObject& object, Wrench wrench, const ObjectState& handle,
              Springs& springs, ObjectState& state);

}  // namespace lumbrical
