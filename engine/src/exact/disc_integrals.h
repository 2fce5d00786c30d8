// The field's integrals over the part of a polygon inside a disc: what a plane cuts out of a sphere. And the
// area alone inside an ellipse, which is a disc after stretching.
//
// In coordinates about the disc's centre the field is phi = R - w, w = sqrt(r^2 + h^2), and the section r <=
// rho, rho^2 = (R - h)(R + h). By Green's theorem with radial fields, for a polygon with the centre anywhere,
//   area    sum over edges of  p (xb - xa) / 2 + rho^2 theta / 2
//   volume  sum of  G theta + integral of (G - E) d(angle) over the part inside,
//           E(w) = phi^2 (3R - 2phi) / 6
// with x along the edge counted from the foot of the perpendicular, p the foot's signed distance (centre on
// the left: positive), [xa, xb] the part inside the disc, theta the angle the parts outside subtend and G =
// E(h). First moments: the potentials (rho^2 - r^2) / 2 and E vanish on the rim, so only edges contribute.
#pragma once

#include "base/gauss.h"
#include "exact/round_polygon.h"

namespace lumbrical::LUMBRICAL_ISA {

// Integrals of 1 and of phi and their first moments.
template <class V>
struct Moments {
  V area, area_x, area_y, volume, volume_x, volume_y;
};
template <class V>
inline Moments<V> no_moments() {
  const V zero = number<V>(0);
  return {zero, zero, zero, zero, zero, zero};
}
template <class V, class M>
inline void add_areas(M which, const Moments<V>& more, Moments<V>& sum) {
  const V zero = number<V>(0);
  sum.area = sum.area + select(which, more.area, zero);
  sum.area_x = sum.area_x + select(which, more.area_x, zero);
  sum.area_y = sum.area_y + select(which, more.area_y, zero);
}
template <class V, class M>
inline void add_volumes(M which, const Moments<V>& more, Moments<V>& sum) {
  const V zero = number<V>(0);
  sum.volume = sum.volume + select(which, more.volume, zero);
  sum.volume_x = sum.volume_x + select(which, more.volume_x, zero);
  sum.volume_y = sum.volume_y + select(which, more.volume_y, zero);
}
template <class V, class M>
inline void add_where(M which, const Moments<V>& more, Moments<V>& sum) {
  add_areas(which, more, sum);
  add_volumes(which, more, sum);
}

// The area of a polygon and its first moments; `base` is a point near it.
template <class V>
Moments<V> area_of(const Polygon<V>& polygon, Wide2<V> base) {
  const V zero = number<V>(0), half = number<V>(0.5), third = number<V>(1.0 / 3);
  Moments<V> sum = no_moments<V>();
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const auto here = has_length(polygon.edge[i]);
    const Wide2<V> p = polygon.edge[i].p - base, q = polygon.edge[i].q - base;
    const V area = select(here, half * cross(p, q), zero);
    sum.area = sum.area + area;
    sum.area_x = sum.area_x + area * (p.x + q.x);
    sum.area_y = sum.area_y + area * (p.y + q.y);
  }
  sum.area_x = third * sum.area_x + base.x * sum.area;
  sum.area_y = third * sum.area_y + base.y * sum.area;
  return sum;
}

// An edge against a disc about the origin.
template <class V>
struct Chord {
  Wide2<V> t;     // unit direction
  V p;            // signed distance of the centre, positive on the left
  V x1, x2;       // ends, from the foot
  V xa, xb;       // of the part inside the disc
  V gap2, theta;  // rho^2 - p^2 where positive; angle subtended by the parts outside
};

template <class V>
inline Chord<V> chord_of(Wide2<V> from, Wide2<V> to, Wide2<V> t, V rho2) {
  const V zero = number<V>(0), one = number<V>(1);
  Chord<V> c;
  c.t = t;
  c.p = cross(select(dot(from, from) < dot(to, to), from, to), t);
  c.x1 = dot(from, t);
  c.x2 = dot(to, t);
  const V p2 = c.p * c.p;
  c.gap2 = max(rho2 - p2, zero);
  const V half = sqrt(c.gap2);
  c.xa = clamp(c.x1, zero - half, half);
  c.xb = clamp(c.x2, zero - half, half);
  const V sin1 = c.p * (c.xa - c.x1), sin2 = c.p * (c.x2 - c.xb);
  // Where one part is empty and its end in the centre, its cosine is 0 too.
  const V cos1 = select(sin1 == zero, one, c.x1 * c.xa + p2);
  const V cos2 = select(sin2 == zero, one, c.x2 * c.xb + p2);
  c.theta = angle_of(sin1 * cos2 + cos1 * sin2, cos1 * cos2 - sin1 * sin2);
  return c;
}

template <class V>
inline void area_of(const Chord<V>& c, V rho2, Moments<V>& moments) {
  const V delta = c.xb - c.xa, squares = c.xb * c.xb + c.xb * c.xa + c.xa * c.xa;
  moments.area = number<V>(0.5) * (c.p * delta + rho2 * c.theta);
  const V out = number<V>(0.5) * (delta * (c.gap2 - number<V>(1.0 / 3) * squares));
  moments.area_x = number<V>(0) - c.t.y * out;
  moments.area_y = c.t.x * out;
}

// Where no point of the section has more than this share of R, closed forms cancel.
inline constexpr double kShallow = 0.05;

