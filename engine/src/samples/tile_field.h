// The field of tiles in lanes, along the rows of a lattice, and which of two neighbours a point is nearer to.
#pragma once

#include "samples/patch_rows.h"

namespace lumbrical::LUMBRICAL_ISA {

/// [m] The field of what a patch does not meet.
inline constexpr double kNowhere = -1e30;

/// Where a point is in a tile's frame: along its axis, and the square of how far from that.
template <class V>
struct TilePoint {
  V along, square;
};

template <class V>
LUMBRICAL_INLINE inline TilePoint<V> tile_point(Wide3<V> in_frame) {
  return {in_frame.x, in_frame.y * in_frame.y + in_frame.z * in_frame.z};
}

/// phi, positive inside, is what `level` is above `distance`: the radius next to a point, and how far that is
/// from the axis, across the skin: is it from an end, and then how far along the axis from its centre.
template <class V>
struct TileDepth {
  V level, distance;
  decltype(V{} > V{}) is_end;
  V axial;
};
template <class V>
LUMBRICAL_INLINE inline TileDepth<V> tile_depth(const TileNumbers<V>& tile, TilePoint<V> p) {
  const V from_end = p.along - tile.length, slope = tile.tangent2 * p.square;
  const auto before = p.along * abs(p.along) <= slope, beyond = from_end * abs(from_end) >= slope;
  const V axial = select(before, p.along, from_end);
  const V round = p.square + axial * axial;
  const auto is_end = before || beyond;
  const V under = select(is_end, round, tile.cosine2 * p.square);
  const V level =
      select(before, tile.radius, select(beyond, tile.end_radius, tile.radius - tile.sine * p.along));
  return {level, sqrt(under), is_end, axial};
}
template <class V>
LUMBRICAL_INLINE inline V tile_field(const TileNumbers<V>& tile, TilePoint<V> p) {
  const TileDepth<V> depth = tile_depth(tile, p);
  return depth.level - depth.distance;
}

/// Where along its axis the tile is nearest to p, but for the tile's ends.
template <class V>
inline V place_on(const TileNumbers<V>& tile, TilePoint<V> p) {
  return tile.cosine * p.along - tile.sine * sqrt(p.square);
}

/// Turns a patch in the plane of two coordinates until its second edge has nothing of the second one.
template <class V>
inline void turn_edge(PatchInFrame<V>& patch, V Wide3<V>::*kept, V Wide3<V>::*gone) {
  const V x = patch.edge2.*kept, y = patch.edge2.*gone, length = sqrt(x * x + y * y);
  const auto is_real = length > number<V>(0);
  const V cosine = select(is_real, divide(x, select(is_real, length, number<V>(1))), number<V>(1)),
          sine = divide(y, select(is_real, length, number<V>(1)));
  const auto turn = [&](Wide3<V>& p) {
    const V turned = cosine * (p.*kept) + sine * (p.*gone);
    p.*gone = cosine * (p.*gone) - sine * (p.*kept);
    p.*kept = turned;
  };
  turn(patch.corner);
  turn(patch.edge1);
  patch.edge2.*kept = length;
  patch.edge2.*gone = number<V>(0);
}

/// A patch turned about a tile's axis, so that along a row (of the same u) only two coordinates change.
template <class V>
struct TileRows {
  PatchInFrame<V> patch;
  struct Row {
    V along, y, height2;
  };
  [[nodiscard]] Row row(V u) const {
    const Wide3<V> p = patch.corner + u * patch.edge1;
    return {p.x, p.y, p.z * p.z};
  }
  [[nodiscard]] TilePoint<V> at(const Row& row, V v) const {
    const V y = row.y + v * patch.edge2.y;
    return {row.along + v * patch.edge2.x, y * y + row.height2};
  }
};

template <class V>
inline TileRows<V> tile_rows(PatchInFrame<V> patch) {
  turn_edge(patch, &Wide3<V>::y, &Wide3<V>::z);
  return {patch};
}

/// The field of the part of a tile, along rows.
template <TilePart kPart, class V>
struct PartRows;

template <class V>
struct PartRows<TilePart::whole, V> {
  TileRows<V> rows;
  TileNumbers<V> tile;
  explicit PartRows(const SeenPatch<V>& seen) : rows(tile_rows(seen.patch)), tile(seen.tile) {}
  [[nodiscard]] auto row(V u) const { return rows.row(u); }
  template <class Row>
  [[nodiscard]] V field(const Row& row, V v) const {
    return tile_field(tile, rows.at(row, v));
  }
};

/// Of the side: level and distance times the cosine are what its slope makes of them.
template <class V>
struct PartRows<TilePart::side, V> {
  V corner_level, level1, level2;
  TileRows<V> rows;
  explicit PartRows(const SeenPatch<V>& seen)
      : corner_level(seen.tile.radius - seen.tile.sine * seen.patch.corner.x),
        level1(seen.tile.sine * seen.patch.edge1.x),
        level2(seen.tile.sine * seen.patch.edge2.x),
        rows(tile_rows(seen.patch)) {
    const auto shrink = [&](Wide3<V>& p) {
      p.y = seen.tile.cosine * p.y;
      p.z = seen.tile.cosine * p.z;
    };
    shrink(rows.patch.corner);
    shrink(rows.patch.edge1);
    shrink(rows.patch.edge2);
  }
  struct Row {
    V level, y, height2;
  };
  [[nodiscard]] Row row(V u) const {
    const V y = rows.patch.corner.y + u * rows.patch.edge1.y,
            z = rows.patch.corner.z + u * rows.patch.edge1.z;
    return {corner_level - u * level1, y, z * z};
  }
  [[nodiscard]] V field(const Row& row, V v) const {
    const V y = row.y + v * rows.patch.edge2.y;
    return (row.level - v * level2) - sqrt(y * y + row.height2);
  }
};

/// Of the sphere at an end: turned once more, about its centre, only one coordinate changes along a row.
template <class V>
struct PartRows<TilePart::end, V> {
  V radius;
  PatchInFrame<V> patch;
  explicit PartRows(const SeenPatch<V>& seen)
      : radius(select(seen.at_far_end, seen.tile.end_radius, seen.tile.radius)), patch(seen.patch) {
    patch.corner.x = patch.corner.x - select(seen.at_far_end, seen.tile.length, number<V>(0));
    turn_edge(patch, &Wide3<V>::y, &Wide3<V>::z);
    turn_edge(patch, &Wide3<V>::y, &Wide3<V>::x);
  }
  struct Row {
    V y, aside2;
  };
  [[nodiscard]] Row row(V u) const {
    const Wide3<V> p = patch.corner + u * patch.edge1;
    return {p.y, p.x * p.x + p.z * p.z};
  }
  [[nodiscard]] V field(const Row& row, V v) const {
    const V y = row.y + v * patch.edge2.y;
    return radius - sqrt(y * y + row.aside2);
  }
};

/// Two neighbours' joint in lanes (bodies.h).
template <class V>
struct JointNumbers {
  V inner_sign, inner_place, outer_sign, outer_place, by_field;
};

/// What of a tile tells a point's side of a joint: its field there, and its place (place_on).
template <class V>
struct TileClaim {
  V field, place;
};

/// How much more the point is the outer tile's than the inner one's [m].
template <class V>
inline V side_of_joint(const JointNumbers<V>& joint, const TileNumbers<V>& inner, TileClaim<V> by_inner,
                       const TileNumbers<V>& outer, TileClaim<V> by_outer) {
  const V from_inner = joint.inner_sign * (by_inner.place - inner.cosine * joint.inner_place);
  const V from_outer = joint.outer_sign * (by_outer.place - outer.cosine * joint.outer_place);
  return (from_outer - from_inner) + joint.by_field * (by_outer.field - by_inner.field);
}
template <class V>
inline JointNumbers<V> numbers_of(const JointSides& joint) {
  return {V(joint.inner_sign), V(joint.inner_place), V(joint.outer_sign), V(joint.outer_place),
          V(joint.by_field)};
}

}  // namespace lumbrical::LUMBRICAL_ISA
