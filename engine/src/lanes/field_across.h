// The field's mean along short ways across a triangle's plane, one source for every instruction set; a way is
// a lane.
#pragma once

#include "lanes/crossing_terms.h"
#include "lanes/round_plane.h"

namespace lumbrical::LUMBRICAL_ISA {

// In shares of the distance d from the axis: up to the first, two nodes leave less than a hundredth of the
// fourth power of height over d; up to the last, four do. Where the field passes over to another formula on
// the way its second derivative steps by 1 / d at most, of which eight nodes leave 5.2e-5 height^2 / d.
inline constexpr double kThinWay = 4e-3, kKinkedWay = 2.5e-3, kShortWay = 0.1;

template <class V, std::size_t N>
void add_ways(const RoundPart<V>& part, const RoundPlane<V>& plane, Wide2<V> foot, Wide2<V> way,
              const GaussNode (&rule)[N], V& mean, V& lean) {
  for (const GaussNode& node : rule) {
    const V at = number<V>(node.at);
    const V share = number<V>(node.weight) * field_at(part, plane, foot + at * way).phi;
    mean = mean + share;
    lean = lean + at * share;
  }
}

template <class V>
void field_across(CrossingTerms& terms) {
  const V zero = number<V>(0), one = number<V>(1);
  RoundPart<V> part{};
  part.length = number<V>(terms.length);
  part.radius1 = number<V>(terms.radius1);
  part.sine = number<V>(terms.sine);
  part.cosine = number<V>(terms.cosine);
  part.tangent = number<V>(terms.sine / terms.cosine);
  part.sphere = terms.length == 0;
  RoundPlane<V> plane{};
  plane.s = number<V>(terms.s);
  plane.c = number<V>(terms.c);
  plane.h1 = number<V>(terms.h1);
  for (std::size_t i = 0; i < terms.count; i += wide::Lanes<V>::kCount) {
    const Wide2<V> foot{get(terms.x + i, V{}), get(terms.y + i, V{})};
    const V height = get(terms.height + i, V{}), far = magnitude(height);
    const Wide2<V> way{height * number<V>(terms.across_x), height * number<V>(terms.across_y)};
    const FieldValue<V> start = field_at(part, plane, foot);
    const V distance = number<V>(terms.radius2) - start.phi;
    const auto even = far < start.margin, kinked = far >= start.margin;
    const auto thin = both(even, far < number<V>(kThinWay) * distance);
    const auto thick = both(even, far >= number<V>(kThinWay) * distance);
    const auto least = both(kinked, far < number<V>(kKinkedWay) * distance);
    V mean = zero, lean = zero;
    const auto add = [&](const auto& which, const auto& rule) {
      if (!some(which)) return;
      V own_mean = zero, own_lean = zero;
      add_ways(part, plane, foot, way, rule, own_mean, own_lean);
      mean = choose(which, own_mean, mean);
      lean = choose(which, own_lean, lean);
    };
    add(thin, kGauss2);
    add(thick, kGauss4);
    add(least, kGauss8);
    put(terms.mean + i, mean);
    put(terms.lean + i, lean);
    put(terms.smooth + i,
        choose(either(least, both(even, far < number<V>(kShortWay) * distance)), one, zero));
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
