// The lines of constant y at which the structure of a line changes, so that integrals over lines are not
// smooth.
//
// All curves in the plane are conics symmetric about y = 0: what the end spheres and the side cut out of the
// plane, where the deepest sphere becomes that of an end (field), what lies above the circles in which side
// and ends meet (column). A line's structure changes where two of them or one of them and an edge meet, at
// their lowest and highest points, and at corners.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "line.h"

namespace lumbrical::reference {

/// a x^2 + 2 b x + c + d y^2 = 0
template <class T>
struct Conic {
  T a{}, b{}, c{}, d{};
};

/// Calls f for each real root of a x^2 + 2 b x + c.
template <class T, class F>
void for_roots(const T& a, const T& b, const T& c, const F& f) {
  using std::sqrt;
  const T square = b * b - a * c;
  if (!(square >= 0)) return;
  const T large = b < 0 ? T(sqrt(square) - b) : T(-sqrt(square) - b);
  if (a != 0) f(T(large / a));
  if (large != 0) f(T(c / large));
}

template <class T>
std::vector<Conic<T>> section_conics(const Scene<T>& scene) {
  std::vector<Conic<T>> conics;
  for (int i = 0; i < (scene.flat ? 0 : scene.ball ? 1 : 2); ++i) {
    if (scene.gap[i] > 0) conics.push_back({T(1), -scene.x[i], scene.x[i] * scene.x[i] - scene.gap[i], T(1)});
  }
  if (scene.ball) return conics;
  conics.push_back({scene.tilt_x, -scene.s * (scene.sigma * scene.r[0] - scene.c * scene.h[0]),
                    -scene.near0 * scene.far0, scene.kappa * scene.kappa});
  if (!scene.flat) return conics;
  for (const int i : {0, 1}) conics.push_back({T(0), scene.s / 2, scene.q0 - scene.touch[i], T(0)});
  return conics;
}

template <class T>
std::vector<Conic<T>> field_conics(const Scene<T>& scene) {
  std::vector<Conic<T>> conics;
  if (scene.ball || scene.flat) return conics;
  const T kk = scene.kappa * scene.kappa, ss = scene.sigma * scene.sigma;
  for (const int i : {0, 1}) {
    const T end = i * scene.length, along = end - scene.q0;
    if (scene.sigma == 0) {
      conics.push_back({T(0), scene.s / 2, -along, T(0)});
    } else {
      conics.push_back({scene.tilt_z, -scene.s * (kk * end - scene.q0),
                        kk * along * along - ss * scene.e0 * scene.e0, -ss});
    }
  }
  return conics;
}

template <class T>
std::vector<Conic<T>> column_conics(const Scene<T>& scene) {
  std::vector<Conic<T>> conics;
  if (scene.ball) return conics;
  for (const int i : {0, 1}) {
    const T middle = scene.s * scene.touch[i], radius = scene.kappa * scene.r[i], cc = scene.c * scene.c;
    conics.push_back({T(1), -middle, middle * middle - cc * radius * radius, cc});
  }
  return conics;
}

/// Adds places between breaks so that none is much closer to another than to the next: beside a break that is
/// none of its own ends a piece looks smooth from afar, and no quadrature would find out that it isn't.
template <class T>
std::vector<T> graded(const std::vector<T>& breaks) {
  constexpr int kMost = 64, kStep = 16;
  std::vector<T> list;
  const auto add_up_to = [&](const T& next) {
    while (list.size() > 1) {
      const T before = list.back() - list[list.size() - 2];
      if (!(next - list.back() > kMost * before)) break;
      list.push_back(list.back() + kStep * before);
    }
    list.push_back(next);
  };
  for (const T& y : breaks) add_up_to(y);
  // The same from the other end.
  std::vector<T> mirrored(list.rbegin(), list.rend());
  for (T& y : mirrored) y = -y;
  list.clear();
  for (const T& y : mirrored) add_up_to(y);
  for (T& y : list) y = -y;
  std::reverse(list.begin(), list.end());
  return list;
}

/// Collects those of the places offered to it that lie in triangle and solid or near them.
template <class T>
class Breaks {
 public:
  explicit Breaks(const Scene<T>& scene) : scene_(scene), extent_(scene.size) {
    T reach{};
    for (const Corner<T>& p : scene.corners) {
      for (const T& d : {T(p.x - scene.corners[0].x), T(p.y - scene.corners[0].y)}) {
        if (d > reach) reach = d;
        if (-d > reach) reach = -d;
      }
    }
    if (reach < extent_) extent_ = reach;
  }

