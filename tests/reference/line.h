// What happens along one line of constant y across triangle and solid: the part of it inside both, and the
// integrals of area, field and depth over that part in closed form.
//
// The line and the primitive's axis lie in planes along z that are parallel to each other, so the solid is
// symmetric about them and everything along the line is elementary: its ends are roots of quadratics, and
// field and depth are linear functions plus or minus the root of a quadratic, piece by piece.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "arc_integral.h"
#include "surface.h"

namespace lumbrical::reference {

template <class T>
struct Interval {
  T low = -std::numeric_limits<T>::infinity(), high = std::numeric_limits<T>::infinity();
  [[nodiscard]] bool empty() const { return !(low < high); }
};
template <class T>
Interval<T> nothing() {
  return {std::numeric_limits<T>::infinity(), -std::numeric_limits<T>::infinity()};
}
template <class T>
Interval<T> common(const Interval<T>& a, const Interval<T>& b) {
  return {a.low > b.low ? a.low : b.low, a.high < b.high ? a.high : b.high};
}
/// The smallest interval that holds both.
template <class T>
Interval<T> joined(const Interval<T>& a, const Interval<T>& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {a.low < b.low ? a.low : b.low, a.high > b.high ? a.high : b.high};
}

template <class T>
Interval<T> in_triangle(const Scene<T>& scene, const T& y) {
  Interval<T> inside;
  for (const Edge<T>& edge : scene.edges) {
    const T left = edge.d - edge.ny * y;
    if (edge.nx == 0) {
      if (left < 0) return nothing<T>();
      continue;
    }
    const T x = left / edge.nx;
    if (edge.nx > 0) {
      if (x < inside.high) inside.high = x;
    } else if (x > inside.low) {
      inside.low = x;
    }
  }
  return scene.edges.empty() ? nothing<T>() : inside;
}

template <class T>
Interval<T> in_ball(const Scene<T>& scene, int i, const T& y) {
  using std::sqrt;
  const T square = scene.gap[i] - y * y;
  if (!(square > 0)) return nothing<T>();
  const T half = sqrt(square);
  return {scene.x[i] - half, scene.x[i] + half};
}

/// Between the side's two circles.
template <class T>
Interval<T> in_slab(const Scene<T>& scene) {
  if (scene.s == 0) return scene.touch_holds ? Interval<T>{} : nothing<T>();
  return {scene.touch_x[0], scene.touch_x[1]};
}

/// Within the double cone of the side, where tilt_x x^2 - 2 b x + c <= 0. Of a steep one, of which a line is
/// in both halves, the half that counts: the slab leaves no doubt.
template <class T>
Interval<T> in_side(const Scene<T>& scene, const T& y) {
  using std::sqrt;
  const T& a = scene.tilt_x;
  const T b = scene.s * (scene.sigma * scene.r[0] - scene.c * scene.h[0]);
  const T c = scene.kappa * scene.kappa * y * y - scene.near0 * scene.far0;
  const T arm = scene.c * scene.r[0] - scene.sigma * scene.h[0], square = arm * arm - a * y * y;
  if (a > 0 && !(square > 0)) return nothing<T>();
  const T root = square > 0 ? T(scene.kappa * sqrt(square)) : T(0);
  const T large = b < 0 ? T(b - root) : T(b + root);  // of the two numerators over a
  if (a == 0) {
    if (large == 0) return c <= 0 ? Interval<T>{} : nothing<T>();
    const T only = c / large;
    return b > 0 ? Interval<T>{only} : Interval<T>{-std::numeric_limits<T>::infinity(), only};
  }
  // With a small the other root is c / large; with a large that would divide rounding by little.
  const bool slim = a < T(1) / 128 && a > -T(1) / 128;
  const T one = large / a,
          other = slim && large != 0 ? T(c / large) : T((b < 0 ? T(b + root) : T(b - root)) / a);
  const T low = one < other ? one : other, high = one < other ? other : one;
  if (a > 0) return {low, high};
  if (scene.sigma > 0) return {high};
  return {-std::numeric_limits<T>::infinity(), low};
}

template <class T>
Interval<T> in_solid(const Scene<T>& scene, const T& y) {
  if (scene.ball) return in_ball(scene, 0, y);
  const Interval<T> between = common(in_side(scene, y), in_slab(scene));
  if (scene.flat) return between;
  return joined(joined(in_ball(scene, 0, y), in_ball(scene, 1, y)), between);
}

template <class T>
Interval<T> in_both(const Scene<T>& scene, const T& y) {
  const Interval<T> triangle = in_triangle(scene, y);
  return triangle.empty() ? triangle : common(triangle, in_solid(scene, y));
}

// ---- Pieces
// ---------------------------------------------------------------------------------------------------------

/// The ends of the pieces a line falls into, in order.
template <class T>
class Cuts {
 public:
  explicit Cuts(const Interval<T>& inside) : inside_(inside) { at_[0] = inside.low, at_[1] = inside.high; }
  void add(const T& x) {
    if (!(x > inside_.low && x < inside_.high)) return;
    int k = count_++;
    for (; at_[k - 1] > x; --k) at_[k] = at_[k - 1];
    at_[k] = x;
  }
  void finish() { at_[count_] = inside_.high; }
  [[nodiscard]] int pieces() const { return count_; }
  const T& operator[](int i) const { return at_[i]; }

