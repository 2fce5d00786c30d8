// Objects that move by themselves, felt by two hands: each hand's tick takes them as given (Mobility::given),
// and between the ticks they move by what both have done. The seam is like that of a physics engine
// (bullet.h), but takes a hand's touches, not their sum:
//
//   SharedObjects shared;  share_objects(scene, execution, shared)
//   build_model(given_objects(scene), execution, one);  share_world(one, other_hand, other)
//   std::vector<ObjectFrame> given = start_frames(one);
//   for every tick:
//     tick(one, ..., given);  push_objects(shared, one, one_scratch);
//     tick(other, ..., given);  push_objects(shared, other, other_scratch);
//     move_objects(shared, given);
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "lumbrical/tick.h"

namespace lumbrical {

/// Where the objects stand at the start that are moved from outside (Mobility::given), in their order.
std::vector<ObjectFrame> start_frames(const Model& model);

/// The scene as hands feel it that share what moves by itself.
Scene given_objects(Scene scene);

struct PushingHands;  // what hands have done since objects moved; shared_objects.cpp

/// It is moved and not copied, as what hands have done is (Scratch).
struct SharedObjects {
  SharedObjects() = default;
  SharedObjects(SharedObjects&&) = default;
  SharedObjects& operator=(SharedObjects&&) = default;
  SharedObjects(const SharedObjects&) = delete;
  SharedObjects& operator=(const SharedObjects&) = delete;

  Model model;                          ///< of the scene as it is; only its objects count
  State state;                          ///< of the objects
  std::shared_ptr<PushingHands> hands;  ///< null: nothing is shared
};

/// Refuses what build_model refuses.
Status share_objects(const Scene& scene, const Execution& execution, SharedObjects& shared);

/// Adds how a hand has touched them in its last tick, and how fast it moves. Hands push in the same order
/// every time, each once, and no more than kMostHands.
void push_objects(SharedObjects& shared, const Model& model, Scratch& scratch);

/// Moves them by a tick, as a tick does for one hand: in the same step, which knows how all hands' forces
/// change within it. But a hand is told what it feels as the tick begins: what an object's momentum changes
/// by it feels a tick later, as far as forces change by what the step takes them to be. `given` has the poses
/// of the next tick, of all objects that are given to hands, in their order; it is told of those that move by
/// themselves.
void move_objects(SharedObjects& shared, std::span<ObjectFrame> given);

}  // namespace lumbrical
