// Motions of trackers that deliver points: which hand it is shows only once all frames are read, and how its
// joints are turned depends on that. So points are gathered first and hands are built behind the last of
// them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lumbrical/motion.h"
#include "model/hand_from_positions.h"

namespace lumbrical {

/// Appends a sample as append_sample does, lost until its hand is built, and its points to `frames`. Points
/// of which none is known are those of a lost hand.
Status append_points(const std::string& name, const std::string& where, double time, const HandPoints& points,
                     std::vector<HandPoints>& frames, Motion& motion);

/// Builds the hand of each sample from its points, as one of that side.
void build_hands(Side side, std::vector<HandPoints>& frames, Motion& motion);

/// Likewise, as the hand that it is: told by the bend of the fingers; where they are straight, it is what is
/// said, or else a right one. Refuses a bend that contradicts; `remedy` ends the message.
Status build_told_by_shape(const std::string& name, std::optional<Side> said, const std::string& remedy,
                           std::vector<HandPoints>& frames, Motion& motion);

/// The remedy where the caller said the side: to say the other.
std::string set_other_side(Side said);

}  // namespace lumbrical
