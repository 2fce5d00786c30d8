// The paper's depth through the whole finger (its Figure 7): not only inside the primitive that is touched,
// but along -n through every phalanx the line runs through without leaving the finger.
#pragma once

#include "model/primitive.h"
#include "section/depth.h"

namespace lumbrical {

/// dl_max over the common part of `section` (of `primitive`) and its polygon, measured to the finger's outer
/// surface. At a bent finger the sup is taken at the points that are deepest in the primitive's own
/// phalanges.
Deepest finger_depth(const Primitives& hand, const Primitive& primitive, const Section& section);

/// What the same adds to the largest depth in the primitive itself, `depth` [m] at `from` [m, W] over a plane
/// with the unit normal `n`, of which `along` is not a multiple. False where the way out of the primitive is
/// not that out of its phalanges: then the largest depth may be elsewhere.
bool go_through_finger(const Primitives& hand, const Primitive& primitive, Vec3 from, Vec3 n, Vec3 along,
                       double& depth);

/// The same depth at one plane point of that section.
double finger_depth_at(const Primitives& hand, const Primitive& primitive, const Section& section, Point2 p);

}  // namespace lumbrical
