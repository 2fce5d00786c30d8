// Depths at a point of the plane: the field, and how far down it is to each of the surfaces a solid is made
// of.
#pragma once

#include <cmath>

#include "scene.h"

namespace lumbrical::reference {

// ---- Field
// ----------------------------------------------------------------------------------------------------------

/// Which of the spheres is the deepest at a point: one of the ends, or one between them.
enum class Nearest { end1, end2, between };

template <class T>
Nearest nearest_at(const Scene<T>& scene, const T& x, const T& y) {
  using std::sqrt;
  if (scene.ball) return Nearest::end1;
  if (scene.flat) return Nearest::between;
  // R(t) - |p - c(t)| is stationary where the line from p to c(t) meets the side at a right angle.
  const T e = scene.e0 + scene.c * x;
  const T t = scene.q0 + scene.s * x + scene.sigma / scene.kappa * sqrt(e * e + y * y);
  return t < 0 ? Nearest::end1 : t > scene.length ? Nearest::end2 : Nearest::between;
}

/// The field as if `nearest` were so everywhere. All of it small where the field is small: nothing cancels.
template <class T>
T field_through(const Scene<T>& scene, Nearest nearest, const T& x, const T& y) {
  using std::sqrt;
  if (nearest == Nearest::between) {
    const T e = scene.e0 + scene.c * x, rho = scene.kappa * sqrt(e * e + y * y);
    const T near = scene.near0 + scene.near1 * x, far = scene.far0 + scene.far1 * x, level = (near + far) / 2;
    if (!(level > 0)) return level - rho;
    return (near * far - scene.kappa * scene.kappa * y * y) / (level + rho);
  }
  const int i = nearest == Nearest::end1 ? 0 : 1;
  const T dx = x - scene.x[i];
  return (scene.gap[i] - dx * dx - y * y) / (scene.r[i] + sqrt(dx * dx + y * y + scene.h[i] * scene.h[i]));
}

template <class T>
T field_at(const Scene<T>& scene, const T& x, const T& y) {
  return field_through(scene, nearest_at(scene, x, y), x, y);
}

// ---- Depth
// ----------------------------------------------------------------------------------------------------------

/// Through which surface the way down leads out.
enum class Exit { end1, end2, side, base, none };

/// Infinite where the surface is never met. Nothing cancels where the depth is small, save beside a surface
/// that stands upright there: its root is all rounding then, and the bulge that belongs to the depth knows it
/// with the same error.
template <class T>
T depth_through(const Scene<T>& scene, Exit exit, const T& x, const T& y) {
  using std::sqrt;
  if (exit == Exit::base) return (scene.q0 + scene.s * x) / scene.c;
  if (exit == Exit::side) {
    // Down at depth d:  tilt_z d^2 + 2 b d = inside,  b^2 + tilt_z inside = (kappa f)^2.
    const T e = scene.e0 + scene.c * x, near = scene.near0 + scene.near1 * x,
            far = scene.far0 + scene.far1 * x;
    const T inside = near * far - scene.kappa * scene.kappa * y * y;
    const T b = scene.kappa * scene.kappa * scene.s * e + scene.sigma * scene.c * (near + far) / 2;
    const T arm = scene.sigma * x + scene.s * scene.r[0], square = arm * arm - scene.tilt_z * y * y;
    const T root = square > 0 ? T(scene.kappa * sqrt(square)) : T(0);
    if (b > 0 && (scene.sigma == 0 || 16 * square > arm * arm)) return inside / (b + root);
    return scene.tilt_z != 0 ? T((root - b) / scene.tilt_z) : std::numeric_limits<T>::infinity();
  }
  const int i = exit == Exit::end1 ? 0 : 1;
  const T dx = x - scene.x[i], square = (scene.r[i] - y) * (scene.r[i] + y) - dx * dx;
  const T root = square > 0 ? T(sqrt(square)) : T(0);
  if (scene.h[i] > 0 && 16 * square > scene.r[i] * scene.r[i]) {
    return (scene.gap[i] - dx * dx - y * y) / (root + scene.h[i]);
  }
  return root - scene.h[i];
}

/// Of a point of the section. A flat cylinder ends where its side or its base does, whichever comes first;
/// the hull of two spheres where the last of the parts does that it is made of.
template <class T>
Exit exit_at(const Scene<T>& scene, const T& x, const T& y) {
  if (scene.ball) return Exit::end1;
  if (scene.flat) {
    if (scene.c == 0) return Exit::side;
    if (scene.s == 0) return Exit::base;
    return depth_through(scene, Exit::side, x, y) < depth_through(scene, Exit::base, x, y) ? Exit::side
                                                                                           : Exit::base;
  }
  Exit best = Exit::none;
  T deepest{};
  const auto consider = [&](Exit exit, const T& depth) {
    if (best == Exit::none || depth > deepest) best = exit, deepest = depth;
  };
  for (const int i : {0, 1}) {
    const T dx = x - scene.x[i];
    const Exit exit = i == 0 ? Exit::end1 : Exit::end2;
    if (scene.r[i] * scene.r[i] - dx * dx - y * y >= 0) consider(exit, depth_through(scene, exit, x, y));
  }
  if (scene.s > 0 || scene.sigma != 0) {
    const T depth = depth_through(scene, Exit::side, x, y), q = scene.q0 + scene.s * x - scene.c * depth;
    if (q >= scene.touch[0] && q <= scene.touch[1]) consider(Exit::side, depth);
  }
  return best;
}

template <class T>
T depth_at(const Scene<T>& scene, const T& x, const T& y) {
  const Exit exit = exit_at(scene, x, y);
  return exit == Exit::none ? T(-1) : depth_through(scene, exit, x, y);
}

/// Where the circle in which the side meets end i lies above a line of constant y, seen along z: at middle +-
/// half. False where it doesn't.
template <class T>
bool rim_above(const Scene<T>& scene, int i, const T& y, T& middle, T& half) {
  using std::sqrt;
  const T radius = scene.flat ? scene.r[i] : T(scene.kappa * scene.r[i]);
  const T square = (radius - y) * (radius + y);
  if (!(square > 0)) return false;
  middle = scene.s * scene.touch[i], half = scene.c * sqrt(square);
  return true;
}

}  // namespace lumbrical::reference
