// The contact of a whole cluster from its moments, one source for every instruction set; a lane is a cluster.
//
// The field is replaced by its second-order form about the cluster's centre, and where the finger's surface
// runs through the cluster its positive part by a linear function of that: docs/mechanics.md, "Clusters".
#pragma once

#include "lanes/cluster_field.h"

namespace lumbrical::LUMBRICAL_ISA {

// Force and its moment about the cluster's centre, over K_s.
template <class V>
struct Wrench {
  Wide3<V> force, couple;
};

// Sum of e_j x w_j: the moment of pressures w along x, y and z.
template <class V>
inline Wide3<V> moment_of(Wide3<V> wx, Wide3<V> wy, Wide3<V> wz) {
  return {wy.z - wz.y, wz.x - wx.z, wx.y - wy.x};
}

template <class V>
struct Surface {
  Wide3<V> normal, first[3];
  Wide3<V> xx, xy, xz, yy, yz, zz;  // second moments
};

template <class V>
Surface<V> surface_at(const ClusterTerms& terms, std::size_t i) {
  const auto& q = terms.second;
  return {vector_at<V>(terms.normal, i),
          {vector_at<V>(terms.first[0], i), vector_at<V>(terms.first[1], i), vector_at<V>(terms.first[2], i)},
          vector_at<V>(q[0], i),
          vector_at<V>(q[1], i),
          vector_at<V>(q[2], i),
          vector_at<V>(q[3], i),
          vector_at<V>(q[4], i),
          vector_at<V>(q[5], i)};
}

// Integrals of the second-order form.
template <class V>
Wrench<V> integrate_form(const CentreField<V>& at, Wide3<V> axis, const Surface<V>& s, Wide3<V>& spread) {
  const V zero = number<V>(0), one = number<V>(1), two = number<V>(2), half = number<V>(0.5);
  const Wide3<V> g{zero - at.out.x, zero - at.out.y, zero - at.out.z};
  const Wide3<V> gx = g.x * s.xx + g.y * s.xy + g.z * s.xz, gy = g.x * s.xy + g.y * s.yy + g.z * s.yz,
                 gz = g.x * s.xz + g.y * s.yz + g.z * s.zz;
  spread = g.x * gx + g.y * gy + g.z * gz;
  const Wide3<V> e = at.across;
  const auto curved = [&](V ej, V ek, V aj, V ak, V same) { return same - ej * ek - at.side * (aj * ak); };
  const Wide3<V> bent =
      curved(e.x, e.x, axis.x, axis.x, one) * s.xx + curved(e.y, e.y, axis.y, axis.y, one) * s.yy +
      curved(e.z, e.z, axis.z, axis.z, one) * s.zz +
      two * (curved(e.x, e.y, axis.x, axis.y, zero) * s.xy + curved(e.x, e.z, axis.x, axis.z, zero) * s.xz +
             curved(e.y, e.z, axis.y, axis.z, zero) * s.yz);
  const Wide3<V> force =
      at.phi * s.normal + (g.x * s.first[0] + g.y * s.first[1] + g.z * s.first[2]) - (half * at.bend) * bent;
  return {force, moment_of(at.phi * s.first[0] + gx, at.phi * s.first[1] + gy, at.phi * s.first[2] + gz)};
}

// phi's positive part as level + share phi, for phi spread evenly over `half` to either side of phi0.
template <class V>
struct Ramp {
  V level, share;
  V error;  // [m] at most, as long as phi is between phi0 - fall and phi0 + rise
};

template <class V>
Ramp<V> ramp_of(V phi, V half, V rise, V fall) {
  const V zero = number<V>(0), one = number<V>(1);
  const V share = between(quotient(phi + half, half + half), zero, one);
  const auto through = both(phi<half, phi> zero - half);
  const V level = choose(through, quotient((half - phi) * (half + phi), number<V>(4) * half), zero);
  const V low = phi - fall, high = phi + rise;
  const V at_low = magnitude(greater(low, zero) - level - share * low),
          at_high = magnitude(greater(high, zero) - level - share * high);
  const V between_them = choose(both(low<zero, high> zero), level, zero);
  return {level, share, greater(greater(at_low, at_high), between_them)};
}

// Writes the wrench as one force: along a line beside the centre, no farther off than the radius. Returns the
// part of the couple that it cannot carry.
template <class V>
V put_force(const Wrench<V>& wrench, Wide3<V> centre, V radius, std::size_t i, ClusterTerms& terms) {
  const V zero = number<V>(0), one = number<V>(1);
  const V square = dot(wrench.force, wrench.force), volume = root(square);
  const auto some_force = volume > zero;
  const V per = quotient(one, choose(some_force, volume, one));
  const Wide3<V> along = choose(some_force, per * wrench.force, Wide3<V>{zero, zero, one});
  const Wide3<V> aside = per * cross(along, wrench.couple);
  const V way = root(dot(aside, aside));
  const V kept = choose(way > radius, quotient(radius, choose(way > zero, way, one)), one);
  const Wide3<V> shift = choose(some_force, kept * aside, Wide3<V>{zero, zero, zero});
  put(terms.volume + i, volume);
  put_vector(along, i, terms.direction);
  put_vector(centre + shift, i, terms.acting);
  const Wide3<V> left = wrench.couple - cross(shift, wrench.force);
  return root(dot(left, left));
}

template <class V>
void cluster_forces(ClusterTerms& terms) {
  const V zero = number<V>(0), half = number<V>(0.5);
  const auto shape = in_all_lanes<V>(terms.shape);
  const V size(terms.shape.size), bends = number<V>(shape.flat ? 0 : 1);
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    const Wide3<V> centre = vector_at<V>(terms.centre, i), normal = vector_at<V>(terms.mean_normal, i);
    const V radius = get(terms.radius + i, V{}), thickness = get(terms.thickness + i, V{});
    const CentreField<V> at = field_at(shape, centre);
    const ClusterBounds<V> bounds =
        bounds_of(at, shape.jointed, ClusterReach<V>{radius, normal, thickness, vector_at<V>(terms.box, i)});
    const Surface<V> surface = surface_at<V>(terms, i);
    Wide3<V> spread;
    const Wrench<V> form = integrate_form(at, shape.axis, surface, spread);
    // Variance of phi over the cluster as its normals tell it; evenly spread over 3 of it to either side.
    const V least = greater(dot(surface.normal, surface.normal), number<V>(1e-300));
    const V variance = greater(quotient(dot(spread, surface.normal), least), zero);
    const V reach = between(root(number<V>(3) * variance), number<V>(kLeastRamp) * bounds.fall, bounds.fall);
    const Ramp<V> ramp = ramp_of(at.phi, greater(reach, number<V>(1e-300)), bounds.rise, bounds.fall);
    const Wide3<V> lever = moment_of(surface.first[0], surface.first[1], surface.first[2]);
    const Wrench<V> wrench{ramp.level * surface.normal + ramp.share * form.force,
                           ramp.level * lever + ramp.share * form.couple};
    const V left = put_force(wrench, centre, radius, i, terms);

    const V area = get(terms.surface + i, V{});
    const V off = ramp.error + ramp.share * bounds.rest + number<V>(kMomentRounding) * size;
    const V lost = ramp.share * (bends * (half * (radius * radius) * one_over(bounds.gap)));
    const V couple = (radius * (off + lost)) * area + left;
    put(terms.error + i, greater(off * area, couple * one_over(number<V>(4) * size)));
    put(terms.area + i, greater(ramp.share, number<V>(1e-6)) * area);
    put(terms.depth + i, greater(at.phi, zero));
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
