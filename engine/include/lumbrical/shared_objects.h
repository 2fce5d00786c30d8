// Objects that move by themselves, felt by two hands: each hand's tick takes them as given (Mobility::given),
// and between the ticks they move by what both have done. The seam is that of a physics engine (bullet.h):
//
//   SharedObjects shared;  share_objects(scene, execution, shared)
//   build_model(given_objects(scene), execution, one);  share_world(one, other_hand, other)
//   std::vector<ObjectFrame> given = start_frames(one);
//   for every tick:
//     tick(one, ..., given);  push_objects(shared, one_scratch.object_output);
//     tick(other, ..., given);  push_objects(shared, other_scratch.object_output);
//     move_objects(shared, given);
#pragma once

#include <span>
#include <vector>

#include "lumbrical/tick.h"

namespace lumbrical {

/// Where the objects stand at the start that are moved from outside (Mobility::given), in their order.
std::vector<ObjectFrame> start_frames(const Model& model);

/// The scene as hands feel it that share what moves by itself.
Scene given_objects(Scene scene);

struct SharedObjects {
  Model model;                 ///< of the scene as it is; only its objects count
  State state;                 ///< of the objects
  std::vector<Wrench> pushed;  ///< since they moved: [N], [N m] about O's origin, W
};

/// Refuses what build_model refuses.
Status share_objects(const Scene& scene, const Execution& execution, SharedObjects& shared);

/// Adds what a hand has done to them in a tick: its Scratch::object_output.
void push_objects(SharedObjects& shared, std::span<const ObjectOutput> outputs);

/// Moves them by a tick, as a tick does for one hand, but that it can't know how the hands' forces change
/// within it: stable up to a stiffness of 4 m / dt^2, and a force times Pad::damping of m / dt. `given` has
/// the poses of the next tick, of all objects that are given to hands, in their order; it is told of those
/// that move by themselves.
void move_objects(SharedObjects& shared, std::span<ObjectFrame> given);

}  // namespace lumbrical
