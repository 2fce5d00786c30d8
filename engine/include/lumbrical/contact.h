// The contact: what the narrowphase finds out about one triangle and one primitive.
#pragma once

#include <cstdint>

#include "lumbrical/math.h"

namespace lumbrical {

/// One contacted triangle of one primitive. No padding: contacts are hashed as they stand.
struct Contact {
  std::uint32_t primitive = 0;  ///< index of the posed primitive
  std::uint32_t triangle = 0;   ///< index into Model::triangles
  double depth = 0;  ///< [m] dl_max: the largest depth, through the whole finger; of the palm the largest phi
                     ///< (under `field` its edges have that along -normal). Of round primitives under the
                     ///< field law 0 until it is asked for (find_contacts)
  double area = 0;   ///< [m^2] A_C: the part of the triangle inside the primitive
  double volume = 0;  ///< [m^3] the law's depth summed over that part, but for what bodies of the hand that
                      ///< are deeper feel in its place (Settings::felt_once); K_s times it is the force
  double error = 0;   ///< [m^3] bound of |volume - exact|, exact laws; 0 for the others
  Vec3 centroid;      ///< [m] W, of that part
  Vec3 centre;        ///< [m] W, centre of pressure: the force acts here
  Vec3 normal;        ///< W, unit, outward from the triangle
};

}  // namespace lumbrical