  void add(const T& x, const T& y) {
    const T near = T(1e-3) * extent_, at = T(1e-9) * extent_;
    T outside = -field_at(scene_, x, y);
    const auto consider = [&](const T& distance) {
      if (distance > outside) outside = distance;
    };
    for (const Edge<T>& edge : scene_.edges) consider(edge.nx * x + edge.ny * y - edge.d);
    if (scene_.flat) {
      const T q = scene_.q0 + scene_.s * x;
      consider(-q);
      consider(q - scene_.length);
    }
    if (!(outside < near)) return;
    near_.push_back(y);
    if (!(outside < at)) return;
    if (!any_ || y < first_) first_ = y;
    if (!any_ || y > last_) last_ = y;
    any_ = true;
  }
  void add_mirrored(const T& x, const T& y_squared) {
    using std::sqrt;
    if (!(y_squared >= 0)) return;
    const T y = sqrt(y_squared);
    add(x, y);
    add(x, -y);
  }

  /// In order, graded, from the first to the last that is not only near; without those that hold nothing
  /// between them.
  [[nodiscard]] std::vector<T> sorted() {
    if (!any_) return {};
    if (first_ < 0 && last_ > 0) near_.push_back(T(0));
    std::sort(near_.begin(), near_.end());
    std::vector<T> apart;
    const T least = 4 * std::numeric_limits<T>::epsilon();
    for (const T& y : near_) {
      if (apart.empty() || y - apart.back() > least * (y < 0 ? T(-y) : y)) apart.push_back(y);
    }
    std::vector<T> list = graded(apart);
    // Of neighbours in floating point one was dropped, which may have been the first or the last.
    std::erase_if(list, [&](const T& y) { return y <= first_ || y >= last_; });
    list.insert(list.begin(), first_);
    if (last_ > first_) list.push_back(last_);
    return list;
  }

 private:
  const Scene<T>& scene_;
  T extent_;  ///< of the smaller of the two
  std::vector<T> near_;
  bool any_ = false;
  T first_{}, last_{};
};

template <class T>
void add_crossings(const Edge<T>& edge, const Conic<T>& conic, Breaks<T>& breaks) {
  const T x = edge.nx * edge.d, y = edge.ny * edge.d, ux = -edge.ny, uy = edge.nx;
  for_roots(T(conic.a * ux * ux + conic.d * uy * uy), T((conic.a * x + conic.b) * ux + conic.d * y * uy),
            T(conic.a * x * x + 2 * conic.b * x + conic.c + conic.d * y * y),
            [&](const T& t) { breaks.add(T(x + t * ux), T(y + t * uy)); });
}

template <class T>
void add_crossings(const Conic<T>& p, const Conic<T>& q, Breaks<T>& breaks) {
  using std::abs;
  const Conic<T>& rounder = abs(p.d) > abs(q.d) ? p : q;
  if (rounder.d == 0) return;
  for_roots(T(p.a * q.d - q.a * p.d), T(p.b * q.d - q.b * p.d), T(p.c * q.d - q.c * p.d), [&](const T& x) {
    breaks.add_mirrored(x, T(-(rounder.a * x * x + 2 * rounder.b * x + rounder.c) / rounder.d));
  });
}

/// Where the conic's tangent is a line of constant y.
template <class T>
void add_extremes(const Conic<T>& conic, Breaks<T>& breaks) {
  if (conic.a == 0 || conic.d == 0) return;
  const T x = -conic.b / conic.a;
  breaks.add_mirrored(x, T((conic.b * x + conic.c) / -conic.d));
}

/// Where the section's own curve goes over from an end to the side, tangentially.
template <class T>
void add_touches(const Scene<T>& scene, Breaks<T>& breaks) {
  if (scene.ball || scene.s == 0) return;
  for (const int i : {0, 1}) {
    const T x = scene.touch_x[i], e = scene.e0 + scene.c * x;
    const T radius = scene.flat ? scene.r[i] : T(scene.kappa * scene.r[i]);
    breaks.add_mirrored(x, T((radius - e) * (radius + e)));
  }
}

/// All breaks, from the first line that may meet both triangle and solid to the last; fewer than two: none
/// does.
template <class T>
std::vector<T> breaks_of(const Scene<T>& scene, const Wanted& wanted) {
  Breaks<T> breaks(scene);
  if (scene.corners.empty()) return {};
  const auto section = section_conics(scene),
             field = wanted.field ? field_conics(scene) : std::vector<Conic<T>>{},
             column = wanted.column ? column_conics(scene) : std::vector<Conic<T>>{};
  for (const Corner<T>& corner : scene.corners) breaks.add(corner.x, corner.y);
  add_touches(scene, breaks);
  for (const auto& conics : {section, field, column}) {
    for (const Conic<T>& conic : conics) {
      add_extremes(conic, breaks);
      for (const Edge<T>& edge : scene.edges) add_crossings(edge, conic, breaks);
    }
  }
  for (const Conic<T>& curve : section) {
    for (const Conic<T>& rim : column) add_crossings(curve, rim, breaks);
  }
  return breaks.sorted();
}

}  // namespace lumbrical::reference
