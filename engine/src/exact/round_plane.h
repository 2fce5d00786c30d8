// A round primitive seen from the planes of triangles, a plane per lane; the same frame as section.h.
#pragma once

#include "exact/round_terms.h"
#include "section/plane_limits.h"
#include "section/stated_errors.h"
#include "simd/wide_geometry.h"

namespace lumbrical::LUMBRICAL_ISA {

// The primitives. The same in all lanes are the last two.
template <class V>
struct RoundPart {
  V length, radius1, radius2, sine, cosine, per_cosine, tangent;
  bool sphere, cone;
};

template <class V>
inline RoundPart<V> round_part(V length, V radius1, V radius2, V sine, V cosine, bool sphere, bool cone) {
  return {length, radius1, radius2, sine, cosine, divide(number<V>(1), cosine), divide(sine, cosine),
          sphere, cone};
}

template <class V>
inline RoundPart<V> part_of(const RoundTerms& terms, std::size_t i) {
  const auto row = [i](const double* from) { return get(from + i, V{}); };
  return round_part(row(terms.length), row(terms.radius1), row(terms.radius2), row(terms.sine),
                    row(terms.cosine), terms.sphere, terms.cone);
}

template <class V>
struct RoundPlane {
  Wide3<V> u, v, n;  // W: along the projected axis, across, outward normal
  V s, c;            // sine and cosine of the angle between axis and n
  V h1, h2, x2;      // [m] heights of the ends over the plane, x of the second end
  V rounded;         // [m] what rounding leaves in these heights
};

// What rounding leaves, as a share.
template <class V>
inline V rounding() {
  return number<V>(1e-15);
}

// Farther than anything.
template <class V>
inline V beyond() {
  return number<V>(1e300);
}

// Of a triangle: `twice` its area, and its longest edge squared.
template <class V>
inline auto has_normal(V twice, V longest) {
  return twice > number<V>(kNoNormal) * longest && longest < number<V>(kMostEdgeSquared) &&
         twice > number<V>(kLeastTwiceArea);
}

// False where the triangle has no normal to speak of.
template <class V>
inline auto look(const RoundPart<V>& part, Wide3<V> axis, Wide3<V> a, Wide3<V> b, Wide3<V> c,
                 RoundPlane<V>& plane) {
  const V one = number<V>(1), zero = number<V>(0);
  const Wide3<V> ab = b - a, ac = c - a, bc = c - b;
  const Wide3<V> raw = cross(ab, ac);
  const V twice = sqrt(dot(raw, raw));
  const V longest = max(dot(ab, ab), max(dot(ac, ac), dot(bc, bc)));
  const auto fine = has_normal(twice, longest);
  const V per_twice = one_over(twice);
  plane.n = per_twice * raw;
  const V far = sqrt(max(dot(a, a), max(dot(b, b), dot(c, c))));
  plane.rounded = number<V>(kPlaneRounding) * far * (longest * per_twice);
  plane.h1 = zero - dot(plane.n, a);
  Wide3<V> across = cross(plane.n, ab);
  plane.s = zero;
  plane.c = one;
  if (!part.sphere) {
    const Wide3<V> side = cross(plane.n, axis);
    const V s = sqrt(dot(side, side));
    const auto slanted = s > number<V>(kNoDirection);
    plane.s = select(slanted, s, zero);
    plane.c = dot(plane.n, axis);
    across = select(slanted, side, across);
  }
  // Rounding tilts a short vector out of the plane; one projection puts it back.
  across = across - dot(across, plane.n) * plane.n;
  plane.v = one_over(sqrt(dot(across, across))) * across;
  plane.u = cross(plane.v, plane.n);
  plane.h2 = plane.h1 + plane.c * part.length;
  plane.x2 = plane.s * part.length;
  return fine;
}

// phi at a point of the plane, and how far in space it is to where phi's formula changes.
template <class V>
struct FieldValue {
  V phi, margin;
};

template <class V>
inline FieldValue<V> field_at(const RoundPart<V>& part, const RoundPlane<V>& plane, Wide2<V> p) {
  const V zero = number<V>(0);
  if (part.sphere) {
    const V w = sqrt(dot(p, p) + plane.h1 * plane.h1);
    return {part.radius1 - w, beyond<V>()};
  }
  const V e = plane.c * p.x + plane.s * plane.h1, q = plane.s * p.x - plane.c * plane.h1;
  const V rho2 = e * e + p.y * p.y, rho = sqrt(rho2);
  const V at = clamp(q - rho * part.tangent, zero, part.length), off = q - at;
  const V w = sqrt(off * off + rho2);
  const V phi = part.radius1 - part.sine * at - w;
  const V first = part.cosine * q - part.sine * rho;
  return {phi, min(abs(first), abs(first - part.cosine * part.length))};
}

// Is phi negative at a point of the plane? With no root but one, and that of cones only.
template <class V>
inline auto is_outside(const RoundPart<V>& part, const RoundPlane<V>& plane, Wide2<V> p) {
  const V zero = number<V>(0);
  if (part.sphere) return dot(p, p) + plane.h1 * plane.h1 > part.radius1 * part.radius1;
  const V e = plane.c * p.x + plane.s * plane.h1, q = plane.s * p.x - plane.c * plane.h1;
  const V rho2 = e * e + p.y * p.y, shift = part.cone ? sqrt(rho2) * part.tangent : zero;
  const V at = clamp(q - shift, zero, part.length), off = q - at, reach = part.radius1 - part.sine * at;
  return off * off + rho2 > reach * reach;
}

}  // namespace lumbrical::LUMBRICAL_ISA
