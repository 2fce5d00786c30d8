// The contact: what the narrowphase finds out about one triangle and one primitive.
#pragma once

#include <cstdint>

#include "lumbrical/math.h"

namespace lumbrical {

/// Marks a contact of a whole cluster of triangles (Settings::tolerance > 0 only).
inline constexpr std::uint32_t kClusterBit = 1u << 31;
/// Beside it: the finger's surface or a plane runs through the cluster, and its triangles were looked at.
inline constexpr std::uint32_t kSplitBit = 1u << 30;

/// One contacted triangle of one primitive, or a cluster of triangles that are one contact. No padding:
/// contacts are hashed as they stand.
///
/// Of a cluster `normal` and `volume` are direction and length of the integral of the law's depth times the
/// triangle's normal. `error` bounds how far that vector is off; its moment about a point o is off by at most
/// error (|centre - o| + 4 R), R the primitive's larger radius or half the palm's thickness. `depth` is that
/// of the cluster's centre or deepest corner, or 0; area and centroid are estimates where the finger's
/// surface runs through it.
struct Contact {
  std::uint32_t primitive = 0;  ///< index of the posed primitive
  std::uint32_t triangle =
      0;             ///< index into Model::triangles, or kClusterBit [+ kSplitBit] + one into clusters
  double depth = 0;  ///< [m] dl_max: the largest depth, through the whole finger; of the palm the largest phi
                     ///< (under `field` its edges have that along -normal). Of round primitives under the
                     ///< field law 0 until it is asked for (contact_depth)
  double area = 0;   ///< [m^2] A_C: the part of the triangle inside the primitive
  double volume = 0;  ///< [m^3] the law's depth summed over that part; K_s times it is the force
  double error = 0;   ///< [m^3] bound of |volume - exact|, exact laws; 0 for the others
  Vec3 centroid;      ///< [m] W, of that part
  Vec3 centre;        ///< [m] W, centre of pressure: the force acts here
  Vec3 normal;        ///< W, unit, outward from the triangle
};

/// The cluster that Contact::triangle stands for: an index into Model::clusters.
constexpr std::uint32_t cluster_of(std::uint32_t triangle) { return triangle & ~(kClusterBit | kSplitBit); }

}  // namespace lumbrical
