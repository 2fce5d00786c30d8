// Where a curved border between two tiles runs through a triangle once, the lanes cut the triangle along the
// border's chord, and what lies between chord and border is added afterwards.
#pragma once

#include <array>

#include "borders/joint_border.h"
#include "lumbrical/contact.h"
#include "model/primitive.h"
#include "section/pressure.h"

namespace lumbrical {

/// How the borders of a tile cut one triangle.
struct BorderCut {
  enum Kind : std::uint8_t {
    planes,   ///< as the tile's own cuts do
    other,    ///< as `cut` does
    gone,     ///< all of the triangle is another tile's
    general,  ///< a matter for `borders_on` and `collide_shared`
  } kind = planes;
  std::array<HalfSpace, 2> cut{};  ///< in the place of the tile's; a normal of 0 cuts nothing
  bool crosses = false;            ///< one of them is a chord inside the section
  bool curved = false;             ///< it has a bulge
  bool outer = false;              ///< the chord is of the border away from the wrist
  Vec3 from, to;                   ///< [m] W, its ends from the joint
  double bulge = 0;                ///< [m^3] no more than this the volume of the bulge is
};

/// How `tile` [suits_batch] and its neighbours share out the triangle a, b, c [m, W], `near` the borders in
/// its reach.
BorderCut cut_at_borders(const Primitives& hand, const Primitive& tile, const TileBorders& near, Vec3 a,
                         Vec3 b, Vec3 c);

/// The tile with the cuts of one triangle.
Primitive tile_cut_so(const Primitive& tile, const BorderCut& cut);

/// Adds the bulge to the contact of the tile cut so with a triangle of which `a` and `b` are corners.
/// `tolerance` is Settings::tolerance: where the bulge is within it, it is only added to the contact's error.
void add_bulge(const FieldKernels& kernels, const Primitives& hand, const Primitive& tile,
               const BorderCut& cut, double tolerance, Vec3 a, Vec3 b, Contact& contact);

/// The bulge's part in the contact's Jacobian, in the plane coordinates of its section
/// (`integrate_bulge_slope`).
SlopeMoments bulge_slope(const Primitives& hand, const Primitive& tile, const BorderCut& cut, Vec3 a, Vec3 b,
                         Vec3 c);

}  // namespace lumbrical
