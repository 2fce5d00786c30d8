// The whole hand on a bumpy height field, as benchmarks have it: what touches, how deep, on how many
// triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "pressed_hand.h"

namespace lumbrical::bench {

/// What of the hand touches.
enum class Touch {
  drape,   ///< palm and fingers, pressed flat, sliding along a small circle
  tips,    ///< four bent fingers' tips, the same way
  finger,  ///< the index finger's tip alone
  none,    ///< the hand hovers half a metre above
  jump,    ///< as drape, at another random place of the field in each pose
};

/// Fingers of one radius each and no palm: what every library has a shape for.
Hand plain_hand();

/// Fingers `first` .. 4 bent so that only their tips are `depth` [m] below z = 0, the hand palm down above;
/// `time` 0 .. 1 moves it as in pressed_frame. `first` 1 .. 4; the thumb does not touch.
DeviceFrame tips_frame(const Hand& hand, double depth, double time, std::size_t first = 1,
                       std::size_t last = 4);

/// Scene A (`fine`: 300 mm wide) or B (5 mm triangles) of 2 cells^2 triangles. Forces are neither limited nor
/// faded, and there is room for all candidates.
Scene field_scene(const Hand& hand, bool fine, std::uint32_t cells);

/// `count` poses, `depth` to `depth` + 2 mm deep, on a field `extent` [m] wide.
std::vector<DeviceFrame> touching_frames(const Hand& hand, Touch touch, double extent, int count,
                                         double depth = 0.001);

/// The depth [m] from which touching_frames touch `wanted` triangles on average, as nearly as bisection finds
/// it between -8 and 8 mm.
double depth_touching(const Model& model, Touch touch, double extent, int count, double wanted);

}  // namespace lumbrical::bench
