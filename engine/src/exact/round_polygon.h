// Convex polygons, one per lane: a triangle, cut by half-planes and parted at lines x = const. A polygon is a
// set of directed edges, counter-clockwise; those that are not there have no length. Edges keep the order of
// the triangle's, and each cut appends one.
#pragma once

#include "exact/round_plane.h"
#include "model/primitive.h"

namespace lumbrical::LUMBRICAL_ISA {

template <class V>
struct Edge {
  Wide2<V> p, q;
};

template <class V>
struct Polygon {
  static constexpr std::size_t kMost = 3 + RoundTerms::kMostCuts + 2;  // and two borders
  std::size_t count = 0;
  Edge<V> edge[kMost];
};

template <class V>
inline auto has_length(const Edge<V>& edge) {
  return edge.p.x != edge.q.x || edge.p.y != edge.q.y;
}

// A corner that is there: of an edge beyond a cut what is left may be far away, and brings its rounding.
template <class AnyPolygon>
inline auto corner_of(const AnyPolygon& polygon) {
  auto corner = polygon.edge[0].p;
  for (std::size_t i = polygon.count; i-- > 0;)
    corner = select(has_length(polygon.edge[i]), polygon.edge[i].p, corner);
  return corner;
}

// Unit directions of a polygon's edges.
template <class V>
struct Directions {
  Wide2<V> t[Polygon<V>::kMost];
};
template <class V>
Directions<V> directions_of(const Polygon<V>& polygon) {
  Directions<V> directions;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Wide2<V> d = polygon.edge[i].q - polygon.edge[i].p;
    directions.t[i] = d;
    if (any(has_length(polygon.edge[i]))) directions.t[i] = one_over(sqrt(dot(d, d))) * d;
  }
  return directions;
}

// Of the edges from number `first` on, which a polygon was parted along: they run up or down.
template <class V>
void set_upright(const Polygon<V>& polygon, std::size_t first, Directions<V>& directions) {
  const V zero = number<V>(0), one = number<V>(1);
  for (std::size_t i = first; i < polygon.count; ++i) {
    const V rise = polygon.edge[i].q.y - polygon.edge[i].p.y;
    directions.t[i] = {zero, select(rise < zero, zero - one, one)};
  }
}

// Where a value that is fp at p and fq at q is zero; from the end nearer to the origin, for a far one would
// bring its own rounding along.
template <class V>
struct Crossing {
  V t, back;  // from p to q, and from q, negative
  Wide2<V> point;
};
template <class V>
inline Crossing<V> crossing_of(const Edge<V>& edge, V fp, V fq) {
  const V one = number<V>(1), span = fp - fq;
  const V per = divide(one, select(span == number<V>(0), one, span));
  const auto nearer = dot(edge.p, edge.p) < dot(edge.q, edge.q);
  const V t = fp * per, back = fq * per;
  const Wide2<V> d = edge.q - edge.p;
  return {t, back, select(nearer, edge.p + t * d, edge.q + back * d)};
}

// How far the corners lie beyond the primitive's cuts, at both ends of every edge.
template <class V>
struct Excess {
  static constexpr int kMostCuts = RoundTerms::kMostCuts;
  V p[kMostCuts], q[kMostCuts];
};

// Removes what lies beyond cut number `cut`. Crossings take the excess over the cuts still to come along,
// from the end that is nearer to this cut: where a corner lies in several cuts to rounding, each of its
// crossings is to be on the same side of the next cut as the corner, or the polygon would leave through that
// one twice.
template <class V>
void remove_beyond(int cut, int cut_count, Polygon<V>& polygon, Excess<V> (&excess)[Polygon<V>::kMost]) {
  const V zero = number<V>(0);
  Edge<V> added{{zero, zero}, {zero, zero}};
  Excess<V> along;
  for (int later = cut + 1; later < cut_count; ++later) along.p[later] = along.q[later] = zero;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    Edge<V>& edge = polygon.edge[i];
    Excess<V>& f = excess[i];
    const auto p_out = f.p[cut] > zero, q_out = f.q[cut] > zero;
    if (!any(p_out || q_out)) continue;
    const auto p_in = f.p[cut] <= zero, q_in = f.q[cut] <= zero;
    const Crossing<V> x = crossing_of(edge, f.p[cut], f.q[cut]);
    const auto p_nearer = abs(f.p[cut]) < abs(f.q[cut]);
    const auto leaves = p_in && q_out, enters = p_out && q_in;
    added = {select(leaves, x.point, added.p), select(enters, x.point, added.q)};
    // All of it beyond: nothing is left between q and q.
    const Wide2<V> p = edge.p;
    edge.p = select(p_out, select(q_out, edge.q, x.point), p);
    edge.q = select(leaves, x.point, edge.q);
    for (int later = cut + 1; later < cut_count; ++later) {
      V &fp = f.p[later], &fq = f.q[later];
      const V at = select(p_nearer, fp + x.t * (fq - fp), fq + x.back * (fq - fp));
      along.p[later] = select(leaves, at, along.p[later]);
      along.q[later] = select(enters, at, along.q[later]);
      fp = select(p_out, select(q_out, fq, at), fp);
      fq = select(leaves, at, fq);
    }
  }
  polygon.edge[polygon.count] = added;
  excess[polygon.count++] = along;
}

