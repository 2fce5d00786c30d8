// How fast the hand's segments move: what pads' damping and objects that go with the hand ask for.
#pragma once

#include <array>
#include <optional>

#include "lumbrical/tick.h"
#include "model/primitive.h"

namespace lumbrical {

/// Of segments' base joints, W.
struct SegmentSpeeds {
  std::array<Twist, kSegmentCount> now{};  ///< from where they were a tick before
  std::array<Twist, kSegmentCount>
      steady{};  ///< the same without what trembles: a mean over some milliseconds
};

/// Of what went from one pose to the other in a tick.
Twist speed_between(const Pose& from, const Pose& to, double rate);

/// Of the placed hand; keeps where it is. All 0 where the model has no use for them (damping, objects that
/// move; the mean is for those only), and where there was no tick before that could be trusted.
SegmentSpeeds speeds_of(const Model& model, bool trusted, const Primitives& hand,
                        std::optional<MotionState>& motion);

}  // namespace lumbrical
