// Integrals of the field along strips, one source for every instruction set: for each node (x, y) the
// integral of phi over y' from 0 to y, and of y' phi. What pressure_field.cpp sums along the boundary of a
// region.
//
// With d the distance of (x, 0) from a centre or from the axis line, phi = level - factor sqrt(d^2 + y^2),
// and
//   int phi dy = level y - factor (y r + d^2 asinh(y / d)) / 2,  r = sqrt(d^2 + y^2).
// Going out from y = 0 the nearest sphere of the hull is the second end, then one between, then the first
// end.
#pragma once

#include "base/gauss.h"
#include "exact/strip_terms.h"
#include "simd/wide_geometry.h"

namespace lumbrical::LUMBRICAL_ISA {

// phi = level - factor sqrt(d2 + y^2), zero where factor^2 y^2 = gap. The gap is kept apart because where phi
// is small against R nothing is left of it in level^2 - factor^2 d2.
template <class V>
struct StripField {
  V level, factor, d2, gap;
};

template <class V>
struct StripSum {
  V zeroth, first;
};

template <class V>
StripSum<V> closed_strip(const StripField<V>& f, V from, V to) {
  const V rf = sqrt(f.d2 + from * from), rt = sqrt(f.d2 + to * to);
  const V delta = to - from, sum = to + from, reach = rf + rt;
  const V log = twice_atanh(delta, reach);
  const V rise = divide(delta * sum, select(reach > number<V>(0), reach, number<V>(1)));  // rt - rf
  const V squares = rt * rt + rt * rf + rf * rf;
  return {f.level * delta - f.factor * (number<V>(0.5) * (to * rt - from * rf + f.d2 * log)),
          number<V>(0.5) * (f.level * (delta * sum)) - f.factor * (number<V>(1.0 / 3) * (rise * squares))};
}

// Where phi is small along the whole strip, the closed form would cancel: its terms are of order R.
template <class V>
StripSum<V> shallow_strip(const StripField<V>& f, V from, V to) {
  StripSum<V> sum{number<V>(0), number<V>(0)};
  const V delta = to - from, square = f.factor * f.factor;
  for (std::size_t k = 0; k < 6; ++k) {
    const V y = from + delta * number<V>(kGauss6[k].at);
    const V phi = divide(f.gap - square * (y * y), f.level + f.factor * sqrt(f.d2 + y * y));
    const V share = delta * number<V>(kGauss6[k].weight) * phi;
    sum.zeroth = sum.zeroth + share;
    sum.first = sum.first + share * y;
  }
  return sum;
}

template <class V>
void add_strip(const StripField<V>& f, V from, V to, StripSum<V>& sum) {
  const V zero = number<V>(0);
  const auto wanted = from < to;
  if (!any(wanted)) return;
  const auto limit = number<V>(kShallowStrip) * f.level * f.level;
  const auto deep = f.gap >= limit, shallow = f.gap < limit;
  if (any(wanted && deep)) {
    const StripSum<V> closed = closed_strip(f, from, to);
    const auto use = wanted && deep;
    sum.zeroth = sum.zeroth + select(use, closed.zeroth, zero);
    sum.first = sum.first + select(use, closed.first, zero);
  }
  if (any(wanted && shallow)) {
    const StripSum<V> small = shallow_strip(f, from, to);
    const auto use = wanted && shallow;
    sum.zeroth = sum.zeroth + select(use, small.zeroth, zero);
    sum.first = sum.first + select(use, small.first, zero);
  }
}

// Where, going out in y, the field passes over to the next part: cosine axial = sine sqrt(e^2 + y^2).
template <class V>
V border_of(V axial, V per_sine, V cosine, V e2, bool cone) {
  const V zero = number<V>(0);
  if (!cone) return select(axial > zero, number<V>(1e300), zero);
  const V rho = cosine * axial * per_sine;
  return select(axial > zero, sqrt(max(rho * rho - e2, zero)), zero);
}

template <class V>
void strip_nodes(const StripSection& section, StripNodes& nodes) {
  const V zero = number<V>(0), one = number<V>(1);
  const V r1 = number<V>(section.radius1), r2 = number<V>(section.radius2);
  const V h1 = number<V>(section.h1), h2 = number<V>(section.h2), x2 = number<V>(section.x2);
  const V s = number<V>(section.s), c = number<V>(section.c);
  const V sine = number<V>(section.sine), cosine = number<V>(section.cosine);
  const bool cone = section.sine != 0;
  const V per_sine = number<V>(cone ? 1 / section.sine : 0);
  for (std::size_t i = 0; i < nodes.count; i += wide::Lanes<V>::kCount) {
    const V x = get(nodes.x + i, V{}), y = get(nodes.y + i, V{});
    const V reach = abs(y);
    const StripField<V> first{r1, one, x * x + h1 * h1, (r1 - h1) * (r1 + h1) - x * x};
    StripSum<V> sum{zero, zero};
    if (section.kind == StripSection::sphere) {
      add_strip(first, zero, reach, sum);
    } else {
      const V e = c * x + s * h1, q = s * x - c * h1;
      const V level = r1 - sine * q, scaled = cosine * e;
      const StripField<V> side{level, cosine, e * e, (level - scaled) * (level + scaled)};
      if (section.kind == StripSection::side_only) {
        add_strip(side, zero, reach, sum);
      } else {
        const V off = x - x2;
        const StripField<V> second{r2, one, off * off + h2 * h2, (r2 - h2) * (r2 + h2) - off * off};
        const V to_side =
            min(reach, border_of(q - number<V>(section.length), per_sine, cosine, side.d2, cone));
        const V to_first = max(min(reach, border_of(q, per_sine, cosine, side.d2, cone)), to_side);
        add_strip(second, zero, to_side, sum);
        add_strip(side, to_side, to_first, sum);
        add_strip(first, to_first, reach, sum);
      }
    }
    put(nodes.zeroth + i, select(y < zero, zero - sum.zeroth, sum.zeroth));
    put(nodes.first + i, sum.first);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
