// Convex polygons cut by lines, for the palm; as in round_polygon.h, but any number of cuts, all of which may
// be another lane's: a set of directed edges, counter-clockwise, to which every cut appends one. Edges that
// are not there have no length.
#pragma once

#include "lanes/prism_terms.h"
#include "lanes/round_polygon.h"

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
inline Linear<V> operator-(const Linear<V>& f, const Linear<V>& g) {
  return {f.value - g.value, f.slope - g.slope};
}

template <class V>
struct RimPolygon {
  // Three, the cuts, and those between the ways out.
  static constexpr std::size_t kMost = 3 + RimTerms::kMostCuts + Prism::kMaxFaces;
  std::size_t count = 0;
  Edge<V> edge[kMost];
};

template <class V>
inline void copy(const RimPolygon<V>& from, RimPolygon<V>& to) {
  to.count = from.count;
  for (std::size_t i = 0; i < from.count; ++i) to.edge[i] = from.edge[i];
}

// Where f is zero on an edge with fp and fq at its ends, from the end that is nearer: the same point, to the
// last bit, whichever way the edge runs.
template <class V>
inline Wide2<V> zero_on(const Edge<V>& edge, V fp, V fq) {
  const V span = fp - fq;
  const auto nearer = magnitude(fp) < magnitude(fq);
  const V t = quotient(choose(nearer, fp, fq), choose(span == number<V>(0), number<V>(1), span));
  return choose(nearer, edge.p, edge.q) + t * (edge.q - edge.p);
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
    if (!some(either(p_out, q_out))) continue;
    cut = true;
    const auto leaves = both(fp <= zero, q_out), enters = both(p_out, fq <= zero);
    const Wide2<V> x = zero_on(edge, fp, fq);
    bent = choose(both(leaves, left > zero), one, bent);
    left = choose(leaves, one, left);
    added = {choose(leaves, x, added.p), choose(enters, x, added.q)};
    // All of it beyond: nothing is left between q and q.
    edge = {choose(p_out, choose(q_out, edge.q, x), edge.p), choose(leaves, x, edge.q)};
  }
  if (cut) polygon.edge[polygon.count++] = added;
}

}  // namespace lumbrical::LUMBRICAL_ISA
