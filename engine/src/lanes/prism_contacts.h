// Contacts of the palm with triangles that lie wholly inside it, one source for every instruction set. Most
// do; the others go on to prism_rim.h.
//
// The depth below the palmar face is linear, so with its values f_i at the corners p_i
//   volume = area (f_1 + f_2 + f_3) / 3,   moment = area ((sum of f)(sum of p) + sum of f_i p_i) / 12.
//
// The depth along -n is the least of the ways to the faces, each linear, so no point has more than any one
// face's most. Where that is what some corner has, it is the largest depth.
#pragma once

#include "lanes/prism_terms.h"
#include "lanes/round_plane.h"

namespace lumbrical::LUMBRICAL_ISA {

// A number of each corner.
template <class V>
struct Each {
  V a, b, c;
};
template <class V>
inline V least_of(const Each<V>& each) {
  return lesser(each.a, lesser(each.b, each.c));
}
template <class V>
inline V most_of(const Each<V>& each) {
  return greater(each.a, greater(each.b, each.c));
}

// Heights of the corners over the faces, and their ways along -n.
template <class V>
struct PalmView {
  Each<V> palmar;  // heights over the palmar face
  V beside;        // 1 where all corners are over one face
  V cut;           // bits of the faces that some corner is over
  V deepest;       // the largest depth at a corner
  V bound;         // no point is deeper
};

// Faces with a normal this near to the triangle's plane are no way out.
inline constexpr double kLeaves = -1e-12;

template <class V>
inline Each<V> heights_over(const PrismFaces& faces, int face, const Each<Wide3<V>>& corner) {
  const Wide3<V> outward = in_all_lanes<V>(faces.normal[face]);
  const V offset = number<V>(faces.offset[face]);
  return {dot(outward, corner.a) - offset, dot(outward, corner.b) - offset, dot(outward, corner.c) - offset};
}

template <class V>
inline PalmView<V> view_of(const PrismFaces& faces, const Each<Wide3<V>>& corner, Wide3<V> n) {
  const V zero = number<V>(0), one = number<V>(1), far = beyond<V>();
  V beside = zero, cut = zero, bound = far;
  Each<V> least{far, far, far};
  double bit = 1;
  for (int face = 0; face < faces.count; ++face, bit *= 2) {
    const Each<V> over = heights_over(faces, face, corner);
    const V lowest = least_of(over), highest = most_of(over);
    beside = choose(lowest > zero, one, beside);
    cut = cut + choose(highest > zero, number<V>(bit), zero);
    const V along = dot(in_all_lanes<V>(faces.normal[face]), n);
    const auto leaves = along < number<V>(kLeaves);
    if (!some(leaves)) continue;
    const V per = quotient(one, choose(leaves, along, zero - one));
    const auto way = [&](V height) { return choose(leaves, height * per, far); };
    bound = lesser(bound, way(lowest));
    least = {lesser(least.a, way(over.a)), lesser(least.b, way(over.b)), lesser(least.c, way(over.c))};
  }
  return {heights_over(faces, 0, corner), beside, cut, most_of(least), bound};
}

template <class V>
void prism_contacts(PrismTerms& terms) {
  const V zero = number<V>(0), third = number<V>(1.0 / 3);
  const V missed = number<V>(kPalmMissed), touched = number<V>(kPalmTouched), open = number<V>(kPalmOpen);
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    const Wide3<V> a = vector_at<V>(terms.a, i), ab = vector_at<V>(terms.ab, i),
                   ac = vector_at<V>(terms.ac, i);
    const Wide3<V> bc = ac - ab;
    const Each<Wide3<V>> corner{a, a + ab, a + ac};
    const Wide3<V> raw = cross(ab, ac);
    const V twice = root(dot(raw, raw)), longest = greater(dot(ab, ab), greater(dot(ac, ac), dot(bc, bc)));
    const auto fine =
        both(both(twice > rounding<V>() * longest, twice > number<V>(1e-290)), longest < number<V>(1e150));
    const Wide3<V> n = one_over(twice) * raw;
    const PalmView<V> view = view_of(terms.faces, corner, n);
    const Each<V> f{zero - view.palmar.a, zero - view.palmar.b, zero - view.palmar.c};
    const V area = number<V>(0.5) * twice, sum = f.a + f.b + f.c;
    const Wide3<V> points = corner.a + corner.b + corner.c;
    const Wide3<V> weighted = f.a * corner.a + f.b * corner.b + f.c * corner.c;
    const Wide3<V> centroid = third * points;
    const Wide3<V> centre = (number<V>(0.25) * one_over(sum)) * (sum * points + weighted);
    const auto whole = both(view.cut == zero, view.bound <= view.deepest);
    put(terms.status + i, choose(both(fine, view.beside == zero), choose(whole, touched, open), missed));
    put(terms.cut + i, view.cut);
    put(terms.area + i, area);
    put(terms.volume + i, third * (area * sum));
    put(terms.depth + i, choose(view.deepest < beyond<V>(), greater(zero, view.deepest), zero));
    put_vector(n, i, terms.normal);
    put_vector(centroid, i, terms.centroid);
    put_vector(choose(sum > zero, centre, centroid), i, terms.centre);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
