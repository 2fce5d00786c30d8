// Which triangles certainly miss a primitive, one source for every instruction set: the triangle's bounding
// sphere is too far from the primitive's hull, all of it lies beyond one of the primitive's planes, its plane
// passes the hull by (Eq. 2 of the paper, corrected: docs/mechanics.md), or in that plane one of its edges
// separates it from the section.
//
// In doubt the answer is no: what has no certain normal is left to the closer look. The answer depends on the
// pair alone, and in double precision: every broadphase gives it the last word.
#pragma once

#include "search/miss_terms.h"
#include "simd/wide_geometry.h"

namespace lumbrical::LUMBRICAL_ISA {

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
  return first > zero && second > zero && first * first > limit && second * second > limit;
}

// Corners are relative to the first end: far from the origin nothing else keeps their digits.
template <class V>
inline auto sphere_misses(const MissTerms& terms, Wide3<V> a, Wide3<V> b, Wide3<V> c) {
  const V third = number<V>(1.0 / 3), zero = number<V>(0);
  const Wide3<V> ab = b - a, ac = c - a;
  const Wide3<V> centre{a.x + (ab.x + ac.x) * third, a.y + (ab.y + ac.y) * third,
                        a.z + (ab.z + ac.z) * third};
  const Wide3<V> pa = a - centre, pb = b - centre, pc = c - centre;
  const V radius = sqrt(max(dot(pa, pa), max(dot(pb, pb), dot(pc, pc))));
  const Wide3<V> axis{number<V>(terms.axis.x), number<V>(terms.axis.y), number<V>(terms.axis.z)};
  const V along = clamp(dot(centre, axis), zero, number<V>(terms.length));
  const Wide3<V> gap{centre.x - along * axis.x, centre.y - along * axis.y, centre.z - along * axis.z};
  const V reach = (radius + number<V>(terms.most)) * number<V>(1 + kSlack);
  return dot(gap, gap) > reach * reach;
}

// Is all of the triangle beyond one of the planes? The result is positive if so.
template <class V>
inline V beyond_planes(const MissTerms& terms, Wide3<V> a, Wide3<V> b, Wide3<V> c) {
  V beyond = number<V>(0);
  for (int i = 0; i < terms.plane_count; ++i) {
    const MissTerms::Plane& plane = terms.plane[i];
    const Wide3<V> normal{number<V>(plane.normal.x), number<V>(plane.normal.y), number<V>(plane.normal.z)};
    const V lowest = min(dot(normal, a), min(dot(normal, b), dot(normal, c)));
    beyond = max(beyond, lowest - number<V>(plane.height + kSlack * terms.most));
  }
  return beyond;
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
    const Wide3<V> a = vector_at<V>(terms.a, i), b = vector_at<V>(terms.b, i), c = vector_at<V>(terms.c, i);
    const Wide3<V> raw = cross(b - a, c - a);
    const V raw2 = dot(raw, raw);
    const V area = sqrt(raw2), per = divide(one, select(area > zero, area, one));
    const V h1 = dot(raw, end1 - a) * per, h2 = dot(raw, end2 - a) * per;
    const auto above = h1 > r1 && h2 > r2;
    const auto below = h1 < zero - r1 && h2 < zero - r2;
    const V lesser_height = min(abs(h1), abs(h2));
    const V least = select(h1 * h2 > zero, lesser_height, zero) * number<V>(1 - kSlack);
    const V reach2 = max((most - least) * (most + least), zero);
    const auto beyond = beyond_edge(a, b, end1, end2, raw, raw2, reach2) ||
                        beyond_edge(b, c, end1, end2, raw, raw2, reach2) ||
                        beyond_edge(c, a, end1, end2, raw, raw2, reach2);
    // A thin triangle's normal is too uncertain for verdicts: twice its area against its longest edge.
    const Wide3<V> ab = b - a, ac = c - a, bc = c - b;
    const V longest = max(dot(ab, ab), max(dot(ac, ac), dot(bc, bc)));
    const auto small = longest < number<V>(1e6);
    const auto sure = area > number<V>(1e-6) * longest && small && area > number<V>(1e-18);
    const Wide3<V> ra = a - end1, rb = b - end1, rc = c - end1;
    const auto far = sphere_misses(terms, ra, rb, rc), cut = beyond_planes(terms, ra, rb, rc) > zero;
    const auto apart = far || (small && cut);
    const auto separate = sure && (above || below || beyond);
    put(terms.miss + i, select(apart || separate, one, zero));
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
