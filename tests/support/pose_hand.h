// From a frame to all that the exact rung asks of a hand.
#pragma once

#include "stages/hand_pose.h"

namespace lumbrical::test {

inline void pose_hand(const Hand& hand, const Settings& settings, const DeviceFrame& frame,
                      Primitives& primitives) {
  static_cast<void>(place_hand(hand, settings, frame, primitives));
  shape_hand(hand, primitives);
  tile_hand(settings, primitives);
}

}  // namespace lumbrical::test
