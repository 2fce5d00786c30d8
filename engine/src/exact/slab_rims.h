// Contacts of a slab of the palm with triangles that its faces cut, one source for every instruction set;
// slab.cpp does the same for one pair.
//
// The polygon is what the faces leave of the triangle; volume and centre are sums over triangles from one of
// its corners, as in slab_contacts.h. Polygons are as in round_polygon.h, but with any number of cuts, all of
// which may be another lane's: a set of directed edges, counter-clockwise, to which every cut appends one.
// Edges that are not there have no length.
#pragma once

#include "exact/round_polygon.h"
#include "exact/slab_contacts.h"

namespace lumbrical::LUMBRICAL_ISA {

// value + dot(slope, p).
template <class V>
struct Linear {
  V value;
  Wide2<V> slope;
};
template <class V>
inline V at(const Linear<V>& f, Wide2<V> p) {
  return f.value + dot(f.slope, p);
}

template <class V>
struct RimPolygon {
  static constexpr std::size_t kMost = 3 + RimTerms::kMostCuts;
  std::size_t count = 0;
  Edge<V> edge[kMost];
};

// Where f is zero on an edge with fp and fq at its ends, from the end that is nearer: the same point, to the
// last bit, whichever way the edge runs.
template <class V>
inline Wide2<V> zero_on(const Edge<V>& edge, V fp, V fq) {
  const V span = fp - fq;
  const auto nearer = abs(fp) < abs(fq);
  const V t = divide(select(nearer, fp, fq), select(span == number<V>(0), number<V>(1), span));
  return select(nearer, edge.p, edge.q) + t * (edge.q - edge.p);
}

// Removes the part where f > 0. Rounding may make a polygon concave whose corners are nearly on one line; one
// that leaves through the line twice is cut wrongly: then `bent` is 1.
template <class V>
void remove_above(const Linear<V>& f, RimPolygon<V>& polygon, V& bent) {
  const V zero = number<V>(0), one = number<V>(1);
  Edge<V> added{{zero, zero}, {zero, zero}};
  V left = zero;
  bool cut = false;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    Edge<V>& edge = polygon.edge[i];
    const V fp = at(f, edge.p), fq = at(f, edge.q);
    const auto p_out = fp > zero, q_out = fq > zero;
    if (!any(p_out || q_out)) continue;
    cut = true;
    const auto leaves = fp <= zero && q_out, enters = p_out && fq <= zero;
    const Wide2<V> x = zero_on(edge, fp, fq);
    bent = select(leaves && left > zero, one, bent);
    left = select(leaves, one, left);
    added = {select(leaves, x, added.p), select(enters, x, added.q)};
    // All of it beyond: nothing is left between q and q.
    edge = {select(p_out, select(q_out, edge.q, x), edge.p), select(leaves, x, edge.q)};
  }
  if (cut) polygon.edge[polygon.count++] = added;
}

// The plane of the triangle. The origin is its first corner; u runs along the longest edge, so that narrow
// triangles keep their width.
template <class V>
struct RimPlane {
  Wide3<V> origin, u, v, n;
};

template <class V>
RimPlane<V> look_at_triangle(Wide3<V> a, Wide3<V> ab, Wide3<V> ac, RimPolygon<V>& polygon) {
  const V zero = number<V>(0);
  const Wide3<V> bc = ac - ab, raw = cross(ab, ac);
  const V of_ab = dot(ab, ab), of_ac = dot(ac, ac), of_bc = dot(bc, bc);
  const V longest = max(of_ab, max(of_ac, of_bc));
  const Wide3<V> along = select(of_ab == longest, ab, select(of_ac == longest, ac, bc));
  RimPlane<V> plane{a, one_over(sqrt(longest)) * along, {}, one_over(sqrt(dot(raw, raw))) * raw};
  plane.v = cross(plane.n, plane.u);
  const Wide2<V> p{zero, zero}, q{dot(ab, plane.u), dot(ab, plane.v)}, r{dot(ac, plane.u), dot(ac, plane.v)};
  polygon.count = 3;
  polygon.edge[0] = {p, q};
  polygon.edge[1] = {q, r};
  polygon.edge[2] = {r, p};
  return plane;
}

// Height over a face, in the plane.
template <class V>
inline Linear<V> height_over(Wide3<V> normal, V offset, const RimPlane<V>& plane) {
  return {dot(normal, plane.origin) - offset, {dot(normal, plane.u), dot(normal, plane.v)}};
}

// Integrals over the polygon of 1 and f, and of p times them, p from `base`, a corner; and the most of f.
template <class V>
struct RimSums {
  V area, volume;
  Wide2<V> area_first, volume_first;
  V most;
};

template <class V>
RimSums<V> sums_over(const RimPolygon<V>& polygon, Wide2<V> base, const Linear<V>& f) {
  const V zero = number<V>(0), f_base = at(f, base);
  RimSums<V> sums{zero, zero, {zero, zero}, {zero, zero}, f_base};
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Wide2<V> p = polygon.edge[i].p - base, q = polygon.edge[i].q - base, both_ends = p + q;
    const V fp = at(f, polygon.edge[i].p), fq = at(f, polygon.edge[i].q);
    const V weight = cross(p, q), sum = weight * (f_base + fp + fq);
    sums.area = sums.area + weight;
    sums.area_first = sums.area_first + weight * both_ends;
    sums.volume = sums.volume + sum;
    sums.volume_first = sums.volume_first + sum * both_ends + (weight * fp) * p + (weight * fq) * q;
    sums.most = select(has_length(polygon.edge[i]), max(sums.most, fp), sums.most);
  }
  const V sixth = number<V>(1.0 / 6);
  return {number<V>(0.5) * sums.area, sixth * sums.volume, sixth * sums.area_first,
          (number<V>(0.25) * sixth) * sums.volume_first, sums.most};
}

template <class V>
void slab_rims(RimTerms& terms) {
  const V zero = number<V>(0);
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    RimPolygon<V> polygon;
    const RimPlane<V> plane = look_at_triangle(vector_at<V>(terms.a, i), vector_at<V>(terms.ab, i),
                                               vector_at<V>(terms.ac, i), polygon);
    V bent = zero;
    for (std::size_t k = 0; k < terms.cut_count; ++k) {
      const V offset = get(terms.cut_offset[k] + i, V{});
      remove_above(height_over(vector_at<V>(terms.cut_normal[k], i), offset, plane), polygon, bent);
    }
    const Wide2<V> base = corner_of(polygon);
    const Linear<V> over =
        height_over(in_all_lanes<V>(terms.faces->normal[0]), number<V>(terms.faces->offset[0]), plane);
    const Linear<V> field{zero - over.value, {zero - over.slope.x, zero - over.slope.y}};
    const RimSums<V> sums = sums_over(polygon, base, field);
    const auto in_space = [&](Wide2<V> p) { return plane.origin + p.x * plane.u + p.y * plane.v; };
    const Wide2<V> centroid = base + one_over(sums.area) * sums.area_first;
    const Wide2<V> pressed = base + one_over(sums.volume) * sums.volume_first;
    const V status = select(sums.area > zero, number<V>(kSlabTouched), number<V>(kSlabMissed));
    put(terms.status + i, select(bent > zero, number<V>(kSlabUnclear), status));
    put(terms.area + i, sums.area);
    put(terms.volume + i, max(zero, sums.volume));
    put(terms.depth + i, max(zero, sums.most));
    put_vector(plane.n, i, terms.normal);
    put_vector(in_space(centroid), i, terms.centroid);
    put_vector(in_space(select(sums.volume > zero, pressed, centroid)), i, terms.centre);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
