// What tests of the Jacobian do with matrices that relate changes of pose and wrench.
#pragma once

#include <array>
#include <cmath>

#include "lumbrical/math.h"

namespace lumbrical::test {

inline constexpr Vec3 kAxes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// The matrix whose columns are wrenches.
inline Matrix6 blocks(const std::array<Vec3, 6>& force_columns, const std::array<Vec3, 6>& torque_columns) {
  Matrix6 m{};
  for (std::size_t k = 0; k < 6; ++k) {
    const Vec3 f = force_columns[k], t = torque_columns[k];
    m[0][k] = f.x, m[1][k] = f.y, m[2][k] = f.z, m[3][k] = t.x, m[4][k] = t.y, m[5][k] = t.z;
  }
  return m;
}

/// The change of a wrench under a translation and a rotation.
inline Wrench times(const Matrix6& m, Vec3 translation, Vec3 rotation) {
  const double x[6] = {translation.x, translation.y, translation.z, rotation.x, rotation.y, rotation.z};
  double y[6] = {};
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < 6; ++k) y[i] += m[i][k] * x[k];
  }
  return {{y[0], y[1], y[2]}, {y[3], y[4], y[5]}};
}

/// The move by a translation and a small rotation vector about a pivot.
inline Pose turn_about(Vec3 pivot, Vec3 translation, Vec3 rotation) {
  const Quat q = normalized({1, 0.5 * rotation.x, 0.5 * rotation.y, 0.5 * rotation.z});
  return {pivot + translation - rotate(q, pivot), q};
}

/// The largest difference of two Jacobians, as a share of the larger's largest entry; rotations and torques
/// are measured at the distance `radius`.
inline double difference(const Matrix6& a, const Matrix6& b, double radius) {
  double largest = 0, worst = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < 6; ++k) {
      const double scale = (i < 3 ? 1 : 1 / radius) * (k < 3 ? 1 : 1 / radius);
      largest = std::fmax(largest, scale * std::fmax(std::fabs(a[i][k]), std::fabs(b[i][k])));
      worst = std::fmax(worst, scale * std::fabs(a[i][k] - b[i][k]));
      if (!is_finite(a[i][k]) || !is_finite(b[i][k])) return 1e300;
    }
  }
  return largest > 0 ? worst / largest : 0;
}

}  // namespace lumbrical::test
