// Sums of wrenches, and the same ones seen from elsewhere.
#pragma once

#include "lumbrical/math.h"

namespace lumbrical {

constexpr Wrench operator+(const Wrench& a, const Wrench& b) {
  return {a.force + b.force, a.torque + b.torque};
}
constexpr Wrench operator-(const Wrench& a, const Wrench& b) {
  return {a.force - b.force, a.torque - b.torque};
}
constexpr Wrench operator-(const Wrench& a) { return {-a.force, -a.torque}; }
constexpr Wrench operator*(double s, const Wrench& a) { return {s * a.force, s * a.torque}; }
constexpr Wrench& operator+=(Wrench& a, const Wrench& b) { return a = a + b; }

constexpr Wrench rotated(Quat q, const Wrench& a) { return {rotate(q, a.force), rotate(q, a.torque)}; }

/// The same about a point that lies `arm` before it.
constexpr Wrench about(Vec3 arm, const Wrench& a) { return {a.force, a.torque + cross(arm, a.force)}; }

}  // namespace lumbrical
