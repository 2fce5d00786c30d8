// The contact of a leaf of clusters that the finger's surface or cuts run through, one source for every
// instruction set; a lane is a triangle.
//
// The field and a cut's function are linear between a triangle's corners. What of it is positive and inside
// the cuts is a signed sum of triangles: cutting one by a line through it leaves the triangle at the corner
// that is alone on its side, or all but that. Pieces that no lane has are passed over: what they would add
// is zero, so nothing depends on which triangles share a register.
#pragma once

#include <iterator>

#include "lanes/cluster_field.h"

namespace lumbrical::LUMBRICAL_ISA {

// A function that is linear over the leaf's triangle: s and t are shares of the ways from corner 0 to corners
// 1 and 2.
template <class V>
struct Sloped {
  V start, along_s, along_t;
  [[nodiscard]] V at(V s, V t) const { return start + (s * along_s + t * along_t); }
};

template <class V>
inline Sloped<V> between_corners(const V (&value)[3]) {
  return {value[0], value[1] - value[0], value[2] - value[0]};
}

// A part of the leaf's triangle: a triangle with its corners.
template <class V>
struct Piece {
  V s[3], t[3];
  V weight;  // signed area
};

template <class V>
inline V part_way(V from, V to, V t) {
  return from + t * (to - from);
}

// Replaces `whole` by the part of it that counts in full where the function is positive and the triangle
// `rest` that is added to it. False where nothing is to be added.
template <class V>
bool cut_piece(const Sloped<V>& function, Piece<V>& whole, Piece<V>& rest) {
  const V zero = number<V>(0), one = number<V>(1);
  V value[3];
  for (int k = 0; k < 3; ++k) value[k] = function.at(whole.s[k], whole.t[k]);
  const V in0 = choose(value[0] > zero, one, zero), in1 = choose(value[1] > zero, one, zero),
          in2 = choose(value[2] > zero, one, zero);
  const V count = in0 + in1 + in2;
  const auto crossed =
      both(both(count > zero, count < number<V>(3)), either(whole.weight > zero, whole.weight < zero));
  if (!some(crossed)) {
    whole.weight = choose(count > zero, whole.weight, zero);
    return false;
  }
  // The first corner is to be the one that is alone on its side.
  const auto alone0 = both(in1 == in2, either(in0<in1, in0> in1));
  const auto alone1 = both(in0 == in2, either(in1<in0, in1> in0));
  const auto turn = [&](const V(&row)[3], V(&turned)[3]) {
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
  const V way1 = way_to(v[1]), way2 = way_to(v[2]);
  const auto shrink = [&](V(&row)[3]) {
    row[1] = part_way(row[0], row[1], way1);
    row[2] = part_way(row[0], row[2], way2);
  };
  turn(whole.s, rest.s);
  shrink(rest.s);
  turn(whole.t, rest.t);
  shrink(rest.t);
  const V sign = choose(count == one, one, choose(count == number<V>(2), zero - one, zero));
  rest.weight = sign * (whole.weight * (way1 * way2));
  whole.weight = choose(count >= number<V>(2), whole.weight, zero);
  return true;
}

// Integrals of 1 and of phi, and of their products with s and t.
template <class V>
struct PieceSums {
  V area, volume;
  V area_s, area_t, volume_s, volume_t;
};

template <class V>
void add_piece(const Piece<V>& piece, const Sloped<V>& phi, PieceSums<V>& sums) {
  V value[3];
  for (int k = 0; k < 3; ++k) value[k] = phi.at(piece.s[k], piece.t[k]);
  const auto sum = [](const V(&row)[3]) { return row[0] + row[1] + row[2]; };
  const auto product = [&](const V(&row)[3]) {
    return value[0] * row[0] + value[1] * row[1] + value[2] * row[2];
  };
  const V s = sum(piece.s), t = sum(piece.t), all = sum(value);
  const V third = number<V>(1.0 / 3) * piece.weight, twelfth = number<V>(1.0 / 12) * piece.weight;
  sums.area = sums.area + piece.weight;
  sums.area_s = sums.area_s + third * s;
  sums.area_t = sums.area_t + third * t;
  sums.volume = sums.volume + third * all;
  sums.volume_s = sums.volume_s + twelfth * (product(piece.s) + all * s);
  sums.volume_t = sums.volume_t + twelfth * (product(piece.t) + all * t);
}

// Sums over what of the whole triangles is positive and inside the cuts.
template <class V>
PieceSums<V> sum_pieces(const Sloped<V> (&cut)[LeafTerms::kCutCapacity], int cut_count, const Sloped<V>& phi,
                        V area) {
  const V zero = number<V>(0), one = number<V>(1);
  Piece<V> piece[1 << LeafTerms::kCutCapacity];
  piece[0] = {{zero, one, zero}, {zero, zero, one}, area};
  int count = 1;
  for (int k = 0; k < cut_count; ++k) {
    for (int j = 0, last = count; j < last; ++j) count += cut_piece(cut[k], piece[j], piece[count]) ? 1 : 0;
  }
  PieceSums<V> sums{zero, zero, zero, zero, zero, zero};
  for (int j = 0; j < count; ++j) {
    Piece<V> rest;
    const bool more = cut_piece(phi, piece[j], rest);
    add_piece(piece[j], phi, sums);
    if (more) add_piece(rest, phi, sums);
  }
  return sums;
}

// The field alone.
template <class V>
V phi_at(const WideShape<V>& shape, Wide3<V> p) {
  const V zero = number<V>(0);
  if (shape.flat) return shape.height - dot(shape.face, p);
  const V z = dot(p, shape.axis);
  const Wide3<V> off = p - z * shape.axis;
  const V square = dot(off, off), rho = root(square);
  const V first = shape.cosine * z - shape.sine * rho, second = first - shape.cosine * shape.length;
  const auto at_end1 = either(first < zero, shape.jointed == zero);
  const auto at_end = either(at_end1, second > zero);
  const V beside = shape.radius1 - shape.sine * z - shape.cosine * rho;
  if (!some(at_end)) return beside;
  const V ahead = choose(at_end1, z, z - shape.length);
  return choose(at_end, choose(at_end1, shape.radius1, shape.radius2) - root(square + ahead * ahead), beside);
}

// A cut's function between the corners, positive inside, and the share of the triangle that may be on the
// other side of where that is zero: a function whose second derivative is no larger than `bend` differs from
// it by bend / 2 times the square of the radius of a circle round the triangle at most, to one side. Half of
// that is taken away, and of a triangle no more than 2 w / (b - a) lies where a linear function from a to b
// is in an interval of length w.
template <class V>
Sloped<V> inside_cut(const CutShape<double>& cut, double bend, const Wide3<V> (&corner)[3], V longest,
                     V& doubt) {
  const V zero = number<V>(0);
  const V off = number<V>(bend / 6) * longest, middle = number<V>(0.5 * cut.bow) * off;
  V value[3];
  for (int c = 0; c < 3; ++c) value[c] = middle - beyond(cut, corner[c]);
  const Sloped<V> function = between_corners(value);
  if (bend == 0) return function;
  const V low = lesser(value[0], lesser(value[1], value[2])),
          high = greater(value[0], greater(value[1], value[2]));
  const V half = number<V>(0.5) * off;
  const auto meets = both(low<half, high> zero - half);
  const V share = lesser(quotient(off + off, greater(high - low, number<V>(1e-300))), number<V>(1));
  doubt = doubt + choose(meets, share, zero);
  return function;
}

template <class V>
void leaf_forces(LeafTerms& terms) {
  const V zero = number<V>(0), half = number<V>(0.5);
  const auto shape = in_all_lanes<V>(terms.shape);
  const Wide3<V> centre = in_all_lanes<V>(terms.centre), across = in_all_lanes<V>(terms.across);
  const V per_bend = V(terms.field_bend / 24), side_bends = V(terms.side);
  for (std::size_t i = 0; i < LeafTerms::kCapacity; i += wide::Lanes<V>::kCount) {
    Wide3<V> from[3], corner[3];
    V height[3];
    for (int c = 0; c < 3; ++c) {
      from[c] = vector_at<V>(terms.corner[c], i);
      corner[c] = centre + from[c];
      height[c] = phi_at(shape, corner[c]);
    }
    const Wide3<V> side_s = from[1] - from[0], side_t = from[2] - from[0], side = side_t - side_s;
    const Wide3<V> raw = cross(side_s, side_t);
    const V twice = root(dot(raw, raw)), per = one_over(twice), area = half * twice;
    const Wide3<V> normal = choose(twice > zero, per * raw, Wide3<V>{zero, zero, zero});
    const V longest = greater(dot(side, side), greater(dot(side_s, side_s), dot(side_t, side_t)));
    // The mean of what a field that bends so is above the corners' plane.
    const auto bent = [&](Wide3<V> e) {
      const V e_across = dot(e, across), e_along = dot(e, shape.axis);
      return dot(e, e) - e_across * e_across - side_bends * (e_along * e_along);
    };
    const V lift = per_bend * (bent(side_s) + bent(side_t) + bent(side));
    Sloped<V> phi = between_corners(height);
    phi.start = phi.start + lift;
    Sloped<V> cut[LeafTerms::kCutCapacity];
    V doubt = zero;
    for (int k = 0; k < terms.cut_count; ++k)
      cut[k] = inside_cut(*terms.cut[k], terms.bend[k], corner, longest, doubt);
    const PieceSums<V> sums = sum_pieces(cut, terms.cut_count, phi, area);
    const auto first = [&](V all, V s, V t) { return all * from[0] + s * side_s + t * side_t; };
    const Wide3<V> force = sums.volume * normal,
                   couple = cross(first(sums.volume, sums.volume_s, sums.volume_t), normal),
                   area_first = first(sums.area, sums.area_s, sums.area_t);
    const V highest = greater(height[0], greater(height[1], height[2]));
    const V rows[] = {force.x,      force.y,      force.z,      couple.x, couple.y,     couple.z, sums.area,
                      area_first.x, area_first.y, area_first.z, highest,  area * doubt, area};
    static_assert(std::size(rows) == LeafTerms::row_count);
    for (std::size_t row = 0; row < std::size(rows); ++row) put(terms.result[row] + i, rows[row]);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
