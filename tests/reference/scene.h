// Solid and triangle in the frame of the triangle's plane, laid out in more digits than the rest needs.
//
// z runs along the triangle's normal and x under the primitive's axis, with the origin at the foot of its
// lower end. At height 0 a point (x, y) has the axial coordinate q = s x - c h1 from the lower end and the
// distance sqrt(e^2 + y^2), e = c x + s h1, from the axis' line; s and c are sine and cosine of the axis
// against z. The radius of the spheres grows by sigma per length of the axis, kappa^2 = 1 - sigma^2. The side
// that touches them all lies where kappa sqrt(e^2 + y^2) = r1 + sigma q =: level, and between the circles in
// which it touches the end spheres, at q = -sigma r1 and q = length - sigma r2.
#pragma once

#include <limits>
#include <type_traits>
#include <vector>

#include "contact.h"
#include "vector.h"

namespace lumbrical::reference {

/// Twice the digits of long double; Multi has enough as it is.
using Quad = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_quad::backend_type,
                                           boost::multiprecision::et_off>;
template <class T>
using Wide = std::conditional_t<std::is_same_v<T, Multi>, Multi, Quad>;

template <class T>
struct Corner {
  T x{}, y{};
};

/// A side of the cut triangle: inside is nx x + ny y <= d; its points are d (nx, ny) + t (-ny, nx), from <= t
/// <= to.
template <class T>
struct Edge {
  T nx{}, ny{}, d{}, from{}, to{};
};

template <class T>
struct Scene {
  bool flat = false, ball = false;
  T s{}, c{}, length{}, sigma{}, kappa{}, size{};  ///< size: the larger radius
  T r[2]{}, h[2]{}, x[2]{};                        ///< of the end spheres: radius, height, abscissa
  T gap[2]{};                                      ///< r^2 - h^2
  T touch[2]{};              ///< axial coordinates between which the side is the surface
  T touch_x[2]{};            ///< the same as abscissae at height 0; of no use where s = 0
  bool touch_holds = false;  ///< s = 0 and the plane runs between the two
  T e0{}, q0{};              ///< e = e0 + c x, q = q0 + s x
  T near0{}, near1{};        ///< level - kappa e = near0 + near1 x
  T far0{}, far1{};          ///< level + kappa e = far0 + far1 x
  T tilt_x{}, tilt_z{};      ///< c^2 - sigma^2, s^2 - sigma^2: > 0 where x, z are less steep than the side
  std::vector<Corner<T>> corners;
  std::vector<Edge<T>> edges;
  Vector<T> foot, u, v, n;  ///< of the frame, in the frame and units of the input
};

template <class T>
Vector<T> any_across(const Vector<T>& n) {
  using std::abs;
  return unit(cross(n, abs(n.x) < T(0.6) ? Vector<T>{T(1), T(0), T(0)} : Vector<T>{T(0), T(1), T(0)}));
}

/// Fills in all but the polygon. The plane runs through `point` with the normal n (unit).
template <class T>
void look_at_solid(const Solid& solid, const Vector<T>& point, const Vector<T>& n, Scene<T>& scene) {
  using std::abs;
  using std::sqrt;
  Vector<T> end[2] = {solid.end1.as<T>(), solid.end2.as<T>()};
  T r[2] = {T(solid.radius1), T(solid.radius2)};
  if (dot(end[1] - end[0], n) < 0) std::swap(end[0], end[1]), std::swap(r[0], r[1]);
  Vector<T> axis = end[1] - end[0];
  T length = norm(axis);
  scene.flat = solid.flat;
  scene.ball = !solid.flat && !(length > abs(r[1] - r[0]));
  if (scene.ball) {
    if (r[1] > r[0]) end[0] = end[1], r[0] = r[1];
    r[1] = r[0], end[1] = end[0], length = 0, axis = n;
  } else {
    axis = (1 / length) * axis;
  }
  const Vector<T> side = cross(n, axis);
  T s = norm(side);
  const bool upright = s < 4096 * std::numeric_limits<T>::epsilon();
  if (upright) s = 0;
  Vector<T> v = upright ? any_across(n) : (1 / s) * side;
  v = unit(v - dot(v, n) * n);
  const T c = upright ? T(1) : dot(n, axis);
  scene.n = n, scene.v = v, scene.u = cross(v, n);
  scene.s = s, scene.c = c, scene.length = length;
  scene.sigma = scene.ball || solid.flat ? T(0) : T((r[1] - r[0]) / length);
  scene.kappa = sqrt((1 - scene.sigma) * (1 + scene.sigma));
  scene.size = r[0] > r[1] ? r[0] : r[1];
  for (int i = 0; i < 2; ++i) {
    scene.r[i] = r[i];
    scene.h[i] = dot(end[0] - point, n) + i * (c * length);
    scene.x[i] = i * (s * length);
    scene.gap[i] = (r[i] - scene.h[i]) * (r[i] + scene.h[i]);
    scene.touch[i] = i * length - (solid.flat ? T(0) : T(scene.sigma * r[i]));
  }
  const T h = scene.h[0], level0 = r[0] - scene.sigma * c * h;
  scene.foot = end[0] - h * n;
  scene.e0 = s * h, scene.q0 = -c * h;
  scene.near0 = level0 - scene.kappa * s * h, scene.near1 = scene.sigma * s - scene.kappa * c;
  scene.far0 = level0 + scene.kappa * s * h, scene.far1 = scene.sigma * s + scene.kappa * c;
  scene.tilt_x = (c - scene.sigma) * (c + scene.sigma);
  scene.tilt_z = (s - scene.sigma) * (s + scene.sigma);
  if (upright) {
    scene.touch_holds = scene.q0 >= scene.touch[0] && scene.q0 <= scene.touch[1];
  } else {
    for (int i = 0; i < 2; ++i) scene.touch_x[i] = (scene.touch[i] - scene.q0) / s;
  }
}

/// Keeps what lies where nx x + ny y <= d.
template <class T>
void cut_corners(const T& nx, const T& ny, const T& d, std::vector<Corner<T>>& corners) {
  std::vector<Corner<T>> kept;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corner<T>&p = corners[i], &q = corners[(i + 1) % corners.size()];
    const T at_p = nx * p.x + ny * p.y - d, at_q = nx * q.x + ny * q.y - d;
    if (at_p <= 0) kept.push_back(p);
    if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0)) {
      const T t = at_p / (at_p - at_q);
      kept.push_back({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
    }
  }
  corners = std::move(kept);
}

