// The curve along which two tiles border inside a convex part of a triangle, and what lies between it and its
// chord. Polygon, section and its kin's section are convex, so it lies in all three: nothing else cuts it.
#pragma once

#include "borders/tile_kin.h"
#include "exact/exact_kernels.h"
#include "section/pressure.h"

namespace lumbrical {

/// From one end of a border to the other; `across` points into its kin's part.
struct Chord {
  Point2 from{0, 0}, along{1, 0}, across{0, 1};
  double length = 0;  ///< [m]
  [[nodiscard]] Point2 at(double s, double y) const { return from + s * along + y * across; }
};
Chord chord_between(Point2 from, Point2 to);

/// Between chord and border: positive where the tile gains beyond its chord.
struct Bulge {
  double area = 0, volume = 0;           ///< [m^2], [m^3] of the tile's field
  Point2 area_first{0, 0}, first{0, 0};  ///< their first moments in plane coordinates
  double error = 0;                      ///< [m^3] what the volume may be off by
  void operator+=(const Bulge& more) {
    area += more.area;
    volume += more.volume;
    area_first = area_first + more.area_first;
    first = first + more.first;
    error += more.error;
  }
};

/// What a border does inside a convex part of the triangle from whose edge to whose edge it runs.
enum class Course : std::uint8_t {
  inside,   ///< `chord` spans the part of it that lies in the section
  outside,  ///< it misses the section: all of the section there belongs to one of the two
  unclear,  ///< not one flat curve: look at smaller parts
};

/// Shortens the chord to the part of the border inside the section.
Course follow_border(const Section& section, const Kin& kin, Chord& chord);

/// Integrals over what lies between such a chord and its border. False where the border is no curve over it.
bool integrate_bulge(const ExactKernels& kernels, const Section& section, const Kin& kin, const Chord& chord,
                     Bulge& bulge);

/// What a bulge adds to the integrals of d phi / dn that a contact's Jacobian is made of: the integral over
/// the bulge, less that of phi (m n) / |m x n| along the border, m its normal out of the tile. `border` is
/// its kin's, a near one.
bool integrate_bulge_slope(const Section& section, const Kin& kin, const JointBorder& border,
                           const Chord& chord, SlopeMoments& slope);

}  // namespace lumbrical
