// Blocks of small patches as wholes: which are, and what a body feels of them.
#pragma once

#include "base/set_bits.h"
#include "samples/body_fields.h"

namespace lumbrical::LUMBRICAL_ISA {

/// Sixteen blocks, a lane each, relative to a body's origin.
struct BlockRows {
  static constexpr std::size_t kWidth = PatchBlock::kWidth;
  alignas(64) float centre[3][kWidth];
  alignas(64) float radius[kWidth];
  alignas(64) float arm[3][3][kWidth];
  alignas(64) float extent[3][kWidth];
};
/// Where blocks have their arms and, behind them, their extents; and weights and, behind them, the centre's.
inline constexpr std::size_t kArms = offsetof(BlockSamples, arm) / sizeof(float),
                             kWeights = offsetof(BlockSamples, weight) / sizeof(float);
static_assert(offsetof(BlockSamples, extent) == (kArms + 9) * sizeof(float));
static_assert(offsetof(BlockSamples, centre_weight) == (kWeights + 18) * sizeof(float));

/// Four blocks as fours: centres seen from an origin, arms, and the last arm's end and extents.
struct BlockFours {
  Four centre[4], arms[2][4], end[4];
  void see(std::size_t k, const float* numbers, const OriginFours& origin) {
    centre[k] = origin.seen(numbers);
    for (std::size_t i = 0; i < 2; ++i) arms[i][k] = four_at(numbers + kArms + 4 * i);
    end[k] = four_at(numbers + kArms + 8);
  }
  /// Rows of anything that has centres and arms; those of extents are in `end` behind its first.
  template <class Rows>
  void put(std::size_t lane, Rows& rows) {
    transpose(centre);
    transpose(arms[0]);
    transpose(arms[1]);
    transpose(end);
    put_fours(centre, 3, rows.centre, lane);
    put_fours(arms[0], 4, rows.arm, 0, lane);
    put_fours(arms[1], 4, rows.arm, 4, lane);
    put_fours(end, 1, rows.arm, 8, lane);
  }
};
inline const float* floats_of(const BlockSamples& block) { return block.centre.high; }

/// Those at places `found` >> `shift`.
inline void gather(const BlockSamples* blocks, const SplitPoint& origin, const std::uint32_t* found,
                   unsigned shift, std::size_t count, BlockRows& rows) {
  OriginFours from;
  from.see(&origin, 0);
  BlockFours fours;
  for (std::size_t lane = 0; lane < BlockRows::kWidth; lane += 4) {
    for (std::size_t k = 0; k < 4; ++k) {
      const BlockSamples& block = blocks[found[lane + k < count ? lane + k : 0] >> shift];
      rows.radius[lane + k] = block.radius;
      fours.see(k, floats_of(block), from);
    }
    fours.put(lane, rows);
    put_fours(fours.end + 1, 3, rows.extent, lane);
  }
}
template <class V>
inline Boxes<V> boxes_of(const BlockRows& rows, std::size_t lane, float largest) {
  const V radius = get(rows.radius + lane, V{});
  Boxes<V> boxes{vector_at<V>(rows.centre, lane), radius, reach_of(radius, largest), {}};
  for (std::size_t k = 0; k < 3; ++k)
    boxes.arm[k] = get(rows.extent[k] + lane, V{}) * vector_at<V>(rows.arm[k], lane);
  return boxes;
}

/// What blocks are to a body: their kinds (-1: nothing), the field at their centres, and whether its skeleton
/// comes near (1).
struct BlockKinds {
  alignas(64) float kind[BlockRows::kWidth];
  alignas(64) float field[BlockRows::kWidth];
  alignas(64) float is_near[BlockRows::kWidth];
};
/// The key that a block is listed by if a body takes it as one, and the largest one that it takes so [m].
struct TakenWhole {
  std::uint32_t key;
  float size;
};
/// Blocks of which a body has nothing, since others are deeper throughout, and those in which they may be
/// somewhere: a bit per lane.
struct BlockClaims {
  unsigned outdone = 0, contested = 0;
};
/// [m] By how much more or less than at their centres one part may lead over another one within blocks.
/// Fields are concave, so nowhere above what they are along their slopes, and nowhere farther below that than
/// the sphere that is nearest at the centre.
template <class V>
struct LeadRange {
  V less, more;
};
template <class V>
inline LeadRange<V> lead_range(const Boxes<V>& boxes, const OtherParts& others, std::size_t leader_part,
                               std::size_t other_part) {
  const PartSlope<V> leader = slope_at(others.bodies, leader_part, others.offset, boxes.centre),
                     other = slope_at(others.bodies, other_part, others.offset, boxes.centre);
  const Wide3<V> slope = other.away - leader.away;
  V along = number<V>(2) * (boxes.reach - boxes.radius);
  for (const Wide3<V>& arm : boxes.arm) along = along + abs(dot(slope, arm));
  const V twice = boxes.reach + boxes.reach, bent = number<V>(0.5) * (boxes.reach * boxes.reach);
  const auto is_sure = min(leader.distance, other.distance) > number<V>(0.25) * boxes.reach;
  const auto within = [&](V distance) {
    return select(is_sure, min(twice, along + divide(bent, distance)), twice);
  };
  return {within(leader.distance), within(other.distance)};
}

/// Of the blocks in some lanes, which a part of the hand would have, by its rivals.
template <class V>
inline BlockClaims claims_of(const BlockRows& rows, const BlockKinds& kinds, const OtherParts& others,
                             std::size_t part, std::uint64_t rivals, unsigned lanes) {
  constexpr auto kCount = static_cast<unsigned>(wide::Lanes<V>::kCount);
  BlockClaims claims;
  if (rivals == 0) return claims;
  for (unsigned lane = 0; lane < BlockRows::kWidth; lane += kCount) {
    const unsigned asked = lanes >> lane & ((1u << kCount) - 1);
    if (asked == 0) continue;
    const Boxes<V> boxes = boxes_of<V>(rows, lane, others.offset.largest);
    const V twice = boxes.reach + boxes.reach, zero = number<V>(0), own = get(kinds.field + lane, V{});
    for_numbers(rivals, [&](std::size_t rival) {
      const V field = field_at(others.bodies, rival, others.offset, boxes.centre), lead = field - own;
      const auto is_near = field + boxes.reach > zero && lead + twice >= zero;
      LeadRange<V> range{twice, twice};
      if ((wide::bits_of(is_near && lead <= twice) & asked) != 0)
        range = lead_range(boxes, others, rival, part);
      claims.outdone |= wide::bits_of(lead > select(is_near, range.less, twice)) << lane;
      claims.contested |= wide::bits_of(is_near && lead + range.more >= zero) << lane;
    });
  }
  return {claims.outdone & lanes, claims.contested & lanes};
}

/// From kinds to blocks that have to be opened and those that are taken as wholes: `whole(kind, no skeleton
/// near)`. Places are given in `found`, from the bit `shift` on.
template <class V, class Whole>
inline SampleKernels::Sorted part_blocks(const BlockRows& rows, const BlockKinds& kinds,
                                         const OtherParts& others, const BlockLevel& level,
                                         const Whole& whole, unsigned shift, std::uint32_t* found,
                                         std::size_t count, const FoundSink& sink) {
  SampleKernels::Sorted sorted{0, 0};
  TakenWhole taken[BlockRows::kWidth];
  unsigned small_of[FingerBody::kMostTiles] = {};
  for (std::size_t lane = 0; lane < count; ++lane) {
    if (kinds.kind[lane] < 0) continue;
    taken[lane] = whole(static_cast<std::uint32_t>(kinds.kind[lane]), !(kinds.is_near[lane] > 0));
    if (!(level.blocks[found[lane] >> shift].size <= taken[lane].size)) continue;
    small_of[kTileOfKind[static_cast<std::uint32_t>(kinds.kind[lane])]] |= 1u << lane;
  }
  // Rivals are asked about their own tile's blocks only: what else is in the row must not show.
  unsigned small = 0, all_outdone = 0;
  for (std::size_t tile = 0; tile < FingerBody::kMostTiles; ++tile) {
    if (small_of[tile] == 0) continue;
    const auto [outdone, contested] = claims_of<V>(
        rows, kinds, others, others.body * Bodies::kTilesApart + tile, others.of_tile(tile), small_of[tile]);
    all_outdone |= outdone;
    small |= small_of[tile] & (outdone | ~contested);
  }
  for (std::size_t lane = 0; lane < count; ++lane) {
    if (kinds.kind[lane] < 0) continue;
    const std::uint32_t place = found[lane] >> shift;
    if (has_bit(small, lane)) {
      if (!has_bit(all_outdone, lane))
        sink.patches[sorted.whole_count++] = {static_cast<std::uint16_t>(taken[lane].key), 1,
                                              level.first + place};
      const float field = kinds.field[lane] > 0 ? kinds.field[lane] : 0;
      for (std::size_t axis = 0; axis < 3; ++axis)  // in a lane of its own, whatever blocks are beside it
        sink.force.lane[axis][place % BlockRows::kWidth] += field * level.blocks[place].normal[axis];
    } else {
      found[sorted.open_count++] = found[lane];
    }
  }
  return sorted;
}

/// Inside one tile, or where its skin goes through and no skeleton comes near.
inline TakenWhole taken_by_finger(const FingerBody& finger, std::uint32_t kind, bool is_clear) {
  const std::uint32_t tile = kTileOfKind[kind];
  if (kind >= kind::kInside && kind < kind::kInnerJoint)
    return {kind::kBlockInside + tile, finger.block_size[tile]};
  return {kAcrossSkin * kind::kCount + kind::kBlockInside + tile,
          kind < kind::kInside && is_clear ? finger.block_on_skin : -1};
}
/// Inside the palm's skin, or where that goes through and no skeleton comes near.
inline TakenWhole taken_by_palm(const PalmBody& palm, std::uint32_t kind, bool is_clear) {
  if (kind == kind::kPalmBlock) return {kind, palm.block_size[0]};
  if (kind == kind::kPalmBlockBeside) return {kind, palm.block_size[1]};
  return {kAcrossSkin * kind::kCount + kind::kPalmBlockBeside,
          kind != kind::kPalmThrough && is_clear ? palm.block_on_skin : -1};
}

template <class V>
SampleKernels::Sorted sort_blocks(const BlockLevel& level, const OtherParts& others, std::uint32_t* found,
                                  std::size_t count, const FoundSink& sink) {
  const FingerBody& finger = others.bodies.finger[others.body];
  const float largest = largest_radius(finger);
  BlockRows rows;
  gather(level.blocks, others.origin(), found, FingerBody::kTileBits, count, rows);
  BlockKinds of;
  unsigned met[FingerBody::kMostTiles] = {};
  for (unsigned lane = 0; lane < BlockRows::kWidth; lane += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
    const Boxes<V> boxes = boxes_of<V>(rows, lane, largest);
    const FingerView<V> view = view_finger(finger, boxes, finger.tiles());
    for (std::size_t k = 0; k < FingerBody::kMostTiles; ++k) met[k] |= wide::bits_of(view.meets(k)) << lane;
    const Kinds<V> kinds = shared_kinds(finger, view, boxes.reach, finger.tiles());
    put(of.kind + lane, kinds.kind);
    put(of.field + lane, kinds.field);
    put(of.is_near + lane, kinds.is_near);
  }
  for (unsigned lane = 0; lane < count; ++lane)
    found[lane] = found_at(place_of(found[lane]), tiles_in_lane(met, lane));
  return part_blocks<V>(
      rows, of, others, level,
      [&](std::uint32_t kind, bool is_clear) { return taken_by_finger(finger, kind, is_clear); },
      FingerBody::kTileBits, found, count, sink);
}

template <class V>
SampleKernels::Sorted sort_palm_blocks(const BlockLevel& level, const OtherParts& others,
                                       std::uint32_t* found, std::size_t count, const FoundSink& sink) {
  const PalmBody& palm = others.bodies.palm;
  BlockRows rows;
  gather(level.blocks, others.origin(), found, 0, count, rows);
  BlockKinds of;
  for (unsigned lane = 0; lane < BlockRows::kWidth; lane += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
    const Boxes<V> boxes = boxes_of<V>(rows, lane, palm.radius);
    const Kinds<V> kinds = palm_kinds(palm, boxes);
    const V reach = boxes.reach;
    const V field = palm_field(palm, turn_into(palm.axis, boxes.centre)), distance = V(palm.radius) - field;
    const auto is_smooth = field > reach && distance >= number<V>(kSmoothReach) * reach;
    const auto is_beside = kinds.kind == number<V>(kind::kPalm) && is_smooth;
    put(of.kind + lane, select(is_beside, number<V>(kind::kPalmBlockBeside), kinds.kind));
    put(of.field + lane, field);
    put(of.is_near + lane, kinds.is_near);
  }
  return part_blocks<V>(
      rows, of, others, level,
      [&](std::uint32_t kind, bool is_clear) { return taken_by_palm(palm, kind, is_clear); }, 0, found, count,
      sink);
}

/// The numbers of sixteen blocks, by number and lane.
struct SampleRows {
  static constexpr std::size_t kWidth = PatchBlock::kWidth;
  alignas(64) float centre[3][kWidth];
  alignas(64) float arm[3][3][kWidth];
  alignas(64) float weight[7][3][kWidth];  // + of each arm, then -, then the centre's
};
inline void gather(const BlockList& list, std::size_t first, std::size_t count, SampleRows& rows) {
  OriginFours from;
  from.see(&list.origin, 0);
  BlockFours fours;
  for (std::size_t lane = 0; lane < SampleRows::kWidth; lane += 4) {
    Four weights[5][4], end[4];
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t at = lane + k < count ? lane + k : 0;
      const float* const numbers = floats_of(list.blocks[list.patches[first + at].place]);
      fours.see(k, numbers, from);
      for (std::size_t i = 0; i < 5; ++i) weights[i][k] = four_at(numbers + kWeights + 4 * i);
      end[k] = four_at(numbers + kWeights + 17);
    }
    fours.put(lane, rows);
    for (std::size_t i = 0; i < 5; ++i) {
      transpose(weights[i]);
      put_fours(weights[i], 4, rows.weight, 4 * i, lane);
    }
    transpose(end);
    put_fours(end + 3, 1, rows.weight, 20, lane);
  }
  for (auto& weight : rows.weight) {
    for (auto& row : weight) std::fill(row + count, row + SampleRows::kWidth, 0.0f);
  }
}

