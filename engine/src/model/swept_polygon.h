// The palm: everything within a radius r of a convex polygon, its core. Its field phi = r - distance to the
// core is that of the fingers, zero on the whole skin. By what of the core is nearest, the palm falls into
// parts: where that is a point inside the core, two slabs, in which phi is linear, palmar and dorsal; where
// it is a point of an edge, a capsule along the edge, cut by the plane that stands on the edge and by those
// that halve the corners at its ends. Beyond a corner two edges are equally near, so the parts share space
// exactly.
#pragma once

#include "lumbrical/hand.h"
#include "model/primitive.h"

namespace lumbrical {

/// The core of `palm` [check_hand], whose joint is at X_WP; empty where it has no polygon.
SweptPolygon place_palm(const Palm& palm, const Pose& X_WP);

/// Adds the palm's parts to the hand: the palmar slab, the dorsal one, then the edges.
void add_palm_parts(const SweptPolygon& palm, Law law, Primitives& hand);

/// A convex polyhedron between the core and the skin on one side of it.
struct Slab {
  static constexpr std::size_t kMostFaces = SweptPolygon::kMostCorners + 2;
  std::uint32_t face_count = 0;
  std::array<HalfSpace, kMostFaces> face{};  ///< outward normals; [0] is the skin, [1] the core's plane
  double thickness = 0;                      ///< [m] the palm's radius
};

/// The faces of a slab among the palm's primitives.
Slab slab_of(const SweptPolygon& palm, const Primitive& slab);

}  // namespace lumbrical
