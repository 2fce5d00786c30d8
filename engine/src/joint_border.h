// Where the tiles of one finger share out space other than along the bisecting planes of its joints.
//
// By the law the field of a finger is the largest of its phalanges' fields, so two tiles border where their
// fields are equal. Seen from the joint C they have in common, the field of phalanx i at distance D in a
// direction theta_i off its axis is r - D sin(theta_i + sigma_i), sigma_i the slope of its cone (positive
// where it narrows away from the joint). So the fields are equal on theta_i + sigma_i = theta_j + sigma_j: a
// quadric cone with its apex at the joint, the bisecting plane where the slopes agree, until the far end of
// one of the two comes into reach.
#pragma once

#include "primitive.h"

namespace lumbrical {

/// Fills hand.border and hand.folded from hand.capsule and hand.present. Only phalanges that both follow the
/// field law share out space exactly.
void set_joint_borders(Primitives& hand);

/// Can the border of `tile` differ from its cutting planes anywhere on the triangle a, b, c [m, W]? Cheap,
/// and false only where the contact with the tile cut by its planes is exact.
bool border_matters(const Primitives& hand, const Primitive& tile, Vec3 a, Vec3 b, Vec3 c);

/// The same question for one joint.
bool joint_matters(const JointBorder& border, Vec3 a, Vec3 b, Vec3 c);

}  // namespace lumbrical
