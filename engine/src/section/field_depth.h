// The palm's depth: the largest phi over what one of its edges has of a triangle.
#pragma once

#include "section/depth.h"

namespace lumbrical {

/// Of a capsule's section. phi is R less the distance from the axis, so it is largest at the point of the
/// polygon that is nearest to the axis, inside it or on an edge.
Deepest largest_field(const Section& section);

}  // namespace lumbrical
