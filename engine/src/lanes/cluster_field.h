// The field at the centre of a cluster and how far it can differ over the cluster, in lanes: shared by the
// search for clusters and their sums, one source for every instruction set and both precisions.
#pragma once

#include "lanes/cluster_terms.h"
#include "lanes/wide_geometry.h"

namespace lumbrical::LUMBRICAL_ISA {

// A FieldShape, the same in all lanes.
template <class V>
struct WideShape {
  bool flat;
  Wide3<V> axis;
  V length, radius1, radius2, sine, cosine, jointed;
  Wide3<V> face;
  V height;
};

template <class V>
inline WideShape<V> in_all_lanes(const FieldShape<NumberOf<V>>& shape) {
  return {shape.flat,
          in_all_lanes<V>(shape.axis),
          V(shape.length),
          V(shape.radius1),
          V(shape.radius2),
          V(shape.sine),
          V(shape.cosine),
          V(shape.jointed),
          in_all_lanes<V>(shape.face),
          V(shape.face[3])};
}

// phi ~ phi0 - out h - bend / 2 (|h|^2 - (across h)^2 - side (axis h)^2), h counted from the centre.
template <class V>
struct CentreField {
  V phi;               // [m]
  Wide3<V> out;        // unit: phi falls in this direction
  Wide3<V> across;     // unit: away from the axis, or from the end's centre
  V bend;              // [1/m]
  V side;              // 1 beside the axis, 0 where an end is nearest
  V distance;          // [m] from the axis, at most
  V margin1, margin2;  // [m] from where the nearest sphere changes to an end
};

template <class V>
CentreField<V> round_field_at(const WideShape<V>& shape, Wide3<V> p) {
  const V zero = number<V>(0), one = number<V>(1);
  const V z = dot(p, shape.axis);
  const Wide3<V> off = p - z * shape.axis, from2 = p - shape.length * shape.axis;
  const V rho = root(dot(off, off)), d1 = root(dot(p, p)), d2 = root(dot(from2, from2));
  const V first = shape.cosine * z - shape.sine * rho, second = first - shape.cosine * shape.length;
  const auto at_end1 = either(first < zero, shape.jointed == zero);
  const auto beside = both(first >= zero, both(second <= zero, shape.jointed > zero));
  const V d = choose(beside, rho, choose(at_end1, d1, d2));
  const V per = one_over(d);
  CentreField<V> at;
  at.across = per * choose(beside, off, choose(at_end1, p, from2));
  at.side = choose(beside, one, zero);
  at.out = choose(beside, shape.cosine * at.across + shape.sine * shape.axis, at.across);
  at.phi = choose(beside, shape.radius1 - shape.sine * z - shape.cosine * rho,
                  choose(at_end1, shape.radius1 - d1, shape.radius2 - d2));
  at.bend = choose(beside, shape.cosine * per, per);
  const V ahead = z - between(z, zero, shape.length);
  at.distance = choose(beside, rho, root(rho * rho + ahead * ahead));
  at.margin1 = magnitude(first);
  at.margin2 = magnitude(second);
  return at;
}

// p from the larger end; a slab's field is the depth below its skin.
template <class V>
CentreField<V> field_at(const WideShape<V>& shape, Wide3<V> p) {
  if (!shape.flat) return round_field_at(shape, p);
  const V zero = number<V>(0), far = number<V>(1e30);
  return {shape.height - dot(shape.face, p), shape.face, {zero, zero, zero}, zero, zero, far, far, far};
}

/// How far beyond a cut (CutShape) the points are.
template <class V>
inline V beyond(const CutShape<NumberOf<V>>& cut, Wide3<V> p) {
  const V height = dot(in_all_lanes<V>(cut.normal), p) - V(cut.height);
  if (cut.bow == 0) return height;
  const V x = dot(in_all_lanes<V>(cut.x), p) - V(cut.x[3]), y = dot(in_all_lanes<V>(cut.y), p) - V(cut.y[3]);
  return height + V(cut.bow) * root(x * x + y * y);
}

template <class V>
struct ClusterBounds {
  V rise;  // [m] phi is above its value at the centre by no more
  V fall;  // [m] and below it by no more
  V rest;  // [m] it differs by no more from its second-order form; large where the cluster is too wide
  V gap;   // [m] no corner is nearer to the axis
};

// Where the corners of a cluster are, seen from its centre.
template <class V>
struct ClusterReach {
  V radius;
  Wide3<V> normal;
  V thickness;
  Wide3<V> box;
};

template <class V>
ClusterBounds<V> bounds_of(const CentreField<V>& at, V jointed, const ClusterReach<V>& reach) {
  const V zero = number<V>(0), one = number<V>(1), half = number<V>(0.5);
  const V radius = reach.radius;
  const auto narrow = radius <= number<V>(kWidest) * at.distance;
  const V gap = choose(narrow, at.distance - radius, one), per = one_over(gap);
  const V beyond1 = greater(radius - at.margin1, zero), beyond2 = greater(radius - at.margin2, zero);
  const V bent = radius * radius * per;
  const V rest = number<V>(kTaylorRest) * (radius * (bent * per)) +
                 jointed * ((beyond1 * beyond1 + beyond2 * beyond2) * per);
  const V slope = dot(at.out, reach.normal);
  // What rounding leaves of a slope of nothing is made up for.
  const V along = root(greater(one - slope * slope, zero) + number<V>(1e-6));
  const Wide3<V> level = at.out - slope * reach.normal;  // what is left of it in the cluster's plane
  const V in_box =
      magnitude(level.x) * reach.box.x + magnitude(level.y) * reach.box.y + magnitude(level.z) * reach.box.z;
  const V rise = lesser(lesser(radius * along, in_box) + reach.thickness * magnitude(slope), radius);
  // phi is concave: its bend only lowers it.
  const V fall = lesser(rise + half * bent, radius);
  return {choose(narrow, rise, radius), choose(narrow, fall, radius), choose(narrow, rest, number<V>(1e30)),
          gap};
}

}  // namespace lumbrical::LUMBRICAL_ISA
