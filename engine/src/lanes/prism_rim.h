// Contacts of the palm with triangles that its faces cut or that it is left from through several faces, one
// source for every instruction set; prism.cpp does the same for one pair.
//
// The polygon is what the faces leave of the triangle; volume and centre are sums over triangles from one of
// its corners, as in prism_contacts.h. The largest depth is the greatest t such that t <= d_k(p), d_k the way
// from p to face k: where no corner has it, faces are added one by one. A face that the best point of those
// before obeys changes nothing; otherwise the best point is on that face's part of the polygon (Seidel 1991,
// "Small-dimensional linear programming and convex hulls made easy").
#pragma once

#include "lanes/prism_contacts.h"
#include "lanes/prism_polygon.h"

namespace lumbrical::LUMBRICAL_ISA {

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
  const V longest = greater(of_ab, greater(of_ac, of_bc));
  const Wide3<V> along = choose(of_ab == longest, ab, choose(of_ac == longest, ac, bc));
  RimPlane<V> plane{a, one_over(root(longest)) * along, {}, one_over(root(dot(raw, raw))) * raw};
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

// Integrals over the polygon of 1 and f, and of p times them; p from `base`, a corner.
template <class V>
struct RimSums {
  V area, volume;
  Wide2<V> area_first, volume_first;
};

template <class V>
RimSums<V> sums_over(const RimPolygon<V>& polygon, Wide2<V> base, const Linear<V>& f) {
  const V zero = number<V>(0), f_base = at(f, base);
  RimSums<V> sums{zero, zero, {zero, zero}, {zero, zero}};
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Wide2<V> p = polygon.edge[i].p - base, q = polygon.edge[i].q - base, both_ends = p + q;
    const V fp = at(f, polygon.edge[i].p), fq = at(f, polygon.edge[i].q);
    const V weight = cross(p, q), sum = weight * (f_base + fp + fq);
    sums.area = sums.area + weight;
    sums.area_first = sums.area_first + weight * both_ends;
    sums.volume = sums.volume + sum;
    sums.volume_first = sums.volume_first + sum * both_ends + (weight * fp) * p + (weight * fq) * q;
  }
  const V sixth = number<V>(1.0 / 6);
  return {number<V>(0.5) * sums.area, sixth * sums.volume, sixth * sums.area_first,
          (number<V>(0.25) * sixth) * sums.volume_first};
}

// The ways along -n to the faces; `beyond` in lanes where a face is no way out.
template <class V>
struct WaysOut {
  int count = 0;
  Linear<V> way[Prism::kMaxFaces];
};

template <class V>
void ways_out(const PrismFaces& faces, const RimPlane<V>& plane, WaysOut<V>& out) {
  const V zero = number<V>(0), one = number<V>(1);
  for (int face = 0; face < faces.count; ++face) {
    const Wide3<V> outward = in_all_lanes<V>(faces.normal[face]);
    const V along = dot(outward, plane.n);
    const auto leaves = along < number<V>(kLeaves);
    if (!some(leaves)) continue;
    const V per = quotient(one, choose(leaves, along, zero - one));
    const Linear<V> height = height_over(outward, number<V>(faces.offset[face]), plane);
    const Wide2<V> flat{zero, zero};
    out.way[out.count++] = {choose(leaves, per * height.value, beyond<V>()),
                            choose(leaves, per * height.slope, flat)};
  }
}

// A point, and how deep it is.
template <class V>
struct Deep {
  V depth;
  Wide2<V> point;
};

template <class V, class M>
inline Deep<V> choose(M which, const Deep<V>& yes, const Deep<V>& no) {
  return {choose(which, yes.depth, no.depth), choose(which, yes.point, no.point)};
}

// Where f is largest on the polygon; -beyond where nothing is left of it.
template <class V>
Deep<V> most_on(const RimPolygon<V>& polygon, const Linear<V>& f) {
  Deep<V> most{number<V>(0) - beyond<V>(), {number<V>(0), number<V>(0)}};
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Edge<V>& edge = polygon.edge[i];
    const V value = at(f, edge.p);
    most = choose(both(has_length(edge), value > most.depth), Deep<V>{value, edge.p}, most);
  }
  return most;
}

// The same where `excess` is not above zero.
template <class V>
Deep<V> most_on_part(const RimPolygon<V>& polygon, const Linear<V>& excess, const Linear<V>& f) {
  const V zero = number<V>(0);
  Deep<V> most{zero - beyond<V>(), {zero, zero}};
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Edge<V>& edge = polygon.edge[i];
    const V fp = at(excess, edge.p), fq = at(excess, edge.q), at_p = at(f, edge.p);
    const auto p_in = fp <= zero, q_in = fq <= zero;
    most = choose(both(both(has_length(edge), p_in), at_p > most.depth), Deep<V>{at_p, edge.p}, most);
    const auto crosses = either(both(p_in, fq > zero), both(fp > zero, q_in));
    if (!some(crosses)) continue;
    const Wide2<V> x = zero_on(edge, fp, fq);
    const V at_x = at(f, x);
    most = choose(both(crosses, at_x > most.depth), Deep<V>{at_x, x}, most);
  }
  return most;
}

