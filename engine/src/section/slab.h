// Contact of one of the palm's slabs with a triangle: polygons only, everything exact. The lanes do the same
// for many (slab_pairs.h).
#pragma once

#include "lumbrical/contact.h"
#include "model/swept_polygon.h"

namespace lumbrical {

/// Area, centroid, largest field and the law's volume of the triangle a, b, c [m] inside the slab. The field
/// is the depth below the skin; it stands for the depth of every law. False where they don't touch.
bool collide_slab(const Slab& slab, Law law, double point_area, Vec3 a, Vec3 b, Vec3 c, Contact& contact);

}  // namespace lumbrical
