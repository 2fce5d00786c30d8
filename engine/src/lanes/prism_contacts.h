// Contacts of the palm with triangles that lie wholly inside it, one source for every instruction set. Most
// do: of those that don't, prism.cpp cuts the polygon.
//
// The depth below the palmar face is linear, so with its values f_i at the corners p_i
//   volume = area (f_1 + f_2 + f_3) / 3,   moment = area ((sum of f)(sum of p) + sum of f_i p_i) / 12.
#pragma once

#include "lanes/prism_terms.h"
#include "lanes/round_plane.h"

namespace lumbrical::LUMBRICAL_ISA {

// How far the corners lie over a face, and the way along -n to it.
template <class V>
struct FaceView {
  V over[3], way[3];
};

template <class V>
inline FaceView<V> look_at_face(const PrismTerms& terms, int face, const Wide3<V> (&corner)[3], Wide3<V> n) {
  const Wide3<V> outward = in_all_lanes<V>(terms.normal[face]);
  const V along = dot(outward, n), offset = number<V>(terms.offset[face]);
  const auto leaves = along < number<V>(-1e-12);  // otherwise going along -n never leaves through this face
  const V per = quotient(number<V>(1), choose(leaves, along, number<V>(-1)));
  FaceView<V> view;
  for (int i = 0; i < 3; ++i) {
    view.over[i] = dot(outward, corner[i]) - offset;
    view.way[i] = choose(leaves, view.over[i] * per, beyond<V>());
  }
  return view;
}

template <class V>
void prism_contacts(PrismTerms& terms) {
  const V zero = number<V>(0), one = number<V>(1), third = number<V>(1.0 / 3);
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    const Wide3<V> corner[3] = {vector_at<V>(terms.a, i), vector_at<V>(terms.b, i), vector_at<V>(terms.c, i)};
    const Wide3<V> ab = corner[1] - corner[0], ac = corner[2] - corner[0], bc = corner[2] - corner[1];
    const Wide3<V> raw = cross(ab, ac);
    const V twice = root(dot(raw, raw)), longest = greater(dot(ab, ab), greater(dot(ac, ac), dot(bc, bc)));
    const auto fine = both(twice > rounding<V>() * longest, twice > number<V>(1e-290));
    const Wide3<V> n = one_over(twice) * raw;
    V outermost = zero, least[3] = {beyond<V>(), beyond<V>(), beyond<V>()};
    for (int face = 0; face < terms.face_count; ++face) {
      const FaceView<V> view = look_at_face(terms, face, corner, n);
      for (int k = 0; k < 3; ++k) {
        outermost = greater(outermost, view.over[k]);
        least[k] = lesser(least[k], view.way[k]);
      }
    }
    const auto inside = both(fine, outermost <= zero);
    V simple = zero;
    if (some(inside)) {
      for (int face = 0; face < terms.face_count; ++face) {
        const FaceView<V> view = look_at_face(terms, face, corner, n);
        const auto first =
            both(view.way[0] == least[0], both(view.way[1] == least[1], view.way[2] == least[2]));
        simple = choose(both(inside, first), one, simple);
      }
    }
    const FaceView<V> palmar = look_at_face(terms, 0, corner, n);
    const V f[3] = {zero - palmar.over[0], zero - palmar.over[1], zero - palmar.over[2]};
    const V area = number<V>(0.5) * twice, sum = f[0] + f[1] + f[2];
    const Wide3<V> points = corner[0] + corner[1] + corner[2];
    const Wide3<V> weighted = f[0] * corner[0] + f[1] * corner[1] + f[2] * corner[2];
    const Wide3<V> centroid = third * points;
    const Wide3<V> centre = (number<V>(0.25) * one_over(sum)) * (sum * points + weighted);
    put(terms.simple + i, simple);
    put(terms.area + i, area);
    put(terms.volume + i, third * (area * sum));
    put(terms.depth + i, greater(zero, greater(least[0], greater(least[1], least[2]))));
    put_vector(n, i, terms.direction);
    put_vector(centroid, i, terms.centroid);
    put_vector(choose(sum > zero, centre, centroid), i, terms.centre);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
