// The paper's depth: how far a point of a triangle must go along -n to leave the finger, and its largest
// value dl_max over the contacted area.
#pragma once

#include "section/section.h"

namespace lumbrical {

/// Depth [m] of the plane point p, which must lie inside the section: along -n to the primitive's own
/// surface.
double depth_at(const Section& section, Point2 p);

struct Deepest {
  double depth = 0;    ///< [m] dl_max
  Point2 point{0, 0};  ///< where
};

/// The largest depth over the common part of polygon and section, which must not be empty. Depth is a concave
/// function of the point (the primitives are convex), so it is largest at the section's own deepest point or,
/// if the polygon doesn't hold that, on an edge of the polygon.
Deepest largest_depth(const Section& section);

}  // namespace lumbrical
