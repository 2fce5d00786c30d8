// How a body moves, or what moves it, as one vector.
#pragma once

#include <array>
#include <cstddef>

namespace lumbrical {

using Vector6 = std::array<double, 6>;  // three of translation, three of rotation

inline double dot6(const Vector6& a, const Vector6& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 6; ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace lumbrical
