// What became of the objects that a hand can move: how far they went, and how hard they were pushed.
#pragma once

#include <span>
#include <vector>

#include "lumbrical/model.h"
#include "output.h"

namespace lumbrical::tool {

/// Of one object in a session. Of two hands, whose ticks are given what moves, none has a coordinate.
struct MovedObject {
  double least = 0, most = 0, last = 0;       ///< q of a hinge [rad] or slider [m]
  double farthest = 0, most_turned = 0;       ///< of all others, from the start: [m], [rad]
  double last_distance = 0, last_turned = 0;  ///< where they are at the end
  double peak_force = 0;                      ///< [N] of a hand on it
};

/// `objects` is as long as Model::apart, or empty before the first tick.
void note_objects(const Model& model, std::span<const ObjectOutput> outputs,
                  std::vector<MovedObject>& objects);

/// What moves, an object a row.
void add_moved(const Model& model, std::span<const MovedObject> objects, Table& table);
/// The same, all of them; empty where nothing moves.
Json moved_json(const Model& model, std::span<const MovedObject> objects);

}  // namespace lumbrical::tool
