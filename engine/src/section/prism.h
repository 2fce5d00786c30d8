// Contact of the palm, a convex polyhedron, with a triangle: polygons only, everything exact.
#pragma once

#include "lumbrical/contact.h"
#include "model/primitive.h"

namespace lumbrical {

/// Area, centroid, depth and the law's volume of the triangle a, b, c [m] inside the prism. The field is the
/// depth below the palmar face; the column runs along -n to whichever face comes first. False where they
/// don't touch.
bool collide_prism(const Prism& prism, Law law, double point_area, Vec3 a, Vec3 b, Vec3 c, Contact& contact);

}  // namespace lumbrical
