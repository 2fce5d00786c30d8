// Limits: what may go out to a person's fingers. Too much is scaled down, what can't be trusted fades to
// zero.
#pragma once

#include "lumbrical/tick.h"

namespace lumbrical {

/// Scales down every segment above max_force, then mixes fresh and held forces:
///   output = rise * fresh + fall * held.
/// While forces are trusted, rise grows to 1 within fade_time and fall shrinks to 0. At the first tick
/// without trust the last output becomes the held one, which then fades out. So the output never steps,
/// whatever comes in and however often trust changes, and is exactly the fresh force once trust has lasted.
/// Advances `state` to the next tick. contact_count of the answer is left to the caller.
ActuatorFrame limit_forces(const Settings& settings, HandForces fresh, bool trusted, std::uint32_t flags,
                           State& state);

}  // namespace lumbrical
