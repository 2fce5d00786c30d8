// The field law's line integrals over disc terms, one source for every instruction set.
//
// In disc coordinates the field is phi = R - w, w = sqrt(r^2 + h^2), and the section the disc r <= rho,
// rho^2 = (R - h)(R + h). By Green's theorem with radial fields, for a polygon with the disc's centre
// anywhere,
//   area    sum over edges of  p (xb - xa) / 2 + rho^2 theta / 2
//   volume  sum of  G theta + integral of (G - E) d(angle) over the part inside,  E(w) = phi^2 (3R - 2phi) /
//   6
// with x along the edge counted from the foot of the perpendicular, p the foot's signed distance (centre on
// the left: positive), [xa, xb] the part inside the disc, theta the angle the parts outside subtend and G =
// E(h). First moments: the potentials (rho^2 - r^2) / 2 and E vanish on the rim, so only edges contribute.
#pragma once

#include "field_terms.h"
#include "wide_functions.h"

namespace lumbrical::LUMBRICAL_ISA {

// One term's segment in its disc's coordinates.
template <class V>
struct Chord {
  V tx, ty;      // unit direction
  V p;           // signed distance of the centre, positive on the left
  V x1, x2;      // ends, from the foot
  V xa, xb;      // of the part inside the disc
  V theta;       // angle subtended by the parts outside
  V rho2, gap2;  // rho^2, and rho^2 - p^2 where positive
};

template <class V>
inline Chord<V> chord_of(V px, V py, V qx, V qy, V radius, V height) {
  const V zero = number<V>(0), one = number<V>(1);
  Chord<V> c;
  const V dx = qx - px, dy = qy - py;
  const V length = root(dx * dx + dy * dy);
  const V inverse = quotient(choose(length > zero, one, zero), choose(length > zero, length, one));
  c.tx = dx * inverse;
  c.ty = dy * inverse;
  // From the nearer end: a far one would bring its own rounding along.
  const auto nearer = px * px + py * py < qx * qx + qy * qy;
  const V nx = choose(nearer, px, qx), ny = choose(nearer, py, qy);
  c.p = nx * c.ty - ny * c.tx;
  c.x1 = px * c.tx + py * c.ty;
  c.x2 = qx * c.tx + qy * c.ty;
  c.rho2 = (radius - height) * (radius + height);
  c.gap2 = greater(c.rho2 - c.p * c.p, zero);
  const V half = root(c.gap2);
  c.xa = between(c.x1, zero - half, half);
  c.xb = between(c.x2, zero - half, half);
  const V p2 = c.p * c.p;
  const V cos1 = c.x1 * c.xa + p2, sin1 = c.p * (c.xa - c.x1);
  const V cos2 = c.x2 * c.xb + p2, sin2 = c.p * (c.x2 - c.xb);
  // Where one part is empty and its end in the centre, its cosine is 0 too.
  const V c1 = choose(sin1 == zero, one, cos1), s1 = sin1;
  const V c2 = choose(sin2 == zero, one, cos2), s2 = sin2;
  c.theta = angle_of(s1 * c2 + c1 * s2, c1 * c2 - s1 * s2);
  return c;
}

// The largest depth (along -n to the primitive's far surface) of the points at x in [xa, xb] along the
// segment: depth is concave along it, so the best place of the whole line is clamped to the part inside. The
// best place is above the sphere, at axial fraction t, whose foot it is.
template <class V>
inline V depth_on(const Chord<V>& c, V px, V py, V dx, V dy, V radius, const DiscTerms<NumberOf<V>>& terms,
                  std::size_t i) {
  const V zero = number<V>(0), one = number<V>(1);
  const V h1 = get(terms.h1 + i, V{}), span = get(terms.span + i, V{}), rise = get(terms.rise + i, V{});
  const V cosine = get(terms.cosine + i, V{}), per_span = get(terms.per_span + i, V{});
  const V length2 = dx * dx + dy * dy, per_length2 = quotient(one, choose(length2 > zero, length2, one));
  const V slope = zero - span * dy, steep2 = slope * slope + rise * rise * length2;
  const V steep = root(choose(steep2 > zero, steep2, one));
  const V pull = choose(slope < zero, radius, zero - radius) * quotient(rise * length2, steep);
  const V moving = choose(slope == zero, one, slope);
  const V t = choose(slope == zero, zero, between(quotient(pull - (px * dy - py * dx), moving), zero, one));
  const V disc_length = c.x2 - c.x1, per = quotient(one, choose(disc_length > zero, disc_length, one));
  const V foot = ((t * span - px) * dx - py * dy) * per_length2;
  const V along = between(foot, (c.xa - c.x1) * per, (c.xb - c.x1) * per);
  const V x = px + along * dx, y = py + along * dy;
  const V reach2 = greater((radius - y) * (radius + y), zero);
  const V axial = between((x - cosine * root(reach2)) * per_span, zero, one);
  const V off = x - axial * span;
  const V depth = root(greater(reach2 - off * off, zero)) - h1 - axial * rise;
  return choose(c.xb > c.xa, depth, zero);
}

template <class V>
inline void store_moments(DiscTerms<NumberOf<V>>& terms, std::size_t i, V shift, V area, V area_x, V area_y,
                          V volume, V volume_x, V volume_y) {
  const V per = get(terms.per_scale + i, V{});
  put(terms.area + i, area * per);
  put(terms.area_x + i, (area_x - shift * area) * per * per);
  put(terms.area_y + i, area_y * per);
  put(terms.volume + i, volume * per);
  put(terms.volume_x + i, (volume_x - shift * volume) * per * per);
  put(terms.volume_y + i, volume_y * per);
}

// Closed form; cancels where the whole region is shallow.
template <class V>
void closed_terms(DiscTerms<NumberOf<V>>& terms) {
  const V zero = number<V>(0), third = number<V>(1.0 / 3);
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    const V scale = get(terms.scale + i, V{}), shift = get(terms.shift + i, V{});
    const V px = get(terms.x1 + i, V{}), py = get(terms.y1 + i, V{});
    const V qx = get(terms.x2 + i, V{}), qy = get(terms.y2 + i, V{});
    const V radius = get(terms.radius + i, V{}), h = get(terms.height + i, V{});
    const Chord<V> c = chord_of(px * scale + shift, py, qx * scale + shift, qy, radius, h);

    const V p2 = c.p * c.p, h2 = h * h, k2 = p2 + h2;
    const V wa = root(c.xa * c.xa + k2), wb = root(c.xb * c.xb + k2);
    const V delta = c.xb - c.xa;
    const V log = twice_atanh(delta, wa + wb);
    const V w1 = number<V>(0.5) * (c.xb * wb - c.xa * wa + k2 * log);
    // atan(h x / (p w)) - atan(x / p), merged so that nothing happens at p = 0, from a to b.
    const V ra = c.xa * c.xa + p2, rb = c.xb * c.xb + p2;
    const V na = zero - c.xa * c.p * ra, ma = (p2 * wa + h * (c.xa * c.xa)) * (wa + h);
    const V nb = zero - c.xb * c.p * rb, mb = (p2 * wb + h * (c.xb * c.xb)) * (wb + h);
    const V turn = angle_of(nb * ma - na * mb, ma * mb + na * nb);
    const V phi = radius - h;
    const V g = phi * phi * (number<V>(3) * radius - number<V>(2) * phi) * number<V>(1.0 / 6);
    const V volume = g * c.theta + (number<V>(0.5) * radius) * (c.p * delta) -
                     third * (c.p * w1 + h2 * (c.p * log) + h2 * h * turn);

    const V xa3 = c.xa * c.xa * c.xa, xb3 = c.xb * c.xb * c.xb;
    const V cubes = third * (xb3 - xa3);
    const V area = number<V>(0.5) * (c.p * delta + c.rho2 * c.theta);
    const V area_out = number<V>(0.5) * (c.gap2 * delta - cubes);
    const V w2 = k2 * delta + cubes;
    const V w3 =
        number<V>(0.25) * (c.xb * (wb * wb * wb) - c.xa * (wa * wa * wa)) + number<V>(0.75) * (k2 * w1);
    const V r3 = radius * radius * radius;
    const V volume_out = number<V>(1.0 / 6) * (r3 * delta) - number<V>(0.5) * (radius * w2) + third * w3;
    store_moments(terms, i, shift, area, zero - c.ty * area_out, c.tx * area_out, volume,
                  zero - c.ty * volume_out, c.tx * volume_out);
    put(terms.depth + i, depth_on(c, px, py, qx - px, qy - py, radius, terms, i));
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
