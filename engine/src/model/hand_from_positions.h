// Builds whole hands from joint positions alone: missing palm, wrist and metacarpals, orientations, palm
// polygon.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/hand.h"

namespace lumbrical {

/// What a tracker that delivers points knows about one hand in one frame, in any one frame of reference.
struct HandPoints {
  Side side = Side::right;
  std::array<Vec3, kJointCount> position{};  ///< [m] finite where known
  std::uint32_t known = 0;                   ///< bit j: position[j] is given
  Vec3 forward{};  ///< along the palm to the fingers, if the tracker says; else zero
  Vec3 dorsal{};   ///< out of the back of the hand, if the tracker says; else zero
};

/// The poses of all 26 joints. Needs the proximal joints of the four fingers and all joints beyond, and the
/// whole thumb; wrist, palm and metacarpals are derived where not known. Always finite, with unit
/// quaternions, even where points coincide.
std::array<Pose, kJointCount> hand_from_positions(const HandPoints& points);

/// The pose with -z along `forward` and +y as near to `dorsal` as that allows; any such pose where the two
/// are parallel or zero.
Pose pose_along(Vec3 position, Vec3 forward, Vec3 dorsal);

/// Midway between the middle finger's metacarpal and proximal joints, with the orientation of the former.
Pose palm_between(const Pose& middle_metacarpal, const Pose& middle_proximal);

/// The core of a palm `thickness` [m] thick (Palm::polygon): the convex outline of the four fingers'
/// metacarpals, as broad as their knuckles, moved inwards by half the thickness, so that the skin is where
/// the outline was; by less where nothing would be left of it. Empty where the joints span no area. `radius`
/// [m] per joint.
std::vector<Vec3> fit_palm_polygon(const std::array<Pose, kJointCount>& X_BJ,
                                   std::span<const double, kJointCount> radius, double thickness);

}  // namespace lumbrical
