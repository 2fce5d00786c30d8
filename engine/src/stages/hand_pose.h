// Hand pose: from what the device says to posed primitives.
#pragma once

#include "lumbrical/device.h"
#include "lumbrical/model.h"
#include "model/primitive.h"

namespace lumbrical {

/// TickFlag bits that say what is wrong with a frame; 0 where it can be used as it is.
std::uint32_t check_input(const DeviceFrame& frame);

/// Poses joints and whole phalanges in W and empties the list of primitives. Segments whose joints are
/// missing are left out. Returns TickFlag bits. The frame must have passed check_input.
[[nodiscard]] std::uint32_t place_hand(const Hand& hand, const Settings& settings, const DeviceFrame& frame,
                                       Primitives& primitives);

/// The same of joints that are placed in a frame W already, as seen from another frame O.
void place_hand(const Hand& hand, const Settings& settings, const Joints& joints, const Pose& X_OW,
                Primitives& primitives);

/// Where segments turn, and about which axis they flex: `shape_hand` does it, too.
void place_axes(Primitives& primitives);

/// False where no part of a hand so placed can touch what is inside the box [m, W].
bool may_meet(const Hand& hand, const Primitives& primitives, const Box& world);

/// The palm of a hand so placed, its axes, and which way phalanges point: all that samples ask for.
void shape_hand(const Hand& hand, Primitives& primitives);

/// Lists the primitives of a hand so shaped, how they border on each other, and which fingers are folded,
/// unless it was done: for the exact rung.
void tile_hand(const Settings& settings, Primitives& primitives);

/// All of it for joints that are placed in W already, as seen from the model's frame O. False where the hand
/// can't touch the model: it has no shape then.
bool tile_hand_in(const Model& model, const Joints& joints, const Pose& X_OW, Primitives& primitives);

}  // namespace lumbrical
