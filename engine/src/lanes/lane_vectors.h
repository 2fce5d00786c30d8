// Vectors on their way into structures of arrays and out of them.
#pragma once

#include <cstddef>

#include "model/primitive.h"

namespace lumbrical {

/// Of lane k.
template <class T, std::size_t N>
void put_vector(Vec3 v, std::size_t k, T (&to)[3][N]) {
  to[0][k] = v.x;
  to[1][k] = v.y;
  to[2][k] = v.z;
}
template <class T, std::size_t N>
Vec3 vector_at(const T (&from)[3][N], std::size_t k) {
  return {from[0][k], from[1][k], from[2][k]};
}

/// Kernels compute whole registers: fills the last one of a row up with copies of its first number.
inline constexpr std::size_t kWholeRegisters = 16;
template <class T>
void fill_up(T* row, std::size_t count) {
  for (std::size_t k = count; k % kWholeRegisters != 0; ++k) row[k] = row[0];
}
template <class T, std::size_t N>
void fill_up_vector(T (&rows)[3][N], std::size_t count) {
  for (T(&row)[N] : rows) fill_up(&row[0], count);
}

/// The same in all lanes.
inline void put_vector(Vec3 v, double (&to)[3]) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}
template <class T>
Vec3 vector_of(const T (&from)[3]) {
  return {from[0], from[1], from[2]};
}

/// A half-space as normal and height over `origin`.
inline void put_plane(const HalfSpace& space, Vec3 origin, double (&to)[4]) {
  to[0] = space.normal.x;
  to[1] = space.normal.y;
  to[2] = space.normal.z;
  to[3] = dot(space.normal, space.point - origin);
}
inline double height_over(const double (&plane)[4], Vec3 p) {
  return dot(Vec3{plane[0], plane[1], plane[2]}, p) - plane[3];
}

}  // namespace lumbrical
