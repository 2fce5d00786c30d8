// One cell of a lattice: the positive part of a field in it, and what of that is on one side of borders.
//
// The field is linear between the cell's corners, whose positive part is integrated exactly, plus a bubble
// that the value at the centroid tells, as far as the cell is inside.
#pragma once

#include <array>
#include <type_traits>

#include "base/always_inline.h"
#include "simd/wide_geometry.h"

namespace lumbrical::LUMBRICAL_ISA {

/// The mean of what a linear function is above a floor over a triangle, and the share of the area in which it
/// is above, from its values at the corners and their mean.
template <class V>
struct Positive {
  V mean, share;
};
template <class V>
LUMBRICAL_INLINE inline Positive<V> part_above(V floor, V a, V b, V c, V mean) {
  const V zero = number<V>(0), one = number<V>(1);
  const V bc_low = min(b, c), bc_high = max(b, c);
  const V low = min(bc_low, a), high = max(bc_high, a);
  const V middle = max(bc_low, min(bc_high, a));
  // One corner is on its own side of the floor: the highest, or the lowest. It cuts off a triangle.
  const auto one_above = middle <= floor;
  const V beyond = max(select(one_above, high - floor, floor - low), zero);
  const V product = (high - low) * select(one_above, high - middle, middle - low);
  const V cut = divide(beyond * beyond, max(product, number<V>(1e-36)));  // at least beyond^2, or that is 0
  const V part = cut * beyond * number<V>(1.0 / 3);
  return {part + select(one_above, zero, mean - floor), select(one_above, cut, one - cut)};
}

/// Which corner's sign is its own: the second, the third, or, where there is any, else the first.
template <class M>
struct OddCorner {
  M second, third, any;
};
template <class V>
LUMBRICAL_INLINE inline auto odd_corner(V a, V b, V c) {
  const V zero = number<V>(0);
  const auto a_in = a > zero, b_in = b > zero, c_in = c > zero;
  const auto a_out = a <= zero, b_out = b <= zero, c_out = c <= zero;
  return OddCorner<std::remove_const_t<decltype(a_in)>>{
      (b_in && (a_out && c_out)) || (b_out && (a_in && c_in)),
      (c_in && (a_out && b_out)) || (c_out && (a_in && b_in)),
      (a_in || b_in || c_in) && (a_out || b_out || c_out)};
}

/// Another function at the corner that is cut off, and by how much more it is at the ends of the cut.
template <class V>
struct AlongCut {
  V own, more_s, more_t;
};

/// A part of a cell: its share, and by how much its centroid leans towards the corners b and c (Cell).
template <class V>
struct Part {
  V share, to_b, to_c;
};

/// A linear function at a triangle's corners.
template <class V>
struct AtCorners {
  V a, b, c;
  AtCorners operator-() const { return {number<V>(0) - a, number<V>(0) - b, number<V>(0) - c}; }
};

/// Where a linear function's zero cuts off the corner whose sign is its own: how far along that corner's
/// sides.
template <class V>
struct CutCorner {
  decltype(V{} > V{}) second, third, is_cut;  // which corner it is, if not the first
  V own;                                      // the function there, or at a corner where nothing is cut off
  V s, t;

  LUMBRICAL_INLINE CutCorner(V a, V b, V c) {
    const auto odd = odd_corner(a, b, c);
    second = odd.second, third = odd.third, is_cut = odd.any;
    const V next = select(second, c, select(third, a, b)), last = select(second, a, select(third, b, c));
    own = select(second, b, select(third, c, a));
    const V to_next = own - next, to_last = own - last;
    const V scale = divide(own, max(to_next * to_last, number<V>(1e-36)));
    s = scale * to_last, t = scale * to_next;
  }
  LUMBRICAL_INLINE explicit CutCorner(const AtCorners<V>& f) : CutCorner(f.a, f.b, f.c) {}
  [[nodiscard]] LUMBRICAL_INLINE AlongCut<V> of(V a, V b, V c) const {
    const V f = select(second, b, select(third, c, a));
    const V next = select(second, c, select(third, a, b)), last = select(second, a, select(third, b, c));
    return {f, s * (next - f), t * (last - f)};
  }
  /// What is where the function is positive, from the share of what is cut off; and the rest.
  [[nodiscard]] LUMBRICAL_INLINE Part<V> positive_part(V cut_off) const {
    const V one = number<V>(1), its = select(is_cut, cut_off, one);
    const Wide2<V> lean = lean_to_positive();
    return {select(own > number<V>(0), its, one - its), lean.x, lean.y};
  }
  [[nodiscard]] LUMBRICAL_INLINE Part<V> other_part(V cut_off) const {
    const V zero = number<V>(0), one = number<V>(1), its = select(is_cut, cut_off, one);
    const Wide2<V> lean = lean_to_positive();
    return {select(own > zero, one - its, its), zero - lean.x, zero - lean.y};
  }
  /// Is all of a triangle where the function is positive (1), or nothing (0)? Where nothing is cut off.
  [[nodiscard]] LUMBRICAL_INLINE V is_positive() const {
    return select(own > number<V>(0), number<V>(1), number<V>(0));
  }

