// How a body moves, or what moves it, as one vector, and what relates the two.
#pragma once

#include <array>
#include <cstddef>

#include "lumbrical/math.h"

namespace lumbrical {

using Vector6 = std::array<double, 6>;  // three of translation, three of rotation

inline Vector6 vector_of(Vec3 a, Vec3 b) { return {a.x, a.y, a.z, b.x, b.y, b.z}; }
inline Vector6 vector_of(const Twist& twist) { return vector_of(twist.velocity, twist.angular_velocity); }
inline Vector6 vector_of(const Wrench& wrench) { return vector_of(wrench.force, wrench.torque); }

/// So far along x, y or z, or about it: of the k-th of three.
inline Vec3 along_axis(std::size_t k, double size) {
  return k == 0 ? Vec3{size, 0, 0} : k == 1 ? Vec3{0, size, 0} : Vec3{0, 0, size};
}

inline double dot6(const Vector6& a, const Vector6& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 6; ++i) sum += a[i] * b[i];
  return sum;
}

inline Vector6 times(const Matrix6& matrix, const Vector6& v) {
  Vector6 result;
  for (std::size_t i = 0; i < 6; ++i) result[i] = dot6(matrix[i], v);
  return result;
}

inline void add_scaled(double scale, const Vector6& v, Vector6& to) {
  for (std::size_t i = 0; i < 6; ++i) to[i] += scale * v[i];
}

/// to += scale row row^T
inline void add_square(double scale, const Vector6& row, Matrix6& to) {
  for (std::size_t i = 0; i < 6; ++i) add_scaled(scale * row[i], row, to[i]);
}

inline void add_matrix(const Matrix6& more, Matrix6& to) {
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column < 6; ++column) to[row][column] += more[row][column];
  }
}

}  // namespace lumbrical
