// How fast the hand's segments move: what pads' damping and objects that go with the hand ask for.
#pragma once

#include <array>
#include <optional>

#include "lumbrical/tick.h"
#include "model/primitive.h"

namespace lumbrical {

/// Of segments' base joints, W: means over some milliseconds.
using SegmentSpeeds = std::array<Twist, kSegmentCount>;

/// How the skin moves that lies `arm` [m, W] from a segment's base joint.
inline Twist skin_speed(const SegmentSpeeds& speeds, std::size_t segment, Vec3 arm) {
  const auto& [velocity, angular_velocity] = speeds[segment];
  return {velocity + cross(angular_velocity, arm), angular_velocity};
}

/// Of what went from one pose to the other in a tick.
Twist speed_between(const Pose& from, const Pose& to, double rate);

/// The mean over some milliseconds, until now `mean`, with the speed of one more tick, which counts for no
/// more than a hand's; 0 after a jump. Where a tracker holds its samples, a hand goes by steps: those are no
/// jumps.
Twist steadied(const Twist& mean, const Twist& now, double rate);

/// Is the wrist or a fingertip farther from where it was a tick before than a hand goes? Then a tracker took
/// something else for it, or someone moved the frame that it counts in. Keeps where they are.
bool has_jumped(const Joints& joints, double rate, HandState& state);

/// Of the placed hand; keeps where it is. All 0 where there was no tick before that could be trusted.
SegmentSpeeds speeds_of(double rate, bool trusted, const Primitives& hand,
                        std::optional<MotionState>& motion);

/// As a tick of the model asks for them: all 0, and nothing is kept, where it has no use for them (damping,
/// objects that move).
SegmentSpeeds speeds_asked_for(const Model& model, bool trusted, const Primitives& hand,
                               std::optional<MotionState>& motion);

}  // namespace lumbrical
