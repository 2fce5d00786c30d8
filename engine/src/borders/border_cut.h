// One triangle at a time: where a curved border between two tiles runs through it once, it is cut along the
// border's chord, and what lies between chord and border is added afterwards.
#pragma once

#include <array>

#include "borders/border_cross.h"
#include "exact/exact_kernels.h"
#include "lumbrical/contact.h"
#include "section/pressure.h"

namespace lumbrical {

/// What a contact whose cuts are chords gains beyond them, in W.
struct BulgeMoments {
  Vec3 base;                    ///< [m] a point near the contact
  double area = 0, volume = 0;  ///< [m^2], [m^3] of the tile's field
  Vec3 area_first, first;       ///< [m^3], [m^4] first moments about the base
  double error = 0;             ///< [m^3] what the volume may be off by
};

/// How the borders of a tile cut one triangle.
struct BorderCut {
  CutKind kind = CutKind::planes;
  std::array<HalfSpace, 2> cut{};  ///< in the place of the tile's; a normal of 0 cuts nothing
  bool crosses = false;            ///< one of them is a chord inside the section
  bool outer = false;              ///< the chord is of the border away from the wrist
  Vec3 from, to;                   ///< [m] W, its ends from the joint
  double height = 0;               ///< [m] no farther than this from it the border is
  BulgeMoments bulge;              ///< what the tile gains beyond its chord
};

/// How `tile` [suits_lanes, under the field law] and its neighbours share out the triangle `at` [m, W],
/// `near` the borders in its reach. Two borders that cross it are `general` here, and so is one whose bulge
/// can't be integrated.
BorderCut cut_at_borders(const ExactKernels& kernels, const Primitives& hand, const Primitive& tile,
                         const TileBorders& near, const Corners& at);

/// Does what lies no farther than `height` from the chord keep to the side of `space` that is kept? Its ends
/// are relative to the joint; a normal of 0 keeps everything.
bool keeps_to(const HalfSpace& space, Vec3 joint, Vec3 from, Vec3 to, double height);

/// The tile with the cuts of one triangle.
Primitive tile_cut_so(const Primitive& tile, const std::array<HalfSpace, 2>& cut);

/// Adds a bulge to the contact of the tile cut so.
void add_bulge(const BulgeMoments& bulge, Contact& contact);

/// The bulge's part in the contact's Jacobian, in the plane coordinates of its section
/// (`integrate_bulge_slope`); zero where no border crosses. False where it can't be integrated.
bool bulge_slope(const Primitives& hand, const Primitive& tile, const BorderCut& cut, const Corners& at,
                 SlopeMoments& slope);

}  // namespace lumbrical
