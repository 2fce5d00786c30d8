// The field law of a whole finger from its definition, by brute quadrature: phi is the largest of all spheres
// of all phalanges. Shares no formula with the engine, which is held against it.
#pragma once

#include <array>
#include <vector>

#include "lumbrical/math.h"

namespace lumbrical::test {

/// One phalanx: the hull of its end spheres.
struct ReferenceCapsule {
  Vec3 end1, end2;                  ///< [m]
  double radius1 = 0, radius2 = 0;  ///< [m]
};

struct FingerReference {
  double area = 0;         ///< [m^2] of the triangle inside the finger
  double volume = 0;       ///< [m^3] integral of phi over it
  Vec3 area_first, first;  ///< [m^3], [m^4] first moments of both, about the triangle's first corner
};

/// [m] the largest R(t) - |p - c(t)| over all spheres of all capsules.
double finger_field(const std::vector<ReferenceCapsule>& finger, Vec3 p);

/// A tenth of a second or so; good to about 1e-12 of the largest radius cubed.
FingerReference finger_reference(const std::vector<ReferenceCapsule>& finger, Vec3 a, Vec3 b, Vec3 c);

}  // namespace lumbrical::test
