// The contact of a tile and a triangle where the tile's border with another tile of its finger is no plane
// (joint_border.h): exact to quadrature, and what one tile leaves the other takes.
#pragma once

#include "borders/joint_border.h"
#include "exact/exact_kernels.h"
#include "lumbrical/contact.h"
#include "model/primitive.h"
#include "section/section.h"

namespace lumbrical {

/// Sets everything of the contact but its indices and its depth. False where tile and triangle have no area
/// in common. `borders` are those on this triangle; where there are none, the contact with the tile cut by
/// its planes is the same.
bool collide_shared(const Primitives& hand, const Primitive& tile, const TileBorders& borders,
                    const ExactKernels& kernels, const Corners& at, Contact& contact);

}  // namespace lumbrical
