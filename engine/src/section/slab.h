// Contact of one of the palm's slabs with a triangle: polygons only, everything exact. The lanes do the same
// for many (slab_pairs.h).
#pragma once

#include "lumbrical/contact.h"
#include "model/corners.h"
#include "model/swept_polygon.h"

namespace lumbrical {

/// Area, centroid, largest field and the law's volume of the triangle `at` [m] inside the slab. The field
/// is the depth below the skin; it stands for the depth of every law. False where they don't touch.
bool collide_slab(const Slab& slab, Law law, double point_area, const Corners& at, Contact& contact);

/// [m^3] The bound of the error of the volume over a part of the triangle, which has that area [m^2].
double slab_error(const Slab& slab, const Corners& at, double area);

}  // namespace lumbrical