template <class T>
void add_triangle(const Solid& solid, const Triangle& triangle, Scene<T>& scene) {
  using std::sqrt;
  for (const Vector<double>& corner : triangle) {
    const Vector<T> p = corner.as<T>() - scene.foot;
    scene.corners.push_back({dot(p, scene.u), dot(p, scene.v)});
  }
  for (const HalfSpace& cut : solid.cuts) {
    const Vector<T> normal = cut.normal.as<T>();
    cut_corners(dot(normal, scene.u), dot(normal, scene.v), dot(normal, cut.point.as<T>() - scene.foot),
                scene.corners);
  }
  for (std::size_t i = 0; i < scene.corners.size(); ++i) {
    const Corner<T>&p = scene.corners[i], &q = scene.corners[(i + 1) % scene.corners.size()];
    const T dx = q.x - p.x, dy = q.y - p.y, span = sqrt(dx * dx + dy * dy);
    if (!(span > 0)) continue;
    const T nx = dy / span, ny = -dx / span;
    scene.edges.push_back({nx, ny, nx * p.x + ny * p.y, nx * p.y - ny * p.x, nx * q.y - ny * q.x});
  }
}

template <class T, class W>
Scene<T> narrowed(const Scene<W>& wide) {
  const auto to = [](const W& value) { return static_cast<T>(value); };
  Scene<T> scene;
  scene.flat = wide.flat, scene.ball = wide.ball, scene.touch_holds = wide.touch_holds;
  scene.s = to(wide.s), scene.c = to(wide.c), scene.length = to(wide.length);
  scene.sigma = to(wide.sigma), scene.kappa = to(wide.kappa), scene.size = to(wide.size);
  for (int i = 0; i < 2; ++i) {
    scene.r[i] = to(wide.r[i]), scene.h[i] = to(wide.h[i]), scene.x[i] = to(wide.x[i]);
    scene.gap[i] = to(wide.gap[i]);
    scene.touch[i] = to(wide.touch[i]), scene.touch_x[i] = to(wide.touch_x[i]);
  }
  scene.e0 = to(wide.e0), scene.q0 = to(wide.q0);
  scene.near0 = to(wide.near0), scene.near1 = to(wide.near1);
  scene.far0 = to(wide.far0), scene.far1 = to(wide.far1);
  scene.tilt_x = to(wide.tilt_x), scene.tilt_z = to(wide.tilt_z);
  for (const Corner<W>& p : wide.corners) scene.corners.push_back({to(p.x), to(p.y)});
  for (const Edge<W>& e : wide.edges)
    scene.edges.push_back({to(e.nx), to(e.ny), to(e.d), to(e.from), to(e.to)});
  scene.foot = wide.foot.template as<T>();
  scene.u = wide.u.template as<T>(), scene.v = wide.v.template as<T>(), scene.n = wide.n.template as<T>();
  return scene;
}

template <class T>
Scene<T> lay_out(const Solid& solid, const Triangle& triangle) {
  using W = Wide<T>;
  const Vector<W> a = triangle[0].as<W>();
  Scene<W> scene;
  look_at_solid(solid, a, unit(cross(triangle[1].as<W>() - a, triangle[2].as<W>() - a)), scene);
  add_triangle(solid, triangle, scene);
  return narrowed<T>(scene);
}

}  // namespace lumbrical::reference
