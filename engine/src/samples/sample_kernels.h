// The kernels of the rungs of samples, one table per instruction set, every one with the same bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "base/always_inline.h"
#include "index/patches.h"
#include "lumbrical/model.h"
#include "samples/rivals.h"
#include "search/sphere_query.h"

namespace lumbrical {

/// What a body has to do with a patch, beside the patch's class; what decides which kernel takes it.
namespace kind {
/// The patch may meet tile j alone; of it only the side, or the sphere at one end.
inline constexpr std::uint32_t kTile = 0, kSide = 3, kNearEnd = 6, kFarEnd = 9;
/// The patch lies inside tile j and meets no other.
inline constexpr std::uint32_t kInside = 12;
/// Tiles 0 and 1 share it, 1 and 2, or all three.
inline constexpr std::uint32_t kInnerJoint = 15, kOuterJoint = 16, kFinger = 17;
/// A block as one that lies inside tile j and meets no other.
inline constexpr std::uint32_t kBlockInside = 18;
/// Above the palm's polygon on one side of it; through it; a block as one inside the skin, above the polygon
/// or beside it; or anywhere about it.
inline constexpr std::uint32_t kPalmSide = 21, kPalmThrough = 22, kPalmBlock = 23, kPalmBlockBeside = 24,
                               kPalm = 25;
inline constexpr std::uint32_t kCount = 26;
}  // namespace kind

/// How many neighbouring tiles share patches of a kind.
constexpr std::uint32_t sharers_of(std::uint32_t kind) {
  return kind == kind::kFinger ? 3 : kind == kind::kInnerJoint || kind == kind::kOuterJoint ? 2 : 1;
}

/// The tile of its finger that a kind is about, the innermost of several.
inline constexpr std::array<std::uint8_t, kind::kCount> kTileOfKind = [] {
  std::array<std::uint8_t, kind::kCount> tile{};
  for (std::uint32_t k = 0; k < kind::kPalmSide; ++k)
    tile[k] = static_cast<std::uint8_t>(k % FingerBody::kMostTiles);
  tile[kind::kInnerJoint] = tile[kind::kFinger] = 0;
  tile[kind::kOuterJoint] = 1;
  return tile;
}();

/// What of a tile a kernel needs to know: all of it, its side, or the sphere at one end.
enum class TilePart : std::uint8_t { whole, side, end };

/// The classes of blocks as ones: inside a body's skin, or where that goes through.
inline constexpr std::uint32_t kWithinSkin = 0, kAcrossSkin = 1;

/// Patches of a block that are found near a body and have the same key, or a block that is taken as one.
struct FoundPatches {
  std::uint16_t key;    ///< class (of a block as one kWithinSkin or kAcrossSkin) * kind::kCount + kind
  std::uint16_t lanes;  ///< a bit each (1 of a block)
  std::uint32_t block;
};
inline constexpr std::size_t kKeyCount = kind::kCount * kPatchClasses;

constexpr bool is_block(std::uint32_t kind) {
  return (kind >= kind::kBlockInside && kind < kind::kPalmSide) || kind == kind::kPalmBlock ||
         kind == kind::kPalmBlockBeside;
}
constexpr std::uint32_t kind_of(const FoundPatches& found) { return found.key % kind::kCount; }
constexpr std::uint32_t class_of(const FoundPatches& found) { return found.key / kind::kCount; }
/// A block as one that a body's skin goes through; one of a finer level may open it.
constexpr bool is_on_skin(const FoundPatches& found) {
  return class_of(found) == kAcrossSkin && is_block(kind_of(found));
}

/// A patch, or a block, in order of its key.
struct ListedPatch {
  static constexpr std::uint32_t kFarEnd = 64, kSecond = 128, kWithoutPalm = 64 * kSecond;
  std::uint32_t place;  ///< of the patch: 16 times its block plus the lane; or the block
  std::uint32_t tile;   ///< the (innermost) tile's number (bodies.h), plus kFarEnd at its far end; more where
                        ///< several bodies meet it (overlaps.h)
};
/// Of the number a patch is listed for: its tile; and, kSecond times, another one that meets it, plus
/// kWithoutPalm if the palm does not.
LUMBRICAL_INLINE constexpr std::uint32_t first_tile(std::uint32_t code) {
  return code % ListedPatch::kFarEnd;
}
LUMBRICAL_INLINE constexpr std::uint32_t second_tile(std::uint32_t code) {
  return code % ListedPatch::kWithoutPalm / ListedPatch::kSecond;
}
LUMBRICAL_INLINE constexpr bool is_without_palm(std::uint32_t code) {
  return code >= ListedPatch::kWithoutPalm;
}

/// Patches for a kernel, best in runs of the same tile, and the lattice that they go through, if any.
struct PatchList {
  const PatchShape* shapes;
  const ListedPatch* patches;
  std::size_t count;
  const SplitPoint* origins;  ///< of the bodies: Bodies::origin
  std::size_t steps = 0;
  std::uint32_t first_cut = ~0u;           ///< places from there on
  const PatchShape* cut_shapes = nullptr;  ///< are of these (cut_patches.h)

