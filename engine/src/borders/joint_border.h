// Where the tiles of one finger share out space other than along the bisecting planes of its joints.
//
// By the law the field of a finger is the largest of its phalanges' fields, so two tiles border where their
// fields are equal. Seen from the joint C they have in common, the field of phalanx i at distance D in a
// direction theta_i off its axis is r - D sin(theta_i + sigma_i), sigma_i the slope of its cone (positive
// where it narrows away from the joint). So the fields are equal on theta_i + sigma_i = theta_j + sigma_j: a
// quadric cone with its apex at the joint, the bisecting plane where the slopes agree, until the far end of
// one of the two comes into reach.
#pragma once

#include "base/segment_distance.h"
#include "model/corners.h"
#include "model/primitive.h"

namespace lumbrical {

// Everything here is about a finger's tiles: wherever a function takes one, its segment is a phalanx. So is
// that of every tile; parts of the palm have no such borders.

/// Unit, half way between the directions of two phalanges, upon the plane through their joint that shares out
/// space between them. Of a finger folded right back on itself, where the two cancel, it is across them: what
/// it tends to.
Vec3 half_way(Vec3 here, Vec3 next);

/// Fills hand.border from hand.capsule and hand.present. Only phalanges that both follow the field law share
/// out space exactly.
void set_joint_borders(Primitives& hand);

/// Fills hand.folded, likewise.
void set_folded_fingers(Primitives& hand);

/// [m] Least distance of two primitives' axes.
inline double segment_distance(const Primitive& a, const Primitive& b) {
  return segment_distance(Segment{a.end1, a.end2}, Segment{b.end1, b.end2});
}

/// Could this border be anything but a plane on the triangle? Cheap.
bool is_in_reach(const JointBorder& border, const Corners& at);
inline bool comes_near(const JointBorder& border, const Corners& at) {
  const double ha = dot(border.normal, at.a - border.centre), hb = dot(border.normal, at.b - border.centre),
               hc = dot(border.normal, at.c - border.centre);
  if (min(ha, min(hb, hc)) > border.slab || max(ha, max(hb, hc)) < -border.slab) return false;
  return is_in_reach(border, at);
}

/// Which of a tile's borders run through a triangle other than along its cutting planes.
struct TileBorders {
  bool inner = false, outer = false;  ///< with the next phalanx towards the wrist, away from it
  bool folded = false;                ///< with the one beyond that
  [[nodiscard]] bool any() const { return inner || outer || folded; }
};

/// Does the phalanx folded upon the tile reach the triangle? Cheap.
bool meets_folded(const Primitives& hand, const Primitive& tile, const Corners& at);

/// The border of `tile` with the next phalanx towards the wrist, or away from it, where the two share out
/// space other than along a plane; else null.
inline const JointBorder* tile_border(const Primitives& hand, const Primitive& tile, bool outer) {
  const std::size_t i = tile.segment, place = i % 3;
  if (i >= kPhalanxCount || (outer ? place == 2 : place == 0)) return nullptr;
  const JointBorder& border = hand.border[outer ? i : i - 1];
  return border.shared ? &border : nullptr;
}
/// Is there a phalanx of its finger that may be folded upon it?
inline bool is_folded(const Primitives& hand, const Primitive& tile) {
  return tile.segment < kPhalanxCount && tile.segment % 3 != 1 && hand.folded[tile.segment / 3];
}

/// Which of a tile's borders may run through a triangle so. Cheap: most triangles end here.
inline TileBorders borders_in_reach(const Primitives& hand, const Primitive& tile, const Corners& at) {
  const JointBorder* const inner = tile_border(hand, tile, false);
  const JointBorder* const outer = tile_border(hand, tile, true);
  return {inner != nullptr && comes_near(*inner, at), outer != nullptr && comes_near(*outer, at),
          is_folded(hand, tile) && meets_folded(hand, tile, at)};
}

/// The borders of `tile` on the triangle `at` [m, W]. Where there are none, the contact with the tile cut
/// by its planes is exact.
TileBorders borders_on(const Primitives& hand, const Primitive& tile, const Corners& at);

}  // namespace lumbrical
