// What hands' segments do to an object within a tick: as both move on, forces change.
#pragma once

#include <span>
#include <vector>

#include "base/fixed_list.h"
#include "objects/body_motion.h"
#include "objects/friction.h"
#include "objects/palm_stiffness.h"

namespace lumbrical {

/// What a segment feels of an object.
struct Touch {
  std::size_t segment = 0;
  Vec3 joint;                    ///< [m] W, the segment's base joint
  Wrench wrench;                 ///< W, about that joint
  Vec3 arm;                      ///< [m] W, of the patch from that joint
  Spring spring;                 ///< as the object has it; it hangs on the skin
  Friction friction;             ///< O
  double across = 0, about = 0;  ///< the spring's while skin sticks
  Share sticks{};                ///< of the spring's, what skin has of a step
  double reach = 0;              ///< [m] how far from its middle a patch presses that resists tilting
  double damper = 0;             ///< [N s/m] of its pad, along the normal
  double guess = 0;              ///< [N/m] of the spring's: a palm's that was not asked (palm_stiffness.h)
};

/// Of all segments of a hand, in their order.
using Touches = FixedList<Touch, kSegmentCount>;

/// What a hand's tick leaves of its touches to who moves the objects that are given to it.
struct HandTouches {
  std::vector<Touches> object;  ///< of Model::apart; none of those that are not given
  bool trusted = false;         ///< whether the hand was in that tick
};

/// What hands do to the object, about its centre of mass [W].
Wrench wrench_on_object(std::span<const Touch> touches, Vec3 centre);

/// A step of `dt` [s] takes a damper as a spring that is slack now: what the touch's does at the speed that
/// the object has is taken out of the wrench.
void slacken_damper(double dt, const ObjectState& state, Touch& touch);

/// Adds to a touch what a palm's second feel has found.
void add_palm(const PalmStiffness& palm, Touch& touch);

/// No finger pulls, none presses more than twice as hard as at the step's beginning, and none rubs harder
/// than friction holds by what presses now, but what slides is held as soon as it would turn round: springs
/// are made so for a step that ends with this speed: the object's own the first time, and then what the
/// springs have led to. True where some change. `orientation` is the object's.
bool soften(const Twist& speed, double dt, Quat orientation, std::span<Touch> touches);

/// As the object gives way in a step that ends with this speed, so do the forces.
void give_way(const Twist& speed, double dt, std::span<Touch> touches);

}  // namespace lumbrical
