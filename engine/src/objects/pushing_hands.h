// What hands do to objects that they take as given: whoever moves these asks for it between ticks.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "lumbrical/shared_objects.h"
#include "objects/touches.h"

namespace lumbrical {

/// What hands have done since objects moved.
struct PushingHands {
  using OfAll = FixedList<Touch, kMostHands * kSegmentCount>;
  std::size_t count = 0;
  std::vector<OfAll> touches;  ///< of Model::apart
  std::array<std::optional<MotionState>, kMostHands> motion;
};

/// Adds how a hand has touched in its last tick, of `model`, what has a mass in `moved`, and how fast it
/// moves. Hands come in the same order every time, each once.
void add_hand(const Model& moved, const Model& model, Scratch& scratch, PushingHands& hands);

/// They have pushed; how they move is kept.
void forget_hands(PushingHands& hands);

}  // namespace lumbrical