/// Of a linear function over the square from -1 to 1: the mean of its positive part, that part's share of the
/// area, and its mean moments along either side.
template <class V>
struct PositiveInSquare {
  V mean, share, along[2];
};
/// From the function's mean and by how much it rises from the middle to either side. A rise counts as a
/// fiftieth of both together at least, for what is divided by it must not vanish.
template <class V>
LUMBRICAL_INLINE inline PositiveInSquare<V> positive_in_square(V mean, V rise0, V rise1) {
  const V zero = number<V>(0), one = number<V>(1), third = number<V>(1.0 / 3);
  const V size = max(abs(rise0) + abs(rise1), number<V>(1e-30)), scale = divide(one, size);
  const V least = number<V>(0.02), a = max(abs(rise0) * scale, least), b = max(abs(rise1) * scale, least);
  const V both = a + b, m = clamp(mean * scale, zero - both, both);
  // The positive parts at the corners, and their powers.
  const V y[4] = {m + both, max(m + (a - b), zero), max(m - (a - b), zero), max(m - both, zero)};
  V y2[4], y3[4];
  for (std::size_t k = 0; k < 4; ++k) {
    y2[k] = y[k] * y[k];
    y3[k] = y2[k] * y[k];
  }
  const V inverse = divide(one, a * b), part = number<V>(1.0 / 8) * inverse, across = third * part * size;
  const V fourth = number<V>(0.25) * ((y2[0] * y2[0] - y2[1] * y2[1]) - (y2[2] * y2[2] - y2[3] * y2[3]));
  const V along0 = across * (((y3[0] - y3[1]) + (y3[2] - y3[3])) - inverse * b * fourth),
          along1 = across * (((y3[0] + y3[1]) - (y3[2] + y3[3])) - inverse * a * fourth);
  const auto whole = m >= both;
  return {select(whole, mean, across * ((y3[0] - y3[1]) - (y3[2] - y3[3]))),
          select(whole, one, part * ((y2[0] - y2[1]) - (y2[2] - y2[3]))),
          {select(whole, third * rise0, select(rise0 < zero, zero - along0, along0)),
           select(whole, third * rise1, select(rise1 < zero, zero - along1, along1))}};
}