// The triangle in the plane's coordinates, without what lies beyond the primitive's cuts. Returns 1 where it
// all but lies in one of them, so that another way has to be taken.
template <class V>
V set_polygon(const RoundTerms& terms, const RoundPart<V>& part, const RoundPlane<V>& plane,
              const Wide3<V> (&corner)[3], std::size_t lane, Polygon<V>& polygon) {
  Wide2<V> flat[3];
  for (int i = 0; i < 3; ++i) flat[i] = {dot(corner[i], plane.u), dot(corner[i], plane.v)};
  polygon.count = 3;
  for (std::size_t i = 0; i < 3; ++i) polygon.edge[i] = {flat[i], flat[(i + 1) % 3]};
  const V zero = number<V>(0), one = number<V>(1), near = number<V>(kAlongCut) * part.radius1;
  V along = zero;
  if (terms.cut_count == 0) return along;
  Excess<V> excess[Polygon<V>::kMost];
  int crossing = 0;  // cuts that some lane has anything beyond
  for (int cut = 0; cut < terms.cut_count; ++cut) {
    V f[3];
    const Wide3<V> normal = vector_at<V>(terms.cut_normal[cut], lane);
    const V offset = get(terms.cut_offset[cut] + lane, V{});
    for (int i = 0; i < 3; ++i) f[i] = dot(normal, corner[i]) - offset;
    const auto cuts = dot(normal, normal) > zero;
    along = select(cuts && max(abs(f[0]), max(abs(f[1]), abs(f[2]))) <= near, one, along);
    const auto crosses = f[0] > zero || f[1] > zero || f[2] > zero;
    if (!any(crosses)) continue;
    // All of a triangle that the cut misses is kept, whatever rounding does along its edges: its register may
    // or may not come here.
    for (V& value : f) value = select(crosses, value, number<V>(-1));
    for (std::size_t i = 0; i < 3; ++i) {
      excess[i].p[crossing] = f[i];
      excess[i].q[crossing] = f[(i + 1) % 3];
    }
    ++crossing;
  }
  for (int cut = 0; cut < crossing; ++cut) remove_beyond(cut, crossing, polygon, excess);
  return along;
}

// Parts a polygon at x = border. Corners no farther above it than this share of R are below: of an edge along
// the border rounding must not make one that crosses it twice, and beyond a border a zone's field is wrong in
// second order only.
inline constexpr double kOnBorder = 256;  // times rounding

template <class V>
inline V above_border(V border, V radius) {
  return border + number<V>(kOnBorder) * rounding<V>() * radius;
}

template <class V>
void part_at(V border, V radius, const Polygon<V>& polygon, Polygon<V>& below, Polygon<V>& above) {
  const V zero = number<V>(0), above_it = above_border(border, radius);
  Edge<V> added{{border, zero}, {border, zero}};  // of the part below
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Edge<V>& edge = polygon.edge[i];
    const auto p_above = edge.p.x > above_it, q_above = edge.q.x > above_it;
    const auto leaves = edge.p.x <= above_it && q_above, enters = p_above && edge.q.x <= above_it;
    Wide2<V> x = edge.p;
    if (any(leaves || enters)) {
      // A corner that counts as below may be above by rounding: then the edge crosses in it, not before it.
      const V fp = edge.p.x - border, fq = edge.q.x - border;
      x = crossing_of(edge, select(p_above, fp, min(fp, zero)), select(q_above, fq, min(fq, zero))).point;
      x.x = border;
      added = {select(leaves, x, added.p), select(enters, x, added.q)};
    }
    below.edge[i] = {select(p_above, select(q_above, edge.q, x), edge.p), select(leaves, x, edge.q)};
    above.edge[i] = {select(p_above, edge.p, select(q_above, x, edge.q)), select(enters, x, edge.q)};
  }
  below.edge[polygon.count] = added;
  above.edge[polygon.count] = {added.q, added.p};
  below.count = above.count = polygon.count + 1;
}

}  // namespace lumbrical::LUMBRICAL_ISA
