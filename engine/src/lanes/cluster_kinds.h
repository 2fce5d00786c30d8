// Which clusters of triangles can be used as a whole, which hold nothing of a primitive, and which have to be
// looked into. One source for every instruction set; lanes never meet, so the answers are the same with all.
#pragma once

#include <cstring>

#include "lanes/cluster_field.h"
#include "lumbrical/model.h"

namespace lumbrical::LUMBRICAL_ISA {

// Sixteen clusters: four blocks side by side.
struct ClusterRow {
  static constexpr std::size_t kWidth = 16;
  alignas(64) float x[kWidth], y[kWidth], z[kWidth], r[kWidth];
  alignas(64) float nx[kWidth], ny[kWidth], nz[kWidth], thickness[kWidth];
  alignas(64) float bx[kWidth], by[kWidth], bz[kWidth], edge[kWidth];
};

inline void put_block(const ClusterBlock& block, std::size_t place, ClusterRow& row) {
  constexpr std::size_t kBytes = sizeof(block.x);
  const std::size_t first = place * ClusterBlock::kWidth;
  std::memcpy(row.x + first, block.x.data(), kBytes);
  std::memcpy(row.y + first, block.y.data(), kBytes);
  std::memcpy(row.z + first, block.z.data(), kBytes);
  std::memcpy(row.r + first, block.r.data(), kBytes);
  std::memcpy(row.nx + first, block.nx.data(), kBytes);
  std::memcpy(row.ny + first, block.ny.data(), kBytes);
  std::memcpy(row.nz + first, block.nz.data(), kBytes);
  std::memcpy(row.thickness + first, block.thickness.data(), kBytes);
  std::memcpy(row.bx + first, block.bx.data(), kBytes);
  std::memcpy(row.by + first, block.by.data(), kBytes);
  std::memcpy(row.bz + first, block.bz.data(), kBytes);
  std::memcpy(row.edge + first, block.edge.data(), kBytes);
}

struct ClusterBits {
  unsigned use = 0, split = 0, open = 0;
};

template <class V>
inline ClusterBits kinds_in_row(const ClusterRow& row, const ClusterQuery& query) {
  const V zero = number<V>(0), one = number<V>(1), slack(query.slack), allowed(query.allowed);
  const Wide3<V> origin{V(query.x), V(query.y), V(query.z)};
  const auto shape = in_all_lanes<V>(query.shape);
  ClusterBits bits;
  for (std::size_t i = 0; i < ClusterRow::kWidth; i += wide::Lanes<V>::kCount) {
    const V r = get(row.r + i, V{}), thickness = get(row.thickness + i, V{});
    const Wide3<V> p = Wide3<V>{get(row.x + i, V{}), get(row.y + i, V{}), get(row.z + i, V{})} - origin;
    const Wide3<V> normal{get(row.nx + i, V{}), get(row.ny + i, V{}), get(row.nz + i, V{})};
    const Wide3<V> box{get(row.bx + i, V{}), get(row.by + i, V{}), get(row.bz + i, V{})};
    V gone = zero;                  // wholly beyond a cut
    V through = zero, near = zero;  // cuts through it; borders in reach, which may be anything but cones
    for (int k = 0; k < query.cut_count; ++k) {
      const CutShape<float>& cut = query.cut[k];
      const V height = beyond(cut, p);
      const V reach = V(cut.steep) * (r + slack) + V(query.margin[k]);
      gone = choose(height >= reach, one, gone);
      const V crossed = choose(height <= zero - reach, zero, one);
      through = through + crossed;
      if (query.margin[k] > 0) near = near + crossed;
    }
    const CentreField<V> at = field_at(shape, p);
    const ClusterBounds<V> bounds = bounds_of(at, shape.jointed, ClusterReach<V>{r, normal, thickness, box});
    const auto met = both(r >= zero, both(gone == zero, at.phi > zero - (bounds.rise + slack)));
    const V ramp = choose(at.phi >= bounds.fall + slack, zero, number<V>(kRampRest) * bounds.fall);
    const auto fits = both(bounds.rest + ramp <= allowed, thickness * at.phi <= V(query.twist));
    const auto good = both(through == zero, fits);
    // Over a triangle the field is above the corners' plane by so much at most (leaf_contact.cpp).
    const V edge = get(row.edge + i, V{});
    const V square = lesser(number<V>(0.5) * (r * r), number<V>(1.0 / 6) * (edge * edge));
    const V above = shape.flat ? zero : square * one_over(bounds.gap);
    const auto few = both(near == zero, through <= number<V>(LeafTerms::kCutCapacity));
    const auto straight = both(bounds.rest < number<V>(1), above <= allowed);
    bits.use |= wide::bits_of(both(met, good), zero) << i;
    bits.split |= wide::bits_of(both(met, both(few, straight)), zero) << i;
    bits.open |= wide::bits_of(met, zero) << i;
  }
  bits.split &= ~bits.use;
  bits.open &= ~bits.use;
  return bits;
}

inline std::size_t put_numbers(unsigned bits, const std::uint32_t* blocks, std::uint32_t* numbers) {
  std::size_t count = 0;
  for (; bits != 0; bits &= bits - 1) {
    const auto lane = static_cast<std::uint32_t>(__builtin_ctz(bits));
    numbers[count++] =
        blocks[lane / ClusterBlock::kWidth] * ClusterBlock::kWidth + lane % ClusterBlock::kWidth;
  }
  return count;
}

/// Adds the clusters of the blocks listed to `hits`, in their order.
template <class V>
void cluster_kinds(const ClusterBlock* blocks, const ClusterQuery& query, const std::uint32_t* list,
                   std::size_t count, ClusterHits& hits) {
  constexpr std::size_t kGroup = ClusterRow::kWidth / ClusterBlock::kWidth, kAhead = 8;
  ClusterRow row;
  for (std::size_t i = 0; i < count; i += kGroup) {
    for (std::size_t k = 0; k < kGroup; ++k) {
      if (i + k + kAhead < count) {
        const ClusterBlock& soon = blocks[list[i + k + kAhead]];
        __builtin_prefetch(&soon.x);
        __builtin_prefetch(&soon.nx);
        __builtin_prefetch(&soon.bx);
      }
      if (i + k < count) {
        put_block(blocks[list[i + k]], k, row);
      } else {
        put_block(blocks[list[i]], k, row);  // any, made an empty one
        for (std::size_t lane = 0; lane < ClusterBlock::kWidth; ++lane)
          row.r[k * ClusterBlock::kWidth + lane] = -1;
      }
    }
    ClusterBits bits = kinds_in_row<V>(row, query);
    if (hits.leaves) {
      bits.open &= ~bits.split;
      hits.split_count += put_numbers(bits.split, list + i, hits.split + hits.split_count);
    }
    hits.use_count += put_numbers(bits.use, list + i, hits.use + hits.use_count);
    hits.open_count += put_numbers(bits.open, list + i, hits.open + hits.open_count);
  }
}

}  // namespace lumbrical::LUMBRICAL_ISA