 private:
  // What is cut off has its centroid (1 - s) / 3 and (1 - t) / 3 short of the triangle's; the rest has the
  // opposite moment. Of the area, not of what a field has there: so both parts always make up the whole.
  [[nodiscard]] LUMBRICAL_INLINE Wide2<V> lean_to_positive() const {
    const V zero = number<V>(0), one = number<V>(1), four = number<V>(4);
    const V area = select(own > zero, four, zero - four) * (s * t);
    const V to_next = area * (s - one), to_last = area * (t - one), to_own = zero - (to_next + to_last);
    return {select(is_cut, select(second, to_own, select(third, to_last, to_next)), zero),
            select(is_cut, select(second, to_next, select(third, to_own, to_last)), zero)};
  }
};

template <class V>
inline V mean_of(V a, V b, V c) {
  return (a + (b + c)) * number<V>(1.0 / 3);
}
/// What is cut off of what a linear function of any sign is above a floor, as a share: that is `above` on
/// average.
template <class V>
LUMBRICAL_INLINE inline V share_cut_off(const CutCorner<V>& cut, V fa, V fb, V fc, V floor, V above) {
  if (!any(cut.is_cut)) return number<V>(1);
  const AlongCut<V> f = cut.of(fa, fb, fc);
  const V at_s = f.own + f.more_s, at_t = f.own + f.more_t;
  const V part = part_above(floor, f.own, at_s, at_t, mean_of(f.own, at_s, at_t)).mean;
  const V share = cut.s * cut.t * divide(part, max(above, number<V>(1e-30)));
  return max(min(share, number<V>(1)), number<V>(0));  // of a cell at the floor both are rounding
}

/// One cell's mean, and how it leans towards its corners b and c.
template <class V>
struct Cell {
  V mean, to_b, to_c;
};
/// From the corners' values, their mean and by how much the field's mean is below that.
template <class V>
LUMBRICAL_INLINE inline Cell<V> lowered_cell(V a, V b, V c, V level, V drop) {
  const auto [mean, share] = part_above(drop, a, b, c, level);
  return {mean, share * (b - level), share * (c - level)};
}
/// By how much less a field's mean is than its corners' when its centroid is `centre`.
template <class V>
inline V drop_of(V level, V centre) {
  return number<V>(0.75) * (level - centre);
}
template <class V>
inline Cell<V> cell_of(V a, V b, V c, V centre) {
  const V level = mean_of(a, b, c);
  return lowered_cell(a, b, c, level, drop_of(level, centre));
}

template <class V>
inline Cell<V> operator+(const Cell<V>& one, const Cell<V>& other) {
  return {one.mean + other.mean, one.to_b + other.to_b, one.to_c + other.to_c};
}
template <class V>
inline Cell<V> operator*(V share, const Cell<V>& cell) {
  return {share * cell.mean, share * cell.to_b, share * cell.to_c};
}
template <class V>
inline Cell<V> operator*(const Part<V>& part, const Cell<V>& cell) {
  return {part.share * cell.mean, part.share * cell.to_b + part.to_b * cell.mean,
          part.share * cell.to_c + part.to_c * cell.mean};
}

/// A cell of a field of which only a part counts.
template <class V>
struct PartCell {
  V a, b, c, floor;  // the field at the corners
  Cell<V> whole;
  LUMBRICAL_INLINE PartCell(V at_a, V at_b, V at_c, V centre) : a(at_a), b(at_b), c(at_c) {
    const V level = mean_of(a, b, c);
    floor = drop_of(level, centre);
    whole = lowered_cell(a, b, c, level, floor);
  }
  /// What is where a function is positive; and the rest. Registers without a border, which are most, come to
  /// the same bits with less to do.
  [[nodiscard]] LUMBRICAL_INLINE Cell<V> where(const CutCorner<V>& cut) const {
    return any(cut.is_cut) ? cut.positive_part(share_of(cut)) * whole : cut.is_positive() * whole;
  }
  [[nodiscard]] LUMBRICAL_INLINE Cell<V> elsewhere(const CutCorner<V>& cut) const {
    return any(cut.is_cut) ? cut.other_part(share_of(cut)) * whole
                           : (number<V>(1) - cut.is_positive()) * whole;
  }

