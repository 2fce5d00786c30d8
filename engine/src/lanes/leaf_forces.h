// The contact of a leaf of clusters that finger surface or cutting planes run through, one source for every
// instruction set; a lane is a triangle.
//
// The field is linear between a triangle's corners. What of it is positive and inside the planes is a signed
// sum of triangles: cutting one by a line through it leaves the triangle at the corner that is alone on its
// side, or all but that.
#pragma once

#include <iterator>

#include "lanes/cluster_field.h"

namespace lumbrical::LUMBRICAL_ISA {

// A triangle with what varies linearly over it.
template <class V>
struct Piece {
  Wide3<V> corner[3];
  V phi[3];
  V inside[LeafTerms::kPlaneCapacity][3];  // positive inside each plane
  V weight;                                // signed area
};

template <class V>
inline V part_way(V from, V to, V t) {
  return from + t * (to - from);
}
template <class V>
inline Wide3<V> part_way(Wide3<V> from, Wide3<V> to, V t) {
  return from + t * (to - from);
}

// Replaces `whole`, of whose corners `value` tells which are kept, by the part of it that counts in full and
// the triangle `rest` that is added to it.
template <class V>
void cut_piece(const V (&value)[3], Piece<V>& whole, Piece<V>& rest) {
  const V zero = number<V>(0), one = number<V>(1);
  const V in0 = choose(value[0] > zero, one, zero), in1 = choose(value[1] > zero, one, zero),
          in2 = choose(value[2] > zero, one, zero);
  const V count = in0 + in1 + in2;
  const auto first = both(in1 == in2, in0 < in1), other_first = both(in1 == in2, in0 > in1);
  const auto alone0 = either(first, other_first);
  const auto alone1 = both(in0 == in2, either(in1<in0, in1> in0));
  const auto turn = [&](const auto(&row)[3], auto(&turned)[3]) {
    turned[0] = choose(alone0, row[0], choose(alone1, row[1], row[2]));
    turned[1] = choose(alone0, row[1], choose(alone1, row[2], row[0]));
    turned[2] = choose(alone0, row[2], choose(alone1, row[0], row[1]));
  };
  V v[3];
  turn(value, v);
  const auto way_to = [&](V to) {
    const V drop = v[0] - to;
    const auto some_drop = either(drop > zero, drop < zero);
    return between(quotient(v[0], choose(some_drop, drop, one)), zero, one);
  };
  const V t1 = way_to(v[1]), t2 = way_to(v[2]);
  const auto shrink = [&](auto(&row)[3]) {
    row[1] = part_way(row[0], row[1], t1);
    row[2] = part_way(row[0], row[2], t2);
  };
  turn(whole.corner, rest.corner);
  shrink(rest.corner);
  turn(whole.phi, rest.phi);
  shrink(rest.phi);
  for (int k = 0; k < LeafTerms::kPlaneCapacity; ++k) {
    turn(whole.inside[k], rest.inside[k]);
    shrink(rest.inside[k]);
  }
  const V sign = choose(count == one, one, choose(count == number<V>(2), zero - one, zero));
  rest.weight = sign * (whole.weight * (t1 * t2));
  whole.weight = choose(count >= number<V>(2), whole.weight, zero);
}

template <class V>
struct PieceSums {
  V area, volume;
  Wide3<V> area_first, first;  // of 1 and of phi, about the leaf's centre
};

template <class V>
void add_piece(const Piece<V>& piece, PieceSums<V>& sums) {
  const V third = number<V>(1.0 / 3), twelfth = number<V>(1.0 / 12);
  const Wide3<V> all = piece.corner[0] + piece.corner[1] + piece.corner[2];
  const V phi = piece.phi[0] + piece.phi[1] + piece.phi[2];
  sums.area = sums.area + piece.weight;
  sums.area_first = sums.area_first + (piece.weight * third) * all;
  sums.volume = sums.volume + piece.weight * third * phi;
  const Wide3<V> mixed = piece.phi[0] * piece.corner[0] + piece.phi[1] * piece.corner[1] +
                         piece.phi[2] * piece.corner[2] + phi * all;
  sums.first = sums.first + (piece.weight * twelfth) * mixed;
}

template <class V>
Piece<V> piece_at(const LeafTerms& terms, const WideShape<V>& shape, std::size_t i) {
  const Wide3<V> centre = in_all_lanes<V>(terms.centre);
  Piece<V> piece;
  for (int c = 0; c < 3; ++c) {
    const Wide3<V> p = vector_at<V>(terms.corner[c], i);
    piece.corner[c] = p - centre;
    piece.phi[c] = field_at(shape, p).phi;
    for (int k = 0; k < LeafTerms::kPlaneCapacity; ++k) {
      const double(&plane)[4] = terms.plane[k];
      piece.inside[k][c] = V(plane[3]) - dot(in_all_lanes<V>(plane), p);
    }
  }
  return piece;
}

template <class V>
void leaf_forces(LeafTerms& terms) {
  const V zero = number<V>(0);
  const auto shape = in_all_lanes<V>(terms.shape);
  for (std::size_t i = 0; i < LeafTerms::kCapacity; i += wide::Lanes<V>::kCount) {
    constexpr std::size_t kMost = std::size_t{2} << LeafTerms::kPlaneCapacity;
    Piece<V> piece[kMost];
    piece[0] = piece_at(terms, shape, i);
    const Wide3<V> raw =
        cross(piece[0].corner[1] - piece[0].corner[0], piece[0].corner[2] - piece[0].corner[0]);
    const V twice = root(dot(raw, raw)), per = one_over(twice);
    const Wide3<V> normal = choose(twice > zero, per * raw, Wide3<V>{zero, zero, zero});
    piece[0].weight = number<V>(0.5) * twice;
    const V most = greater(piece[0].phi[0], greater(piece[0].phi[1], piece[0].phi[2]));
    std::size_t count = 1;
    for (int k = 0; k < terms.plane_count; ++k, count *= 2) {
      for (std::size_t j = 0; j < count; ++j) {
        const V value[3] = {piece[j].inside[k][0], piece[j].inside[k][1], piece[j].inside[k][2]};
        cut_piece(value, piece[j], piece[count + j]);
      }
    }
    PieceSums<V> sums{zero, zero, {zero, zero, zero}, {zero, zero, zero}};
    for (std::size_t j = 0; j < count; ++j) {
      Piece<V> rest;
      const V value[3] = {piece[j].phi[0], piece[j].phi[1], piece[j].phi[2]};
      cut_piece(value, piece[j], rest);
      add_piece(piece[j], sums);
      add_piece(rest, sums);
    }
    const Wide3<V> force = sums.volume * normal, couple = cross(sums.first, normal);
    const V rows[] = {force.x,   force.y,           force.z,           couple.x,          couple.y, couple.z,
                      sums.area, sums.area_first.x, sums.area_first.y, sums.area_first.z, most};
    for (std::size_t row = 0; row < std::size(rows); ++row) put(terms.result[row] + i, rows[row]);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
