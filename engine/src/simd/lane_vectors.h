// Vectors on their way into structures of arrays and out of them.
#pragma once

#include <cstddef>

#include "lumbrical/math.h"

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
template <class T>
void fill_up(T* row, std::size_t count) {
  constexpr std::size_t kWidest = 64 / sizeof(T);
  for (std::size_t k = count; k % kWidest != 0; ++k) row[k] = row[0];
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

}  // namespace lumbrical
