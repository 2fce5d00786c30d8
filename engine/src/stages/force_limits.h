// Limits: what may go out to a person's fingers. Too much saturates, what can't be trusted fades to zero.
#pragma once

#include "lumbrical/tick.h"
#include "model/primitive.h"

namespace lumbrical {

/// Share of Settings::max_force up to which a segment's force is felt as it is.
inline constexpr double kUnlimitedShare = 0.8;

/// [N] What is let through of `force` >= 0 [N]: all of it up to k = kUnlimitedShare max_force, and beyond
/// that
///   k + (max_force - k) x / sqrt(1 + x^2),   x = (force - k) / (max_force - k),
/// which never exceeds max_force, never falls, and starts with slope 1 and curvature 0: a finger that is
/// pressed harder feels the stiffness fade and no kink.
double saturated(double force, double max_force);

/// May this tick's forces go out?
enum class Trust : std::uint8_t {
  none,
  anew,  ///< they may, but what they are of has changed since the last tick: another set of joints, say
  kept
};

/// Saturates every segment by itself, then mixes fresh and held forces:
///   output = rise * fresh + fall * held.
/// A segment's wrench keeps its line of action: force and torque are scaled alike, so one part pressed too
/// hard takes nothing from the others. Where any is in saturation (kForceLimited), the torque of every joint
/// is the sum over the segments it carries of their limited wrenches about it.
///
/// While forces are trusted, rise grows to 1 within fade_time and fall shrinks to 0. At the first tick
/// without trust, or trusted anew, the last output becomes the held one, which then fades out. So the output
/// never steps, whatever comes in and however often trust changes, and is exactly the fresh force once trust
/// has lasted. Advances `state` to the next tick. contact_count of the answer is left to the caller.
ActuatorFrame limit_forces(const Settings& settings, const Primitives& hand, const HandForces& fresh,
                           Trust trust, std::uint32_t flags, HandState& state);

/// The same of a tick that has computed nothing to be trusted.
ActuatorFrame fade_forces(const Settings& settings, std::uint32_t flags, HandState& state);

}  // namespace lumbrical