 private:
  Interval<T> inside_;
  std::array<T, 16> at_;
  int count_ = 1;
};

/// Integral of a density and of x times it.
template <class T>
struct Along {
  T amount{}, moment{};
};

/// Adds the integral over x1 < x < x2 of a function with these values at the ends that bulges over its chord.
template <class T>
void add_piece(const T& x1, const T& x2, const T& at1, const T& at2, const Bulge<T>& bulge, Along<T>& sum) {
  const T w = x2 - x1, amount = w * (at1 + at2) / 2 + bulge.area;
  sum.amount += amount;
  sum.moment += (x1 + x2) / 2 * amount + w * w * (at2 - at1) / 12 + bulge.moment;
}

// ---- Field
// ----------------------------------------------------------------------------------------------------------

/// Where the deepest sphere becomes that of an end, and next to the axis and the ends' centres.
template <class T>
void cut_for_field(const Scene<T>& scene, const T& y, Cuts<T>& cuts) {
  using std::sqrt;
  cuts.add(T(0));
  if (scene.ball) return;
  if (scene.c > 0) cuts.add(-scene.e0 / scene.c);
  if (scene.flat) return;
  cuts.add(scene.x[1]);
  for (const int i : {0, 1}) {
    const T end = i * scene.length, along = end - scene.q0;
    if (scene.sigma == 0) {
      if (scene.s > 0) cuts.add(along / scene.s);
      continue;
    }
    // kappa^2 (end - q)^2 = sigma^2 (e^2 + y^2):  tilt_z x^2 - 2 b x + c = 0.
    const T kk = scene.kappa * scene.kappa, ss = scene.sigma * scene.sigma;
    const T b = scene.s * (kk * end - scene.q0), c = kk * along * along - ss * (scene.e0 * scene.e0 + y * y);
    const T square = kk * scene.h[i] * scene.h[i] + scene.tilt_z * y * y;
    if (!(square >= 0)) continue;
    const T root = sqrt(ss * square), large = b < 0 ? T(b - root) : T(b + root);
    if (scene.tilt_z != 0) cuts.add(large / scene.tilt_z);
    if (large != 0) cuts.add(c / large);
  }
}

template <class T>
Along<T> field_along(const Scene<T>& scene, const T& y, const Interval<T>& inside) {
  Cuts<T> cuts(inside);
  cut_for_field(scene, y, cuts);
  cuts.finish();
  Along<T> sum;
  for (int k = 0; k < cuts.pieces(); ++k) {
    const T &x1 = cuts[k], &x2 = cuts[k + 1];
    if (!(x1 < x2)) continue;
    const Nearest nearest = nearest_at(scene, T((x1 + x2) / 2), y);
    // Linear less slope times the root of l^2 + d.
    T l1, l2, d, slope;
    if (nearest == Nearest::between) {
      l1 = scene.e0 + scene.c * x1, l2 = scene.e0 + scene.c * x2, d = y * y, slope = scene.kappa;
    } else {
      const int i = nearest == Nearest::end1 ? 0 : 1;
      l1 = x1 - scene.x[i], l2 = x2 - scene.x[i], d = y * y + scene.h[i] * scene.h[i], slope = 1;
    }
    Bulge<T> bulge = hyperbola_bulge_over_d(l1, l2, d, T(x2 - x1));
    bulge.area *= -slope * d, bulge.moment *= -slope * d;
    add_piece(x1, x2, field_through(scene, nearest, x1, y), field_through(scene, nearest, x2, y), bulge, sum);
  }
  return sum;
}

// ---- Column
// ---------------------------------------------------------------------------------------------------------

/// Where the way down leads out through another surface, and where the formula of a bulge wants it.
template <class T>
void cut_for_column(const Scene<T>& scene, const T& y, Cuts<T>& cuts) {
  cuts.add(T(0));
  if (scene.ball) return;
  cuts.add(scene.x[1]);
  for (const int i : {0, 1}) {
    T middle, half;
    if (!rim_above(scene, i, y, middle, half)) continue;
    cuts.add(middle - half);
    cuts.add(middle + half);
  }
  if (scene.sigma != 0) cuts.add(-scene.s * scene.r[0] / scene.sigma);
}

template <class T>
Along<T> column_along(const Scene<T>& scene, const T& y, const Interval<T>& inside) {
  Cuts<T> cuts(inside);
  cut_for_column(scene, y, cuts);
  cuts.finish();
  Along<T> sum;
  for (int k = 0; k < cuts.pieces(); ++k) {
    const T &x1 = cuts[k], &x2 = cuts[k + 1];
    if (!(x1 < x2)) continue;
    const Exit exit = exit_at(scene, T((x1 + x2) / 2), y);
    if (exit == Exit::none) continue;
    Bulge<T> bulge;
    if (exit == Exit::side && scene.sigma != 0) {
      bulge = hyperbola_bulge_over_d(T(scene.sigma * x1 + scene.s * scene.r[0]),
                                     T(scene.sigma * x2 + scene.s * scene.r[0]), T(-scene.tilt_z * y * y),
                                     T(x2 - x1));
      // kappa f / tilt_z, and d = -tilt_z y^2.
      bulge.area *= -scene.kappa * y * y, bulge.moment *= -scene.kappa * y * y;
    } else if (exit == Exit::end1 || exit == Exit::end2) {
      const int i = exit == Exit::end1 ? 0 : 1;
      bulge = circle_bulge(T(x1 - scene.x[i]), T(x2 - scene.x[i]), T((scene.r[i] - y) * (scene.r[i] + y)));
    }
    add_piece(x1, x2, depth_through(scene, exit, x1, y), depth_through(scene, exit, x2, y), bulge, sum);
  }
  return sum;
}

/// The largest depth on the line, which is a concave function of x: where it ends, where the surface changes,
/// or where a surface is level. Beside a surface that stands nearly upright a depth may be all rounding; it
/// is never more than the line's own, without a triangle, which is known well.
template <class T>
T deepest_along(const Scene<T>& scene, const T& y, const Interval<T>& inside) {
  using std::sqrt;
  const auto within = [&](const T& x) {
    return x < inside.low ? inside.low : x > inside.high ? inside.high : x;
  };
  T middle, half;
  if (scene.flat) {
    // Down to the base ever deeper up to the rim, from there to the side ever less.
    if (scene.c == 0 || !rim_above(scene, 0, y, middle, half)) return depth_at(scene, within(scene.x[0]), y);
    const T rim = middle + half, top = scene.s * half / scene.c - scene.h[0];
    const T slack = 8 * std::numeric_limits<T>::epsilon() * scene.size;
    T depth = top;
    if (rim < inside.low - slack) depth = depth_through(scene, Exit::side, inside.low, y);
    if (rim > inside.high + slack) depth = depth_through(scene, Exit::base, inside.high, y);
    return depth < top ? depth : top;
  }
  T best = depth_at(scene, inside.low, y), top = best;
  bool any = false;
  const auto consider = [&](const T& x) {
    const T here = depth_at(scene, x, y), there = within(x),
            depth = x == there ? here : depth_at(scene, there, y);
    if (depth > best) best = depth;
    if (!any || here > top) top = here, any = true;
  };
  for (const int i : {0, 1}) {
    consider(scene.x[i]);
    if (scene.ball || !rim_above(scene, i, y, middle, half)) continue;
    consider(middle - half);
    consider(middle + half);
  }
  if (scene.sigma != 0 && scene.tilt_x > 0) {
    const T turn = scene.c * scene.s * y / sqrt(scene.tilt_x);
    consider((turn - scene.s * scene.r[0]) / scene.sigma);
    consider((-turn - scene.s * scene.r[0]) / scene.sigma);
  }
  const T at_high = depth_at(scene, inside.high, y);
  if (at_high > best) best = at_high;
  return best < top ? best : top;
}

}  // namespace lumbrical::reference
