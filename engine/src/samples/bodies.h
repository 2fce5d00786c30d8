// The parts of a posed hand as the rungs of samples see them: fingers as chains of tiles, the palm as a swept
// polygon, in single precision, each seen from an origin of its own near by.
#pragma once

#include <array>
#include <cstdint>

#include "base/always_inline.h"
#include "base/set_bits.h"
#include "index/patches.h"
#include "lumbrical/hand.h"
#include "lumbrical/math.h"

namespace lumbrical {

struct Primitives;

/// A phalanx: the hull of two spheres, along its axis t from the centre of the larger one. Its field is
///   radius - |(t, rho)|                       before the larger sphere's rim,
///   radius - sine t - cosine rho              on the side,
///   end_radius - |(t - length, rho)|          beyond the smaller one's.
struct TileFrame {
  float origin[3];                   ///< [m] W, relative to the body's origin
  float axis[3][3];                  ///< W, unit: along the axis, and two across
  float length, radius, end_radius;  ///< [m]
  float sine, cosine;                ///< of the side's slope
  float tangent2, cosine2;           ///< sine^2 / cosine^2, cosine^2
};

/// What two neighbouring tiles are told apart by: how far along its own axis, away from the joint they share,
/// the nearest part of each of them is. Beside a short tile, and where one bends into the other, their fields
/// tell, and places only where those are the same.
struct JointSides {
  float inner_sign, inner_place;  ///< which way that is, times what places count; [m] of the joint
  float outer_sign, outer_place;  ///< the same on the outer tile's axis
  float by_field;                 ///< what fields count
};

/// Up to three phalanges that follow each other.
struct FingerBody {
  static constexpr std::size_t kMostTiles = 3;
  static constexpr unsigned kTileBits = kMostTiles;  ///< of a number that has a bit for each tile
  std::size_t tile_count = 0;
  std::uint8_t segment[kMostTiles] = {};
  const LatticeSteps* steps[kMostTiles] = {};  ///< of each tile's lattices in a patch of each class
  float block_size[kMostTiles] = {};           ///< [m] of the largest block each tile takes as one
  float block_on_skin = 0;                     ///< [m] of the largest block taken as one on the skin
  Vec3 origin;                                 ///< [m] W
  TileFrame tile[kMostTiles] = {};
  JointSides joint[kMostTiles - 1] = {};

  /// A bit per tile; what is beyond them may be left from another pose.
  [[nodiscard]] std::uint32_t tiles() const { return (1u << tile_count) - 1; }
};

/// An edge of the palm's polygon, counterclockwise: it runs a quarter turn to the left of `out`.
struct PalmEdge {
  float x, y;          ///< [m] the corner it begins at
  float out_x, out_y;  ///< unit, away from the polygon
  float length;        ///< [m]
};

/// The palm in the plane of its polygon: x and y in it, z towards the palmar side.
struct PalmBody {
  static constexpr std::size_t kMostCorners = 16;
  std::size_t corner_count = 0;
  Vec3 origin;            ///< [m] W
  float axis[3][3] = {};  ///< W, unit: x, y, z
  float radius = 0;       ///< [m]
  float block_size[2];    ///< [m] of the largest block that is taken as one, above the polygon and beside it
  float block_on_skin;    ///< [m] the same on the skin
  const LatticeSteps* steps;  ///< of its lattices in a patch of each class
  PalmEdge edge[kMostCorners];
};

/// All bodies of a hand that are felt by samples. Tile k of finger i has the number kTilesApart i + k.
struct Bodies {
  static constexpr std::size_t kMostFingers = 2 * kFingerCount;  ///< a finger that lacks a phalanx is two
  static constexpr std::size_t kTilesApart = 4, kMostParts = (kMostFingers + 1) * kTilesApart;
  std::size_t finger_count = 0;
  std::array<FingerBody, kMostFingers> finger;
  PalmBody palm;
  std::uint32_t felt = 0;  ///< a bit each, the palm's behind the last finger's; others are only in their way
  /// [m] W, of the fingers and, behind the last of them, of the palm.
  std::array<SplitPoint, kMostFingers + 1> origin;
};
inline const TileFrame& tile_at(const FingerBody* fingers, std::size_t number) {
  return fingers[number / Bodies::kTilesApart].tile[number % Bodies::kTilesApart];
}

/// [m] Of its tiles.
LUMBRICAL_INLINE inline float largest_radius(const FingerBody& finger) {
  float largest = 0;
  for (std::size_t k = 0; k < finger.tile_count; ++k)
    if (finger.tile[k].radius > largest) largest = finger.tile[k].radius;
  return largest;
}

/// The palm's number, behind those of the last finger's tiles.
inline std::size_t palm_number(const Bodies& bodies) { return bodies.finger_count * Bodies::kTilesApart; }

/// All parts that there are, tiles and palm, a bit each by their numbers.
std::uint64_t parts_of(const Bodies& bodies);

/// The body that a part of the hand belongs to.
constexpr std::size_t body_of(std::size_t part) { return part / Bodies::kTilesApart; }

/// The segment that a part is.
inline std::size_t segment_of(const Bodies& bodies, std::size_t part) {
  if (part == palm_number(bodies)) return kPalmSegment;
  return bodies.finger[body_of(part)].segment[part % Bodies::kTilesApart];
}

/// Those of some parts that belong to a body, from its first on.
constexpr std::uint64_t parts_of_body(std::uint64_t parts, std::size_t body) {
  return parts >> body * Bodies::kTilesApart & ((std::uint64_t{1} << Bodies::kTilesApart) - 1);
}

inline bool is_felt(const Bodies& bodies, std::size_t body) { return has_bit(bodies.felt, body); }
/// Those among `parts` that are felt.
inline std::uint64_t felt_of(const Bodies& bodies, std::uint64_t parts) {
  std::uint64_t felt = 0;
  for_numbers(parts,
              [&](std::size_t part) { felt |= std::uint64_t{is_felt(bodies, body_of(part))} << part; });
  return felt;
}

/// [m] Where all bodies' origins are, seen from one point, and the largest radius of all.
struct BodyOffsets {
  float of[Bodies::kMostFingers + 1][3];
  float largest;
  [[nodiscard]] const float* operator[](std::size_t body) const { return of[body]; }
};
BodyOffsets offsets_from(Vec3 point, const Bodies& bodies);

/// Bodies take blocks up to that radius [m] as ones where their skin goes through.
void take_blocks_on_skin(double radius, Bodies& bodies);

/// Sets the bodies of the segments whose bit is set in `segments`, of which those in `felt` are felt.
void set_bodies(const Primitives& hand, std::uint32_t segments, std::uint32_t felt, const PatchRules& rules,
                Bodies& bodies);

}  // namespace lumbrical
