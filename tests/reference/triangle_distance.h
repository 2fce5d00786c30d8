// How far a point is from a triangle, by definition: from the plane where its foot is inside, else from an
// edge.
#pragma once

#include <algorithm>

#include "vector.h"

namespace lumbrical::reference {

/// Both ends may be one point.
template <class T>
T distance_to_edge(const Vector<T>& p, const Vector<T>& from, const Vector<T>& to) {
  const Vector<T> along = to - from;
  const T square = dot(along, along);
  const T t = square > 0 ? std::clamp(dot(p - from, along) / square, T(0), T(1)) : T(0);
  return norm(p - from - t * along);
}

/// A degenerate triangle is nothing but its edges.
template <class T>
T distance_to_triangle(const Vector<T>& p, const Vector<T>& a, const Vector<T>& b, const Vector<T>& c) {
  const T to_edges =
      std::min({distance_to_edge(p, a, b), distance_to_edge(p, b, c), distance_to_edge(p, c, a)});
  const Vector<T> u = b - a, v = c - a, w = p - a;
  const T uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), square = uu * vv - uv * uv;
  if (!(square > 0)) return to_edges;
  const T s = (vv * dot(u, w) - uv * dot(v, w)) / square, t = (uu * dot(v, w) - uv * dot(u, w)) / square;
  const bool is_inside = s >= 0 && t >= 0 && s + t <= 1;
  return is_inside ? std::min(to_edges, norm(w - s * u - t * v)) : to_edges;
}

}  // namespace lumbrical::reference
