// Hand pose: from what the device says to posed primitives.
#pragma once

#include "lumbrical/device.h"
#include "lumbrical/model.h"
#include "model/primitive.h"

namespace lumbrical {

/// TickFlag bits that say what is wrong with a frame; 0 where it can be used as it is.
std::uint32_t check_input(const DeviceFrame& frame);

/// Poses the hand's primitives in W. Segments whose joints are missing are left out. Returns TickFlag bits.
/// The frame must have passed check_input.
std::uint32_t pose_hand(const Hand& hand, const Settings& settings, const DeviceFrame& frame,
                        Primitives& primitives);

}  // namespace lumbrical
