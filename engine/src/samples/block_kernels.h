// Blocks of small patches as wholes: which are, and what a body feels of them.
#pragma once

#include "samples/classify.h"
#include "samples/palm_kernels.h"

namespace lumbrical::LUMBRICAL_ISA {

/// Sixteen blocks, a lane each, relative to a body's origin.
struct BlockRows {
  static constexpr std::size_t kWidth = PatchBlock::kWidth;
  alignas(64) float centre[3][kWidth];
  alignas(64) float radius[kWidth];
  alignas(64) float arm[3][3][kWidth];
  alignas(64) float extent[3][kWidth];
};
/// Those at places `found` >> `shift`.
inline void gather(const BlockSamples* blocks, const SplitPoint& origin, const std::uint32_t* found,
                   unsigned shift, std::size_t count, BlockRows& rows) {
  for (std::size_t lane = 0; lane < BlockRows::kWidth; ++lane) {
    const BlockSamples& block = blocks[found[lane < count ? lane : 0] >> shift];
    rows.radius[lane] = block.radius;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rows.centre[axis][lane] = difference(block.centre, origin, axis);
      rows.extent[axis][lane] = block.extent[axis];
      for (std::size_t k = 0; k < 3; ++k) rows.arm[k][axis][lane] = block.arm[k][axis];
    }
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
/// The kind that a block is listed as if a body takes it as one, and the largest one that it takes so [m].
struct TakenWhole {
  std::uint32_t kind;
  float size;
};
/// From kinds to blocks that have to be opened and those that are taken as wholes: `whole(kind, no skeleton
/// near)`. Places are given in `found`, from the bit `shift` on.
template <class Whole>
inline SampleKernels::Sorted part_blocks(const BlockKinds& kinds, const BlockSamples* blocks,
                                         const Whole& whole, unsigned shift, std::uint32_t first,
                                         std::uint32_t* found, std::size_t count, FoundPatches* patches,
                                         CentroidForce& force) {
  SampleKernels::Sorted sorted{0, 0};
  for (std::size_t lane = 0; lane < count; ++lane) {
    if (kinds.kind[lane] < 0) continue;
    const TakenWhole taken = whole(static_cast<std::uint32_t>(kinds.kind[lane]), !(kinds.is_near[lane] > 0));
    const std::uint32_t place = found[lane] >> shift;
    if (blocks[place].size <= taken.size) {
      patches[sorted.whole_count++] = {static_cast<std::uint16_t>(taken.kind), 1, first + place};
      const float field = kinds.field[lane] > 0 ? kinds.field[lane] : 0;
      for (std::size_t axis = 0; axis < 3; ++axis)  // in a lane of its own, whatever blocks are beside it
        force.lane[axis][place % BlockRows::kWidth] += field * blocks[place].normal[axis];
    } else {
      found[sorted.open_count++] = found[lane];
    }
  }
  return sorted;
}

/// Inside one tile, or, of the lowest level, where its skin goes through.
inline TakenWhole taken_by_finger(const FingerBody& finger, std::uint32_t kind, bool on_skin) {
  const std::uint32_t tile = kTileOfKind[kind];
  if (kind >= kind::kInside && kind < kind::kInnerJoint)
    return {kind::kBlockInside + tile, finger.block_radius[tile]};
  return {kind::kBlockInside + tile, kind < kind::kInside && on_skin ? finger.block_on_skin : -1};
}
/// Inside the palm's skin, or, of the lowest level, where that goes through.
inline TakenWhole taken_by_palm(const PalmBody& palm, std::uint32_t kind, bool on_skin) {
  if (kind == kind::kPalmBlock) return {kind, palm.block_radius[0]};
  if (kind == kind::kPalmBlockBeside) return {kind, palm.block_radius[1]};
  return {kind::kPalmBlockBeside, kind != kind::kPalmThrough && on_skin ? palm.block_on_skin : -1};
}

template <class V>
SampleKernels::Sorted sort_blocks(const BlockSamples* blocks, const FingerBody& finger, std::uint32_t first,
                                  std::uint32_t* found, std::size_t count, FoundPatches* patches,
                                  CentroidForce& force) {
  const float largest = largest_radius(finger);
  BlockRows rows;
  gather(blocks, split_point(finger.origin), found, 3, count, rows);
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
  for (std::size_t lane = 0; lane < count; ++lane) {
    const std::uint32_t tiles =
        (met[0] >> lane & 1u) | (met[1] >> lane & 1u) << 1 | (met[2] >> lane & 1u) << 2;
    found[lane] = (found[lane] & ~7u) | tiles;
  }
  return part_blocks(
      of, blocks,
      [&](std::uint32_t kind, bool is_clear) {
        return taken_by_finger(finger, kind, is_clear && first == 0);
      },
      3, first, found, count, patches, force);
}

template <class V>
SampleKernels::Sorted sort_palm_blocks(const BlockSamples* blocks, const PalmBody& palm, std::uint32_t first,
                                       std::uint32_t* found, std::size_t count, FoundPatches* patches,
                                       CentroidForce& force) {
  BlockRows rows;
  gather(blocks, split_point(palm.origin), found, 0, count, rows);
  BlockKinds of;
  for (unsigned lane = 0; lane < BlockRows::kWidth; lane += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
    const Boxes<V> boxes = boxes_of<V>(rows, lane, palm.radius);
    const auto [kind, is_near, near_field] = palm_kinds(palm, boxes);
    const V reach = boxes.reach;
    const V field = palm_field(palm, turn_into(palm.axis, boxes.centre)), distance = V(palm.radius) - field;
    const auto is_smooth = field > reach && distance >= number<V>(kSmoothReach) * reach;
    const auto is_beside = kind >= number<V>(kind::kPalmEdge) && is_smooth;
    put(of.kind + lane, select(is_beside, number<V>(kind::kPalmBlockBeside), kind));
    put(of.field + lane, field);
    put(of.is_near + lane, is_near);
  }
  return part_blocks(
      of, blocks,
      [&](std::uint32_t kind, bool is_clear) { return taken_by_palm(palm, kind, is_clear && first == 0); }, 0,
      first, found, count, patches, force);
}

/// The numbers of sixteen blocks, by number and lane.
struct SampleRows {
  static constexpr std::size_t kWidth = PatchBlock::kWidth;
  alignas(64) float centre[3][kWidth];
  alignas(64) float arm[3][3][kWidth];
  alignas(64) float weight[7][3][kWidth];  // + and - of each arm, then the centre's
};
inline void gather(const BlockList& list, std::size_t first, std::size_t count, SampleRows& rows) {
  for (std::size_t lane = 0; lane < SampleRows::kWidth; ++lane) {
    const bool real = lane < count;
    const BlockSamples& block = list.blocks[list.patches[first + (real ? lane : 0)].place];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rows.centre[axis][lane] = difference(block.centre, list.origin, axis);
      for (std::size_t k = 0; k < 3; ++k) {
        rows.arm[k][axis][lane] = block.arm[k][axis];
        rows.weight[2 * k][axis][lane] = real ? block.weight[0][k][axis] : 0.0f;
        rows.weight[2 * k + 1][axis][lane] = real ? block.weight[1][k][axis] : 0.0f;
      }
      rows.weight[6][axis][lane] = real ? block.centre_weight[axis] : 0.0f;
    }
  }
}

/// Adds what a body with this frame and field feels of the blocks, sample by sample where that is positive.
template <class V, class Field>
LUMBRICAL_INLINE inline std::uint32_t sum_blocks(const BlockList& list, const float (&axis)[3][3],
                                                 Wide3<V> frame_origin, const Field& field, BodySums& sums) {
  SampleRows rows;
  std::uint32_t touched = 0;
  for (std::size_t first = 0; first < list.count; first += SampleRows::kWidth) {
    const std::size_t left = list.count - first;
    gather(list, first, left < SampleRows::kWidth ? left : SampleRows::kWidth, rows);
    for (std::size_t lane = 0; lane < SampleRows::kWidth; lane += wide::Lanes<V>::kCount) {
      const Wide3<V> centre = vector_at<V>(rows.centre, lane) - frame_origin, at = turn_into(axis, centre);
      const auto depth = [&](Wide3<V> p) LUMBRICAL_INLINE { return max(field(p), number<V>(0)); };
      Wide3<V> force = depth(at) * vector_at<V>(rows.weight[6], lane);
      Wide3<V> moment{number<V>(0), number<V>(0), number<V>(0)};
      for (std::size_t k = 0; k < 3; ++k) {
        const Wide3<V> arm = vector_at<V>(rows.arm[k], lane), to = turn_into(axis, arm);
        const Wide3<V> one = depth(at + to) * vector_at<V>(rows.weight[2 * k], lane);
        const Wide3<V> other = depth(at - to) * vector_at<V>(rows.weight[2 * k + 1], lane);
        force = force + (one + other);
        moment = moment + cross(arm, one - other);
      }
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
      [&](Wide3<V> p) LUMBRICAL_INLINE {
        return tile_field(numbers, TilePoint<V>{p.x, p.y * p.y + p.z * p.z});
      },
      sums);
}
template <class V>
std::uint32_t palm_blocks(const BlockList& list, const PalmBody& palm, BodySums& sums) {
  return sum_blocks<V>(
      list, palm.axis, Wide3<V>{V(0.0f), V(0.0f), V(0.0f)},
      [&](Wide3<V> p) LUMBRICAL_INLINE { return palm_field(palm, p); }, sums);
}

}  // namespace lumbrical::LUMBRICAL_ISA
