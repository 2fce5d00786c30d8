// Objects apart from the world: each is felt in its own frame, rubs, and moves on.
#pragma once

#include "lumbrical/tick.h"
#include "model/primitive.h"
#include "stages/feel_model.h"
#include "stages/segment_speeds.h"

namespace lumbrical {

/// What a tick does with a model's objects apart.
struct ObjectTick {
  const Model& model;
  Primitives& hand;             ///< placed in W
  const SegmentSpeeds& speeds;  ///< of the hand
  bool trusted;                 ///< false: no object feels the hand
};

/// Puts the objects that are moved from outside to where they are told to be; `anew` becomes true where one
/// is told for the first time. Returns TickFlag bits.
std::uint32_t move_given(const Model& model, std::span<const ObjectFrame> given, State& state, bool& anew);

/// Feels every object where it stands, adds what the hand's segments feel to `forces`, and moves those that
/// move by themselves. Adds what it finds to `findings`, which has all that the tick has found before, and
/// TickFlag bits to `flags`.
///
/// The forces are those at the tick's end, as far as they change by what the objects give way in it: what an
/// object feels and what the hand feels is the same to rounding, and is what the object's momentum changes
/// by.
void feel_objects(const ObjectTick& tick, State& state, Scratch& scratch, HandForces& forces,
                  Findings& findings, std::uint32_t& flags);

}  // namespace lumbrical