// Where way i is the way out among `start` and those before it, and how deep it is there at most, in the
// lanes that are wanted. Mostly `start` is all that is in the way.
template <class V, class M>
Deep<V> most_through(const RimPolygon<V>& polygon, const WaysOut<V>& out, int i, const Linear<V>& start,
                     M wanted, V& lost) {
  const V zero = number<V>(0), one = number<V>(1);
  const Linear<V>& own = out.way[i];
  Deep<V> most = most_on_part(polygon, own - start, own);
  V blocked = zero, bent = zero;
  for (int before = 0; before < i; ++before)
    blocked = choose(at(out.way[before], most.point) < most.depth, one, blocked);
  const auto cut = both(wanted, blocked > zero);
  if (some(cut)) {
    RimPolygon<V> part;
    copy(polygon, part);
    const auto keep_below = [&](const Linear<V>& other) {
      const Linear<V> excess = own - other;
      const Wide2<V> flat{zero, zero};
      remove_above<V>({choose(cut, excess.value, zero), choose(cut, excess.slope, flat)}, part, bent);
    };
    keep_below(start);
    for (int before = 0; before < i; ++before) keep_below(out.way[before]);
    most = choose(cut, most_on(part, own), most);
  }
  lost = choose(both(wanted, either(bent > zero, most.depth <= zero - beyond<V>())), one, lost);
  return most;
}

// In lanes that are open, with the way out that has the least most, `start`, and where it is `best`; `lost`
// is 1 where rounding leaves nothing of a part.
template <class V, class M>
V depth_within(const RimPolygon<V>& polygon, const WaysOut<V>& out, const Linear<V>& start, Deep<V> best,
               M open, V& lost) {
  for (int i = 0; i < out.count; ++i) {
    const auto beaten = both(open, at(out.way[i], best.point) < best.depth);
    if (some(beaten)) best = choose(beaten, most_through(polygon, out, i, start, beaten, lost), best);
  }
  return best.depth;
}

template <class V, class M>
V rim_depth(const PrismFaces& faces, const RimPlane<V>& plane, const RimPolygon<V>& polygon, Wide2<V> base,
            M wanted, V& lost) {
  const V zero = number<V>(0);
  WaysOut<V> out;
  ways_out(faces, plane, out);
  V least[3 + RimTerms::kMostCuts];  // at the corners; what is none counts as the base
  Wide2<V> corner[3 + RimTerms::kMostCuts];
  for (std::size_t i = 0; i < polygon.count; ++i) {
    corner[i] = choose(has_length(polygon.edge[i]), polygon.edge[i].p, base);
    least[i] = beyond<V>();
  }
  Linear<V> start{beyond<V>(), {zero, zero}};
  Deep<V> bound{beyond<V>(), base};
  for (int k = 0; k < out.count; ++k) {
    Deep<V> most{zero - beyond<V>(), base};
    for (std::size_t i = 0; i < polygon.count; ++i) {
      const V way = at(out.way[k], corner[i]);
      const auto more = way > most.depth;
      least[i] = lesser(least[i], way);
      most = choose(more, Deep<V>{way, corner[i]}, most);
    }
    const auto less = most.depth < bound.depth;
    bound = choose(less, most, bound);
    start = {choose(less, out.way[k].value, start.value), choose(less, out.way[k].slope, start.slope)};
  }
  V deepest = zero;
  for (std::size_t i = 0; i < polygon.count; ++i)
    deepest = greater(deepest, choose(least[i] < beyond<V>(), least[i], zero));
  const auto open = both(wanted, both(bound.depth > deepest, bound.depth < beyond<V>()));
  if (!some(open)) return deepest;
  return choose(open, greater(zero, depth_within(polygon, out, start, bound, open, lost)), deepest);
}

template <class V>
void prism_rims(RimTerms& terms) {
  const V zero = number<V>(0);
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    RimPolygon<V> polygon;
    const RimPlane<V> plane = look_at_triangle(vector_at<V>(terms.a, i), vector_at<V>(terms.ab, i),
                                               vector_at<V>(terms.ac, i), polygon);
    V bent = zero, lost = zero;
    const std::size_t cuts = terms.cut_count[i + wide::Lanes<V>::kCount - 1];
    for (std::size_t k = 0; k < cuts; ++k) {
      const V offset = get(terms.cut_offset[k] + i, V{});
      remove_above(height_over(vector_at<V>(terms.cut_normal[k], i), offset, plane), polygon, bent);
    }
    Wide2<V> base = polygon.edge[0].p;
    for (std::size_t k = polygon.count; k-- > 0;)
      base = choose(has_length(polygon.edge[k]), polygon.edge[k].p, base);
    const Linear<V> over =
        height_over(in_all_lanes<V>(terms.faces->normal[0]), number<V>(terms.faces->offset[0]), plane);
    const Linear<V> field{zero - over.value, {zero - over.slope.x, zero - over.slope.y}};
    const RimSums<V> sums = sums_over(polygon, base, field);
    const auto touched = sums.area > zero;
    const V depth = rim_depth(*terms.faces, plane, polygon, base, touched, lost);
    const auto in_space = [&](Wide2<V> p) { return plane.origin + p.x * plane.u + p.y * plane.v; };
    const Wide2<V> centroid = base + one_over(sums.area) * sums.area_first;
    const Wide2<V> pressed = base + one_over(sums.volume) * sums.volume_first;
    const V status = choose(touched, number<V>(kPalmTouched), number<V>(kPalmMissed));
    put(terms.status + i, choose(either(bent > zero, lost > zero), number<V>(kPalmOpen), status));
    put(terms.area + i, sums.area);
    put(terms.volume + i, greater(zero, sums.volume));
    put(terms.depth + i, depth);
    put_vector(plane.n, i, terms.normal);
    put_vector(in_space(centroid), i, terms.centroid);
    put_vector(in_space(choose(sums.volume > zero, pressed, centroid)), i, terms.centre);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