// Integrals of phi along one edge of a polygon inside a sphere of radius R whose centre is h >= 0 away from
// the plane. Closed form; cancels where the whole region is shallow.
template <class V>
inline void deep_disc(const Chord<V>& c, V radius, V h, Moments<V>& moments) {
  const V zero = number<V>(0), third = number<V>(1.0 / 3), half = number<V>(0.5);
  const V p2 = c.p * c.p, h2 = h * h, k2 = p2 + h2;
  const V xa2 = c.xa * c.xa, xb2 = c.xb * c.xb;
  const V wa2 = xa2 + k2, wb2 = xb2 + k2, wa = sqrt(wa2), wb = sqrt(wb2);
  const V delta = c.xb - c.xa;
  const V log = twice_atanh(delta, wa + wb);
  const V w1 = half * (c.xb * wb - c.xa * wa + k2 * log);
  // atan(h x / (p w)) - atan(x / p), merged so that nothing happens at p = 0, from a to b.
  const V na = zero - c.xa * c.p * (xa2 + p2), ma = (p2 * wa + h * xa2) * (wa + h);
  const V nb = zero - c.xb * c.p * (xb2 + p2), mb = (p2 * wb + h * xb2) * (wb + h);
  const V turn = angle_of(nb * ma - na * mb, ma * mb + na * nb);
  moments.volume = (half * radius) * (c.p * delta) - third * (c.p * w1 + h2 * (c.p * log) + h2 * h * turn);
  const V cubes = third * (delta * (xb2 + c.xb * c.xa + xa2));
  const V w2 = k2 * delta + cubes;
  const V w3 = number<V>(0.25) * (c.xb * (wb * wb2) - c.xa * (wa * wa2)) + number<V>(0.75) * (k2 * w1);
  const V out = number<V>(1.0 / 6) * (radius * radius * radius * delta) - half * (radius * w2) + third * w3;
  moments.volume_x = zero - c.t.y * out;
  moments.volume_y = c.t.x * out;
}

// The same by quadrature, for shallow discs: the integrands are far from their singularities there, and phi
// and (G - E) / r^2 are had without cancellation.
template <class V>
inline void shallow_disc(const Chord<V>& c, V radius, V h, Moments<V>& moments) {
  const V three = number<V>(3), two = number<V>(2), sixth = number<V>(1.0 / 6);
  const V delta = c.xb - c.xa, k2 = c.p * c.p + h * h, top = radius - h;
  V inner = number<V>(0), out = number<V>(0);
  for (const GaussNode& node : kGauss8) {
    const V x = c.xa + number<V>(node.at) * delta, x2 = x * x, w = sqrt(x2 + k2),
            weight = number<V>(node.weight);
    const V phi = divide(max(c.gap2 - x2, number<V>(0)), radius + w);
    const V squares = top * top + top * phi + phi * phi;
    inner = inner + weight * divide(three * radius * (top + phi) - two * squares, w + h);
    out = out + weight * (phi * phi * (three * radius - two * phi));
  }
  moments.volume = sixth * (c.p * delta * inner);
  moments.volume_x = number<V>(0) - c.t.y * (sixth * (delta * out));
  moments.volume_y = c.t.x * (sixth * (delta * out));
}

// `most` is the largest phi of the primitive's whole section.
template <class V>
inline Moments<V> disc_moments(const Chord<V>& c, V radius, V h, V rho2, V most) {
  Moments<V> moments = no_moments<V>(), other = moments;
  const V top = radius - h, limit = number<V>(kShallow) * radius;
  const auto shallow = most < limit;
  if (any(most >= limit)) deep_disc(c, radius, h, moments);
  if (any(shallow)) shallow_disc(c, radius, h, other);
  const V g = top * top * (number<V>(3) * radius - number<V>(2) * top) * number<V>(1.0 / 6);
  moments.volume = g * c.theta + select(shallow, other.volume, moments.volume);
  moments.volume_x = select(shallow, other.volume_x, moments.volume_x);
  moments.volume_y = select(shallow, other.volume_y, moments.volume_y);
  area_of(c, rho2, moments);
  return moments;
}

// What lies inside of every edge of the triangle: coordinates along it from the foot of (0, 0).
template <class V>
struct InsideParts {
  std::size_t count = 0;
  V lower[Polygon<V>::kMost], upper[Polygon<V>::kMost];
  template <class M>
  void add(std::size_t edge, M here, V from, V to) {
    if (edge >= count) return;
    lower[edge] = select(here, min(lower[edge], from), lower[edge]);
    upper[edge] = select(here, max(upper[edge], to), upper[edge]);
  }
};

// What of the polygon lies in the section of a sphere about (x0, 0). `of_edge` tells what an edge adds, of
// its chord, the sphere's distance from the plane and the disc's radius squared.
template <class V, class M, class OfEdge>
void add_disc(const Polygon<V>& polygon, const Directions<V>& directions, V x0, V radius, V height, M wanted,
              Moments<V>& sum, InsideParts<V>& inside, const OfEdge& of_edge) {
  const V zero = number<V>(0), h = abs(height), rho2 = (radius - h) * (radius + h);
  const auto real = wanted && rho2 > zero;
  if (!any(real)) return;
  Moments<V> own = no_moments<V>();
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Edge<V>& edge = polygon.edge[i];
    const auto here = real && has_length(edge);
    if (!any(here)) continue;
    const Wide2<V> from{edge.p.x - x0, edge.p.y}, to{edge.q.x - x0, edge.q.y};
    const Chord<V> chord = chord_of(from, to, directions.t[i], rho2);
    add_where(here, of_edge(chord, h, rho2), own);
    const V shift = x0 * directions.t[i].x;
    inside.add(i, here && chord.xa < chord.xb, chord.xa + shift, chord.xb + shift);
  }
  own.area_x = own.area_x + x0 * own.area;
  own.volume_x = own.volume_x + x0 * own.volume;
  add_where(real, own, sum);
}

}  // namespace lumbrical::LUMBRICAL_ISA