 private:
  [[nodiscard]] LUMBRICAL_INLINE V share_of(const CutCorner<V>& cut) const {
    return share_cut_off(cut, a, b, c, floor, whole.mean);
  }
};

/// A function in a cell, from its values at the corners and the centroid.
template <class V>
LUMBRICAL_INLINE inline AtCorners<V> in_cell(V a, V b, V c, V centre) {
  const V drop = drop_of(mean_of(a, b, c), centre);
  return {a - drop, b - drop, c - drop};
}

/// A triangle in a cell: its share of the area, the field, how much of b and c is in its corners, and N
/// borders, each a function that is positive on one side.
template <class V, std::size_t N>
struct Piece {
  V area;
  AtCorners<V> field, of_b, of_c;
  std::array<AtCorners<V>, N> border;

  [[nodiscard]] Piece cut_off(const CutCorner<V>& cut) const {
    const auto at = [&](const AtCorners<V>& f) {
      const AlongCut<V> along = cut.of(f.a, f.b, f.c);
      return AtCorners<V>{along.own, along.own + along.more_s, along.own + along.more_t};
    };
    Piece piece{area * (cut.s * cut.t), at(field), at(of_b), at(of_c), border};
    for (AtCorners<V>& its : piece.border) its = at(its);
    return piece;
  }
};
/// What of a piece is on the positive side of its first kBorders borders: what the field is above a floor
/// there, by the cell's area.
template <std::size_t kBorders, class V, std::size_t N>
inline Part<V> part_within(const Piece<V, N>& piece, V floor) {
  if constexpr (kBorders == 0) {
    const AtCorners<V>&f = piece.field, &b = piece.of_b, &c = piece.of_c;
    const V twelve_areas = number<V>(12) * piece.area, third = number<V>(1.0 / 3);
    return {piece.area * part_above(floor, f.a, f.b, f.c, mean_of(f.a, f.b, f.c)).mean,
            twelve_areas * (mean_of(b.a, b.b, b.c) - third), twelve_areas * (mean_of(c.a, c.b, c.c) - third)};
  } else {
    const CutCorner<V> cut(piece.border[kBorders - 1]);
    const Part<V> all = part_within<kBorders - 1>(piece, floor);
    const V zero = number<V>(0);
    const auto is_positive = cut.own > zero;
    Part<V> off{zero, zero, zero};
    if (any(cut.is_cut)) off = part_within<kBorders - 1>(piece.cut_off(cut), floor);
    const auto its = [&](V of_all, V of_off) {
      return select(is_positive, select(cut.is_cut, of_off, of_all),
                    select(cut.is_cut, of_all - of_off, zero));
    };
    return {its(all.share, off.share), its(all.to_b, off.to_b), its(all.to_c, off.to_c)};
  }
}
/// What of a cell is on the positive side of several borders. Where more than one cuts it, their shares would
/// not tell what the sides have in common: borders may run side by side.
template <class V, std::size_t N>
LUMBRICAL_INLINE inline Cell<V> cell_within(const PartCell<V>& cell,
                                            const std::array<AtCorners<V>, N>& border) {
  const V zero = number<V>(0), one = number<V>(1);
  AtCorners<V> own = border[0];
  auto is_any = cell.whole.mean > zero, is_cut = one < zero, is_crossed = is_cut;
  for (const AtCorners<V>& f : border) {
    const V low = min(f.a, min(f.b, f.c)), high = max(f.a, max(f.b, f.c));
    const auto is_its = low <= zero;
    own = {select(is_its, f.a, own.a), select(is_its, f.b, own.b), select(is_its, f.c, own.c)};
    is_any = is_any && high > zero;
    is_crossed = is_crossed || (is_cut && is_its);
    is_cut = is_cut || is_its;
  }
  if (!any(is_any)) return zero * cell.whole;
  if (!any(is_any && is_cut)) return select(is_any, one, zero) * cell.whole;
  const Cell<V> part = cell.where(CutCorner<V>(own));
  Part<V> crossed{zero, zero, zero};
  is_crossed = is_any && is_crossed;
  if (any(is_crossed)) {
    const Piece<V, N> piece{one, {cell.a, cell.b, cell.c}, {zero, one, zero}, {zero, zero, one}, border};
    crossed = part_within<N>(piece, cell.floor);
    const V share = divide(crossed.share, max(cell.whole.mean, number<V>(1e-30)));
    crossed.share = max(min(share, one), zero);
  }
  const Cell<V> its = crossed * cell.whole;
  const auto pick = [&](V of_one, V of_several) {
    return select(is_crossed, of_several, select(is_any, of_one, zero));
  };
  return {pick(part.mean, its.mean), pick(part.to_b, its.to_b), pick(part.to_c, its.to_c)};
}

}  // namespace lumbrical::LUMBRICAL_ISA
