// Which triangles certainly miss a round primitive, one source for every instruction set: the plane passes it
// by (Eq. 2 of the paper, corrected: docs/mechanics.md), or in the plane an edge or the extent of the
// triangle separates it from the section.
//
// In doubt the answer is no: what is not finite or has no normal is left to the closer look.
#pragma once

#include "miss_terms.h"
#include "wide_functions.h"

namespace lumbrical::LUMBRICAL_ISA {

template <class V>
struct Wide3 {
  V x, y, z;
};
template <class V>
inline Wide3<V> operator-(Wide3<V> p, Wide3<V> q) {
  return {p.x - q.x, p.y - q.y, p.z - q.z};
}
template <class V>
inline V dot(Wide3<V> p, Wide3<V> q) {
  return p.x * q.x + p.y * q.y + p.z * q.z;
}
template <class V>
inline Wide3<V> cross(Wide3<V> p, Wide3<V> q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}
template <class V>
inline Wide3<V> corner_of(const double (&from)[3][MissTerms::kCapacity], std::size_t i) {
  return {get(from[0] + i, V{}), get(from[1] + i, V{}), get(from[2] + i, V{})};
}

// Rounding must not lose a contact.
inline constexpr double kSlack = 1e-9;

// The section lies in the hull of two discs of radius `reach` in the triangle's plane, about the feet of the
// ends. Are both wholly on the outer side of the edge from p to q? With raw the triangle's normal times twice
// its area, cross(q - p, foot - p) . raw is the same with the end itself, for the difference is normal.
template <class V>
inline auto beyond_edge(Wide3<V> p, Wide3<V> q, Wide3<V> end1, Wide3<V> end2, Wide3<V> raw, V raw2,
                        V reach2) {
  const V zero = number<V>(0);
  const Wide3<V> edge = q - p, outward = cross(edge, raw);  // |outward|^2 = |edge|^2 raw2
  const V limit = reach2 * (dot(edge, edge) * raw2);
  const V first = dot(outward, end1 - p), second = dot(outward, end2 - p);
  return both(both(first > zero, second > zero), both(first * first > limit, second * second > limit));
}

template <class V>
void certain_misses(MissTerms& terms) {
  const V zero = number<V>(0), one = number<V>(1);
  const Wide3<V> end1{number<V>(terms.end1.x), number<V>(terms.end1.y), number<V>(terms.end1.z)};
  const V length = number<V>(terms.length);
  const Wide3<V> end2{end1.x + number<V>(terms.axis.x) * length, end1.y + number<V>(terms.axis.y) * length,
                      end1.z + number<V>(terms.axis.z) * length};
  const V larger = number<V>(1 + kSlack);
  const V r1 = number<V>(terms.radius1) * larger, r2 = number<V>(terms.radius2) * larger;
  const V most = number<V>(terms.most) * larger;
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    const Wide3<V> a = corner_of<V>(terms.a, i), b = corner_of<V>(terms.b, i), c = corner_of<V>(terms.c, i);
    const Wide3<V> raw = cross(b - a, c - a);
    const V raw2 = dot(raw, raw);
    const V area = root(raw2), per = quotient(one, choose(area > zero, area, one));
    const V h1 = dot(raw, end1 - a) * per, h2 = dot(raw, end2 - a) * per;
    const auto above = both(h1 > r1, h2 > r2);
    const auto below = both(h1 < zero - r1, h2 < zero - r2);
    const V lesser_height = lesser(magnitude(h1), magnitude(h2));
    const V least = choose(h1 * h2 > zero, lesser_height, zero) * number<V>(1 - kSlack);
    const V reach2 = greater((most - least) * (most + least), zero);
    const auto beyond = either(beyond_edge(a, b, end1, end2, raw, raw2, reach2),
                               either(beyond_edge(b, c, end1, end2, raw, raw2, reach2),
                                      beyond_edge(c, a, end1, end2, raw, raw2, reach2)));
    // A thin triangle's normal is too uncertain for verdicts: twice its area against its longest edge.
    const Wide3<V> ab = b - a, ac = c - a, bc = c - b;
    const V longest = greater(dot(ab, ab), greater(dot(ac, ac), dot(bc, bc)));
    const auto sure =
        both(area > number<V>(1e-6) * longest, both(longest<number<V>(1e6), area> number<V>(1e-18)));
    put(terms.miss + i, choose(both(sure, either(either(above, below), beyond)), one, zero));
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