/// Adds what a body with this frame and field feels of the blocks. A block is what its samples tell, as far
/// as it is inside: its patches fill about the rectangle of its first two arms, along which the field is
/// linear.
template <class V, class Field>
LUMBRICAL_INLINE inline std::uint32_t sum_blocks(const BlockList& list, const float (&axis)[3][3],
                                                 Wide3<V> frame_origin, const Field& field, BodySums& sums) {
  SampleRows rows;
  std::uint32_t touched = 0;
  for (std::size_t first = 0; first < list.count; first += SampleRows::kWidth) {
    const std::size_t count = std::min(list.count - first, SampleRows::kWidth);
    gather(list, first, count, rows);
    for (std::size_t lane = 0; lane < count; lane += wide::Lanes<V>::kCount) {
      const Wide3<V> centre = vector_at<V>(rows.centre, lane) - frame_origin, at = turn_into(axis, centre);
      Wide3<V> normal = vector_at<V>(rows.weight[6], lane), force = field(at) * normal;
      Wide3<V> arm[3], moment{number<V>(0), number<V>(0), number<V>(0)};
      V mean = number<V>(0), rise[3];
      for (std::size_t k = 0; k < 3; ++k) {
        arm[k] = vector_at<V>(rows.arm[k], lane);
        const Wide3<V> to = turn_into(axis, arm[k]), plus = vector_at<V>(rows.weight[k], lane),
                       minus = vector_at<V>(rows.weight[3 + k], lane);
        const V ahead = field(at + to), behind = field(at - to);
        const Wide3<V> one = ahead * plus, other = behind * minus;
        force = force + (one + other);
        moment = moment + cross(arm[k], one - other);
        normal = normal + (plus + minus);
        mean = mean + number<V>(1.0 / 6) * (ahead + behind);
        rise[k] = number<V>(0.5) * (ahead - behind);
      }
      const PositiveInSquare<V> in = positive_in_square(mean, rise[0], rise[1]);
      const Wide3<V> lean = number<V>(1.0 / 3) * (rise[0] * arm[0] + rise[1] * arm[1]),
                     part = in.along[0] * arm[0] + in.along[1] * arm[1];
      force = in.mean * normal + in.share * (force - mean * normal);
      moment = cross(part, normal) + in.share * (moment - cross(lean, normal));
      moment = moment + cross(centre, force);
      add_wrench(turn_into(axis, force), turn_into(axis, moment), lane, sums);
      touched += count_of(lanes_with(force));
    }
  }
  return PatchBlock::kWidth * touched;
}

template <class V>
std::uint32_t tile_blocks(const BlockList& list, const TileFrame& tile, BodySums& sums) {
  const TileNumbers<V> numbers = numbers_of<V>(tile);
  return sum_blocks<V>(
      list, tile.axis, in_all_lanes<V>(tile.origin),
      [&](Wide3<V> p) LUMBRICAL_INLINE { return tile_field(numbers, tile_point(p)); }, sums);
}
template <class V>
std::uint32_t palm_blocks(const BlockList& list, const PalmBody& palm, BodySums& sums) {
  return sum_blocks<V>(
      list, palm.axis, Wide3<V>{V(0.0f), V(0.0f), V(0.0f)},
      [&](Wide3<V> p) LUMBRICAL_INLINE { return palm_field(palm, p); }, sums);
}

}  // namespace lumbrical::LUMBRICAL_ISA
