// Contacts of a slab of the palm with triangles that lie wholly inside it, one source for every instruction
// set. Most do; the others go on to slab_rims.h.
//
// The depth below the skin is linear, so with its values f_i at the corners p_i
//   volume = area (f_1 + f_2 + f_3) / 3,   moment = area ((sum of f)(sum of p) + sum of f_i p_i) / 12,
// and it is largest at a corner.
#pragma once

#include "exact/round_plane.h"
#include "exact/slab_terms.h"

namespace lumbrical::LUMBRICAL_ISA {

// A number of each corner.
template <class V>
struct Each {
  V a, b, c;
};
template <class V>
inline V least_of(const Each<V>& each) {
  return min(each.a, min(each.b, each.c));
}
template <class V>
inline V most_of(const Each<V>& each) {
  return max(each.a, max(each.b, each.c));
}

// Where the corners are.
template <class V>
struct SlabView {
  V beside;  // 1 where all corners are over one face
  V along;   // 1 where the triangle all but lies in one that the slab shares
  V cut;     // bits of the faces that some corner is over
};

template <class V>
inline Each<V> heights_over(const SlabFaces& faces, std::size_t face, const Each<Wide3<V>>& corner) {
  const Wide3<V> outward = in_all_lanes<V>(faces.normal[face]);
  const V offset = number<V>(faces.offset[face]);
  return {dot(outward, corner.a) - offset, dot(outward, corner.b) - offset, dot(outward, corner.c) - offset};
}

template <class V>
inline SlabView<V> view_of(const SlabFaces& faces, const Each<Wide3<V>>& corner) {
  const V zero = number<V>(0), one = number<V>(1), near = number<V>(faces.near);
  SlabView<V> view{zero, zero, zero};
  double bit = 1;
  for (std::size_t face = 0; face < faces.count; ++face, bit *= 2) {
    const Each<V> over = heights_over(faces, face, corner);
    const V lowest = least_of(over), highest = most_of(over);
    if (!any(highest >= zero - near)) continue;
    if (face > 0) view.along = select(highest <= near && lowest >= zero - near, one, view.along);
    view.beside = select(lowest > near, one, view.beside);
    view.cut = view.cut + select(highest > zero, number<V>(bit), zero);
  }
  return view;
}

template <class V>
void slab_contacts(SlabTerms& terms) {
  const V zero = number<V>(0), third = number<V>(1.0 / 3);
  const V missed = number<V>(kSlabMissed), touched = number<V>(kSlabTouched), cut = number<V>(kSlabCut),
          unclear = number<V>(kSlabUnclear);
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    const Wide3<V> a = vector_at<V>(terms.a, i), ab = vector_at<V>(terms.ab, i),
                   ac = vector_at<V>(terms.ac, i);
    const Wide3<V> bc = ac - ab;
    const Each<Wide3<V>> corner{a, a + ab, a + ac};
    const Wide3<V> raw = cross(ab, ac);
    const V twice = sqrt(dot(raw, raw)), longest = max(dot(ab, ab), max(dot(ac, ac), dot(bc, bc)));
    const auto fine = has_normal(twice, longest);
    const Wide3<V> n = one_over(twice) * raw;
    const SlabView<V> view = view_of(terms.faces, corner);
    const Each<V> over = heights_over(terms.faces, 0, corner);
    const Each<V> f{zero - over.a, zero - over.b, zero - over.c};
    const V area = number<V>(0.5) * twice, sum = f.a + f.b + f.c;
    const Wide3<V> points = corner.a + corner.b + corner.c;
    const Wide3<V> weighted = f.a * corner.a + f.b * corner.b + f.c * corner.c;
    const Wide3<V> centroid = third * points;
    const Wide3<V> centre = (number<V>(0.25) * one_over(sum)) * (sum * points + weighted);
    const auto whole = view.cut == zero;
    const V status = select(view.along > zero, unclear, select(whole, touched, cut));
    put(terms.status + i, select(fine && view.beside == zero, status, missed));
    put(terms.cut + i, view.cut);
    put(terms.area + i, area);
    put(terms.volume + i, max(zero, third * (area * sum)));
    put(terms.depth + i, max(zero, most_of(f)));
    put_vector(n, i, terms.normal);
    put_vector(centroid, i, terms.centroid);
    put_vector(select(sum > zero, centre, centroid), i, terms.centre);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
