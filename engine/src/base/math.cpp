// The rotation given by three axes, as a quaternion (Shepperd's method: the largest component is computed
// first, so that no small number is divided by).
#include "lumbrical/math.h"

namespace lumbrical {

Quat quat_from_axes(Vec3 x, Vec3 y, Vec3 z) {
  // Four times the square of each component, from the diagonal.
  const double w4 = 1 + x.x + y.y + z.z;
  const double x4 = 1 + x.x - y.y - z.z;
  const double y4 = 1 - x.x + y.y - z.z;
  const double z4 = 1 - x.x - y.y + z.z;
  Quat q;  // not yet of unit length: every component carries the same factor
  if (w4 >= x4 && w4 >= y4 && w4 >= z4) {
    q = {w4, y.z - z.y, z.x - x.z, x.y - y.x};
  } else if (x4 >= y4 && x4 >= z4) {
    q = {y.z - z.y, x4, y.x + x.y, z.x + x.z};
  } else if (y4 >= z4) {
    q = {z.x - x.z, y.x + x.y, y4, z.y + y.z};
  } else {
    q = {x.y - y.x, z.x + x.z, z.y + y.z, z4};
  }
  return normalized(q);
}

}  // namespace lumbrical
