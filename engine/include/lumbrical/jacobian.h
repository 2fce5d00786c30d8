// The stiffness of a touch: how the wrench of each hand segment changes when the segment moves. For stiffness
// limiters, device loops and solvers; computed on demand, never by a tick.
#pragma once

#include <array>

#include "lumbrical/tick.h"

namespace lumbrical {

/// The derivative of a segment's wrench with respect to the segment's pose.
///
/// Rows: force x y z [N], torque x y z [N m] about the joint at the segment's base, both in W, before limits.
/// Columns: translation x y z [m] and rotation x y z [rad] of the segment about that joint, both in W.
///
/// The world stands still. The segment moves as one rigid body, and with it the joint its torque is about and
/// the planes that border it on its neighbours. So the rigid move of a whole finger is predicted exactly,
/// segment by segment, and a finger that slides along a plane feels no change. Not in it is how a border
/// turns when two neighbours turn against each other: that hands force from one to the other and leaves their
/// sum as it is, as far as their fields are equal there.
///
/// Other fingers and the palm stand still too. What they hold together and feel once (Settings::felt_once) is
/// handed from one to another when one of them moves, which is right for it and its device, but not what a
/// rigid move of the whole hand does: where fingers pinch or lie in one place, that was off by up to 36 % of
/// the stiffness of all segments together (random poses in a mug), and by 1.2 % where none is felt once.
///
/// Over a closed surface and without borders the force is the gradient of a potential: translation block
/// symmetric, the others by the rules of rotations. Where the axis of a phalanx has passed a surface the
/// force falls with depth, and the stiffness has the opposite sign. A surface exactly in a border is
/// felt as a whole by one of the neighbours: there their wrenches step, and the Jacobian leaves the step out.
struct SegmentJacobian {
  Matrix6 value{};  ///< [row][column]: [N/m N/rad; N m/m N m/rad]; zero where nothing is touched
  /// False: the segment follows a law other than field, has a contact, deep in a folded finger, that is only
  /// known roughly (Contact::error), or more near it than there is room for; `value` is zero.
  bool known = false;
};

/// The Jacobians of the contacts that the last tick on `scratch` found; zero where it found none because its
/// frame could not be trusted. `model` must be the one that tick ran on. Takes some 30 us for each exact
/// contact, up to a millisecond for one that several borders cross; of sampled segments twelve times as long
/// as their samples, which it makes in the scratch's room, so that no other may use that meanwhile.
/// Deterministic like it; allocates nothing. Only segments whose bit is set in
/// `segments` are computed, the others are left alone: a loop that can't afford all of them takes turns.
void segment_jacobians(const Model& model, Scratch& scratch,
                       std::array<SegmentJacobian, kSegmentCount>& jacobians,
                       std::uint32_t segments = (1u << kSegmentCount) - 1);

}  // namespace lumbrical