  [[nodiscard]] LUMBRICAL_INLINE const PatchShape& shape_at(std::uint32_t place) const {
    return place < first_cut ? shapes[place] : cut_shapes[place - first_cut];
  }
};

/// Blocks that are taken as wholes.
struct BlockList {
  const BlockSamples* blocks;
  const ListedPatch* patches;
  std::size_t count;
  SplitPoint origin;  ///< [m] W, of the body
};

/// Sums over patches of a tile's (or the palm's) share of phi n dA, twice, and of its moments, in its frame:
/// x y z and moments about its origin, in sixteen lanes. [m^3], [m^4]
///
/// What is added is first rounded to a multiple of a quantum, so adding is exact as long as sums stay below
/// 2^51 of them, and the order does not matter.
struct BodySums {
  alignas(64) double lane[6][PatchBlock::kWidth] = {};
  double force_quantum = 0, moment_quantum = 0;  ///< [m^3], [m^4], powers of two
};

/// Half onto half, which is quickest. Sums of bodies are exact in any order.
template <class Number, std::size_t kWidth>
inline Number sum_of(const Number (&lanes)[kWidth]) {
  if constexpr (kWidth == 1) {
    return lanes[0];
  } else {
    Number half[kWidth / 2];
    for (std::size_t i = 0; i < kWidth / 2; ++i) half[i] = lanes[i] + lanes[i + kWidth / 2];
    return sum_of(half);
  }
}

/// Sums of tiles by their numbers, and a bit for each tile whose shares are wanted.
struct TileSums {
  BodySums* of;
  std::uint64_t wanted;
};

/// What a body feels of patches as their centroids alone tell it: twice the sum of phi n A, in W, in sixteen
/// lanes. By that it is known how fine lattices have to be (levels.h). Summed block by block, which come in
/// the same order whatever finds them. [m^3]
struct CentroidForce {
  alignas(64) float lane[3][PatchBlock::kWidth] = {};
};

/// The palm as sphere trees see it: planes `normal . p + offset` that are at most 0 in its skin's convex
/// hull, relative to the tree's origin, in single precision.
struct PalmQuery {
  std::size_t plane_count = 0;
  float plane[PalmBody::kMostCorners + 2][4];  ///< unit normal, offset [m]
  float slack;                                 ///< [m] what rounding may take away
};

/// Blocks that are classified at a time, at most.
inline constexpr std::size_t kBlocksAtATime = 64;

/// A block that a finger's search has found: its place, and a bit per tile that its sphere may reach.
LUMBRICAL_INLINE constexpr std::uint32_t found_at(std::uint32_t place, std::uint32_t tiles) {
  return place << FingerBody::kTileBits | tiles;
}
LUMBRICAL_INLINE constexpr std::uint32_t place_of(std::uint32_t found) {
  return found >> FingerBody::kTileBits;
}
LUMBRICAL_INLINE constexpr std::uint32_t tiles_of(std::uint32_t found) {
  return found & ((1u << FingerBody::kTileBits) - 1);
}
/// From a bit per lane of each tile to the tiles of a lane.
LUMBRICAL_INLINE inline std::uint32_t tiles_in_lane(const unsigned (&of)[FingerBody::kMostTiles],
                                                    unsigned lane) {
  return (of[0] >> lane & 1u) | (of[1] >> lane & 1u) << 1 | (of[2] >> lane & 1u) << 2;
}

/// Blocks of a level, and the first one's number among all.
struct BlockLevel {
  const BlockSamples* blocks;
  std::uint32_t first;
};
/// Where what a body finds goes, and what it feels of that by the patches' centroids is added.
struct FoundSink {
  FoundPatches* patches;
  CentroidForce& force;
};

struct SampleKernels {
  struct Sorted {
    std::size_t open_count, whole_count;
  };
  /// Of up to sixteen blocks of a level that the body of `others` has found, `found` keeps, first, those that
  /// have to be opened; small ones that lie inside go to `sink` as wholes, by their numbers among all
  /// levels'. A finger's are given with the tiles that a block's sphere may reach (found_at); the palm's as
  /// places. Where others may be deeper in some of a block it is no whole, and where they are in all of it,
  /// nothing.
  Sorted (*sort_blocks)(const BlockLevel& level, const OtherParts& others, std::uint32_t* found,
                        std::size_t count, const FoundSink& sink);
  Sorted (*sort_palm_blocks)(const BlockLevel& level, const OtherParts& others, std::uint32_t* found,
                             std::size_t count, const FoundSink& sink);
  /// Writes the blocks' patches that the body of that origin may meet, and in what way; returns how many.
  std::size_t (*classify_finger)(const PatchBlock* blocks, const FingerBody& finger, const SplitPoint& origin,
                                 const std::uint32_t* found, std::size_t count, const FoundSink& sink);
  std::size_t (*classify_palm)(const PatchBlock* blocks, const PalmBody& palm, const SplitPoint& origin,
                               const std::uint32_t* found, std::size_t count, const FoundSink& sink);
  // Kernels add to sums (of tiles by their numbers) and return how many of the patches they found touched.
  /// One tile.
  std::uint32_t (*tile_lattice)(const PatchList& list, const FingerBody* fingers, TilePart part,
                                const TileSums& sums);
  /// Two or three neighbouring tiles, and how they share.
  std::uint32_t (*shared_lattice)(const PatchList& list, const FingerBody* fingers, std::size_t tiles,
                                  const TileSums& sums);
  /// Patches inside one tile, by a rule of quadrature (triangle_rules.h).
  std::uint32_t (*tile_rule)(const PatchList& list, const FingerBody* fingers, std::size_t rule,
                             const TileSums& sums);
  /// Blocks as wholes.
  std::uint32_t (*tile_blocks)(const BlockList& list, const TileFrame& tile, BodySums& sums);
  std::uint32_t (*palm_blocks)(const BlockList& list, const PalmBody& palm, BodySums& sums);
  std::uint32_t (*palm_through)(const PatchList& list, const PalmBody& palm, BodySums& sums);
  std::uint32_t (*palm_side)(const PatchList& list, const PalmBody& palm, BodySums& sums);
  std::uint32_t (*palm_lattice)(const PatchList& list, const PalmBody& palm, BodySums& sums);
  /// Which spheres of the blocks the tree's query meets, as sphere_hits does, for up to three queries: the
  /// places, or (`tiles`) places with a bit per query (found_at).
  std::size_t (*finger_hits)(const SphereBlock* spheres, const SphereQuery* queries, std::size_t query_count,
                             const std::uint32_t* blocks, std::size_t block_count, bool tiles,
                             std::uint32_t* hits);
  std::size_t (*palm_hits)(const SphereBlock* spheres, const PalmQuery& query, const std::uint32_t* blocks,
                           std::size_t block_count, std::uint32_t* hits);
  // What several bodies hold together (overlaps.h).
  /// Of a block's patches, the lanes in which another body is deeper throughout than each: by the parts that
  /// are near any of them, seen from `origin`.
  void (*outdone_lanes)(const PatchBlock& block, const Bodies& bodies, std::uint64_t parts,
                        const BodyOffsets& offset, const SplitPoint& origin, std::uint16_t* outdone);
  /// One or two tiles, of different fingers, and the palm, each where it is the deepest.
  std::uint32_t (*deepest_lattice)(const PatchList& list, const Bodies& bodies, std::size_t tiles,
                                   const TileSums& sums);
  /// Any parts, `parts` of each patch.
  std::uint32_t (*parts_lattice)(const PatchList& list, const Bodies& bodies, const std::uint64_t* parts,
                                 const TileSums& sums);
};

namespace scalar {
extern const SampleKernels kSampleKernels;
}
namespace sse2 {
extern const SampleKernels kSampleKernels;
}
namespace avx2 {
extern const SampleKernels kSampleKernels;
}
namespace avx512 {
extern const SampleKernels kSampleKernels;
}
namespace neon {
extern const SampleKernels kSampleKernels;
}
namespace simd128 {
extern const SampleKernels kSampleKernels;
}

/// The table of an instruction set that is available.
const SampleKernels& sample_kernels(Isa isa);

}  // namespace lumbrical
