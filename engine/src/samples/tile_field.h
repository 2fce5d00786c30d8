// The field of a tile in lanes, and which of two neighbours a point is nearer to.
#pragma once

#include "samples/patch_rows.h"

namespace lumbrical::LUMBRICAL_ISA {

/// phi at p = (t, across): positive inside.
template <class V>
inline V tile_field(const TileFrame& tile, Wide3<V> p) {
  const V square = p.y * p.y + p.z * p.z, from_end = p.x - V(tile.length);
  const V slope = V(tile.tangent2) * square;
  const auto before = p.x * magnitude(p.x) <= slope, beyond = from_end * magnitude(from_end) >= slope;
  const V axial = choose(before, p.x, from_end);
  const V round = square + axial * axial;
  const V under = choose(before, round, choose(beyond, round, V(tile.cosine2) * square));
  const V level =
      choose(before, V(tile.radius), choose(beyond, V(tile.end_radius), V(tile.radius) - V(tile.sine) * p.x));
  return level - root(under);
}

/// The same where it is known which part of the tile is nearest.
template <TilePart kPart, class V>
inline V part_field(const TileFrame& tile, Wide3<V> p) {
  if constexpr (kPart == TilePart::whole) return tile_field(tile, p);
  const V square = p.y * p.y + p.z * p.z;
  if constexpr (kPart == TilePart::side)
    return (V(tile.radius) - V(tile.sine) * p.x) - root(V(tile.cosine2) * square);
  const V axial = kPart == TilePart::near_end ? p.x : p.x - V(tile.length);
  return V(kPart == TilePart::near_end ? tile.radius : tile.end_radius) - root(square + axial * axial);
}

/// phi, and where along its axis the tile is nearest to p, but for the tile's ends.
template <class V>
struct FieldAndPlace {
  V field, place;
};
template <class V>
inline FieldAndPlace<V> tile_field_and_place(const TileFrame& tile, Wide3<V> p) {
  const V rho = root(p.y * p.y + p.z * p.z);
  return {tile_field(tile, p), V(tile.cosine) * p.x - V(tile.sine) * rho};
}

/// How much more the point is the outer tile's than the inner one's [m].
template <class V>
inline V side_of_joint(const JointSides& joint, const TileFrame& inner, V inner_place, const TileFrame& outer,
                       V outer_place) {
  const V from_inner = V(joint.inner_sign) * (inner_place - V(inner.cosine * joint.inner_place));
  const V from_outer = V(joint.outer_sign) * (outer_place - V(outer.cosine * joint.outer_place));
  return from_outer - from_inner;
}

}  // namespace lumbrical::LUMBRICAL_ISA
