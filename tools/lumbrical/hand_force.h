// The force of a whole hand.
#pragma once

#include "lumbrical/device.h"
#include "lumbrical/math.h"

namespace lumbrical::tool {

/// [N] All segments together.
inline Vec3 hand_force(const ActuatorFrame& output) {
  Vec3 sum;
  for (const Wrench& wrench : output.segment) sum += wrench.force;
  return sum;
}

}  // namespace lumbrical::tool
