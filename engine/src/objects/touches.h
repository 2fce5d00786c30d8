// What the hand's segments do to an object within a tick: as both move on, forces change.
#pragma once

#include "base/fixed_list.h"
#include "model/primitive.h"
#include "objects/body_motion.h"
#include "objects/friction.h"

namespace lumbrical {

inline Wrench operator+(const Wrench& a, const Wrench& b) { return {a.force + b.force, a.torque + b.torque}; }
inline Wrench operator-(const Wrench& a) { return {-a.force, -a.torque}; }
inline Wrench rotated(Quat q, const Wrench& a) { return {rotate(q, a.force), rotate(q, a.torque)}; }

/// The same about a point that lies `arm` before it.
inline Wrench about(Vec3 arm, const Wrench& a) { return {a.force, a.torque + cross(arm, a.force)}; }

/// What a segment feels of an object.
struct Touch {
  std::size_t segment = 0;
  Wrench wrench;                 ///< W, about the segment's base joint
  Vec3 arm;                      ///< [m] W, of the patch from that joint
  Spring spring;                 ///< as the object has it; it hangs on the skin
  Friction friction;             ///< O
  double across = 0, about = 0;  ///< the spring's while skin sticks
  double reach = 0;              ///< [m] how far from its middle a patch presses that resists tilting
};

/// Of all segments, in their order.
using Touches = FixedList<Touch, kSegmentCount>;

/// What the hand does to the object, about its centre of mass [W].
Wrench wrench_on_object(const Touches& touches, const Primitives& hand, Vec3 centre);

/// No finger pulls, none presses more than twice as hard as at the step's beginning, and none rubs harder
/// than friction holds by what presses now, but what slides is held as soon as it would turn round: springs
/// are made so for a step that ends with this speed. True where some change. `orientation` is the object's.
bool soften(const Twist& speed, double dt, Quat orientation, Touches& touches);

/// As the object gives way in a step that ends with this speed, so do the forces.
void give_way(const Twist& speed, double dt, Touches& touches);

}  // namespace lumbrical
