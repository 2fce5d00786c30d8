// What several bodies of a hand hold together (sample_kernels.h): which patches that are, and what of their
// fields a part of the hand leaves to those that are deeper there.
#pragma once

#include <optional>

#include "samples/classify.h"

namespace lumbrical::LUMBRICAL_ISA {

/// Spheres of a tree, by their centres, and the fields there.
template <class V>
struct Spheres {
  Wide3<V> centre;  // [m] from the tree's origin
  [[nodiscard]] V field_of(const TileFrame& tile, std::uint32_t, Wide3<V> offset) const {
    const Wide3<V> p = turn_into(tile.axis, centre - (offset + in_all_lanes<V>(tile.origin)));
    return tile_field(numbers_of<V>(tile), TilePoint<V>{p.x, p.y * p.y + p.z * p.z});
  }
  [[nodiscard]] V field_of(const PalmBody& palm, Wide3<V> offset) const {
    return palm_field(palm, turn_into(palm.axis, centre - offset));
  }
};

/// Patches as discs: kNowhere of what they don't meet.
template <class V>
struct MetDiscs {
  Discs<V> discs;
  [[nodiscard]] Discs<V> from(Wide3<V> offset) const {
    return {discs.centre - offset, discs.radius, discs.reach, discs.normal};
  }
  [[nodiscard]] V field_of(const TileFrame& tile, std::uint32_t k, Wide3<V> offset) const {
    return view_tile(tile, k, from(offset)).field;
  }
  [[nodiscard]] V field_of(const PalmBody& palm, Wide3<V> offset) const {
    const V field = palm_field(palm, turn_into(palm.axis, discs.centre - offset));
    const auto meets = discs.radius >= number<V>(0) && field + discs.reach > number<V>(0);
    return select(meets, field, number<V>(kNowhere));
  }
};

/// The fields of the parts of a hand that have rivals, and of its bodies: of each the largest of those. The
/// palm, which costs as much as several tiles, is asked where a finger is above `least`, and else nowhere.
template <class V>
struct PartFields {
  V part[Rivals::kParts];
  V body[Bodies::kMostFingers + 1];
  V second = number<V>(kNowhere);  // the largest but one of all bodies

  template <class Shape>
  PartFields(const Bodies& bodies, std::uint64_t parts, const BodyOffsets& offset, const Shape& shape,
             V least) {
    V first = number<V>(kNowhere);
    for (std::size_t i = 0; i < bodies.finger_count; ++i) {
      const std::uint64_t tiles = parts >> i * Bodies::kTilesApart & bodies.finger[i].tiles();
      body[i] = number<V>(kNowhere);
      for_numbers(tiles, [&](std::size_t k) LUMBRICAL_INLINE {
        const V field = shape.field_of(bodies.finger[i].tile[k], static_cast<std::uint32_t>(k),
                                       in_all_lanes<V>(offset[i]));
        part[i * Bodies::kTilesApart + k] = field;
        body[i] = max(body[i], field);
      });
      second = max(second, min(first, body[i]));
      first = max(first, body[i]);
    }
    const std::size_t palm = palm_number(bodies), i = bodies.finger_count;
    body[i] = part[palm] = number<V>(kNowhere);
    if ((parts >> palm & 1u) == 0 || !any(first > least)) return;
    body[i] = part[palm] = shape.field_of(bodies.palm, in_all_lanes<V>(offset[i]));
    second = max(second, min(first, body[i]));
  }
};

/// Of each block's sixteen spheres those that two bodies may reach, and which parts do.
template <class V>
std::size_t overlap_hits(const SphereBlock* spheres, const Bodies& bodies, const BodyOffsets& offset,
                         float slack, const SharedBlock* blocks, std::size_t block_count, SharedBlock* hits) {
  const SharedBlock* const begin = hits;
  for (std::size_t i = 0; i < block_count; ++i) {
    const SphereBlock& block = spheres[blocks[i].place];
    for (unsigned lane = 0; lane < SphereBlock::kWidth;
         lane += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
      const Spheres<V> centres{{get(block.x.data() + lane, V{}), get(block.y.data() + lane, V{}),
                                get(block.z.data() + lane, V{})}};
      const V reach = get(block.r.data() + lane, V{}) + V(slack), least = number<V>(0) - reach;
      const PartFields<V> fields(bodies, blocks[i].parts, offset, centres, least);
      const unsigned shared = wide::bits_of(reach > number<V>(0) && fields.second > least);
      if (shared == 0) continue;
      SharedBlock* const of_lanes = hits;
      for (unsigned open = shared; open != 0; open &= open - 1)
        *hits++ = {
            blocks[i].place * SphereBlock::kWidth + lane + static_cast<std::uint32_t>(__builtin_ctz(open)),
            0};
      for_numbers(blocks[i].parts, [&](std::size_t part) LUMBRICAL_INLINE {
        const unsigned reached = wide::bits_of(fields.part[part] > least);
        SharedBlock* hit = of_lanes;
        for (unsigned open = shared; open != 0; open &= open - 1, ++hit)
          hit->parts |= std::uint64_t{reached >> static_cast<std::uint32_t>(__builtin_ctz(open)) & 1u}
                        << part;
      });
    }
  }
  return static_cast<std::size_t>(hits - begin);
}

/// Where a part of the hand may be the deepest of its body, and other bodies deeper yet: a bit per lane for
/// each of those.
struct RivalLanes {
  unsigned of_body[Bodies::kMostFingers + 1] = {}, any = 0;
};
template <class V>
inline RivalLanes rival_lanes(const PartFields<V>& fields, std::size_t part, std::uint64_t rivals, V reach) {
  RivalLanes lanes;
  const V nowhere = number<V>(kNowhere), twice = reach + reach, own = fields.part[part];
  const auto is_deepest = own > nowhere && own + twice > fields.body[part / Bodies::kTilesApart];
  if (!any(is_deepest)) return lanes;
  for (std::size_t i = 0; i <= Bodies::kMostFingers; ++i, rivals >>= Bodies::kTilesApart) {
    if ((rivals & ((1u << Bodies::kTilesApart) - 1)) == 0) continue;
    const V other = fields.body[i];
    lanes.of_body[i] = wide::bits_of(is_deepest && (other > nowhere && other + twice > own));
    lanes.any |= lanes.of_body[i];
  }
  return lanes;
}

/// Lists the lanes of a part's patches that have rivals, as ListedPatch has them.
inline ListedPatch* list_rivals(const RivalLanes& rivals, std::uint32_t first, std::size_t number,
                                ListedPatch* to) {
  for (unsigned open = rivals.any; open != 0; open &= open - 1) {
    const auto lane = static_cast<std::uint32_t>(__builtin_ctz(open));
    std::uint32_t bodies = 0;
    for (std::uint32_t i = 0; i <= Bodies::kMostFingers; ++i) bodies |= (rivals.of_body[i] >> lane & 1u) << i;
    *to++ = {first + lane, static_cast<std::uint32_t>(number) + ListedPatch::kRivals * bodies};
  }
  return to;
}

/// The patches of a block that a part may have to leave to other bodies; returns how many.
template <class V>
std::size_t overlap_patches(const PatchBlock* blocks, const Bodies& bodies, const Rivals& rivals,
                            const BodyOffsets& offset, const SplitPoint& origin, const SharedBlock& block,
                            ListedPatch* patches) {
  ListedPatch* to = patches;
  for (unsigned lane = 0; lane < PatchBlock::kWidth; lane += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
    const Discs<V> discs = discs_of<V>(blocks[block.place], origin, offset.largest, lane);
    const V nowhere = number<V>(kNowhere);
    const PartFields<V> fields(bodies, block.parts, offset, MetDiscs<V>{discs}, nowhere);
    if (!any(fields.second > nowhere)) continue;
    for_numbers(block.parts, [&](std::size_t part) LUMBRICAL_INLINE {
      const RivalLanes lanes = rival_lanes(fields, part, rivals.of[part] & block.parts, discs.reach);
      if (lanes.any != 0) to = list_rivals(lanes, block.place * PatchBlock::kWidth + lane, part, to);
    });
  }
  return static_cast<std::size_t>(to - patches);
}

/// Shares of the largest radius: by which rounding may move a field, generously; and a lead that is more than
/// rounding. Where two bodies have a field in common, the first one has it.
inline constexpr float kOverlapSlack = 1e-4f, kTie = 4e-6f;

/// The largest of some parts' fields over the patches of a register, each given a lead: `most` bounds what
/// lanes that a part is nothing to are told of it.
template <class V>
struct LargestField {
  struct Tile {
    PatchInFrame<V> patch;
    TileNumbers<V> tile;
    V most, lead;
    [[nodiscard]] TilePoint<V> at(V u, V v) const {
      const Wide3<V> p = patch.at(u, v);
      return {p.x, p.y * p.y + p.z * p.z};
    }
    [[nodiscard]] LUMBRICAL_INLINE V field(V u, V v) const {
      return min(tile_field(tile, at(u, v)) + lead, most);
    }
  };
  std::size_t count = 0;
  Tile tile[Bodies::kMostFingers * FingerBody::kMostTiles];
  std::optional<PalmNearby<V>> palm;
  PatchInFrame<V> palm_patch;
  V palm_most, palm_lead;

  void add(const PatchRows& rows, std::size_t lane, const TileFrame& frame, Wide3<V> offset,
           V most = number<V>(1e30), V lead = number<V>(0)) {
    tile[count++] = {see_patch(rows, lane, frame.axis, offset + in_all_lanes<V>(frame.origin)),
                     numbers_of<V>(frame), most, lead};
  }
  void add(const PatchRows& rows, std::size_t lane, const PalmBody& body, Wide3<V> offset,
           V most = number<V>(1e30), V lead = number<V>(0)) {
    palm_patch = see_patch(rows, lane, body.axis, offset);
    palm.emplace(body, palm_patch);
    palm_most = most;
    palm_lead = lead;
  }
  [[nodiscard]] LUMBRICAL_INLINE V field(V u, V v) const {
    V largest = number<V>(kNowhere);
    for (std::size_t k = 0; k < count; ++k) largest = max(largest, tile[k].field(u, v));
    if (palm) largest = max(largest, min(palm->field(palm_patch.at(u, v)) + palm_lead, palm_most));
    return largest;
  }
  /// Leaves out tiles that are below `level` at the patches' centroids.
  void leave_out(V level) {
    const V third = number<V>(1.0 / 3);
    std::size_t left = 0;
    for (std::size_t k = 0; k < count; ++k) {
      if (any(tile[k].field(third, third) >= level)) tile[left++] = tile[k];
    }
    count = left;
  }
};

/// A tile, or the palm, on patches that it shares with other bodies: its field, and by how much a point is
/// more its own than its neighbours' in its finger.
template <class V>
struct OwnPart {
  PatchInFrame<V> patch;
  LargestField<V> field;
  LargestField<V> kin;  // its finger's other tiles as far as they are near, tile `place[k]` each
  const FingerBody* finger = nullptr;
  std::size_t tile = 0, place[FingerBody::kMostTiles] = {};

  [[nodiscard]] V lead(V u, V v) const {
    V least = number<V>(1e30);
    for (std::size_t k = 0; k < kin.count; ++k) least = min(least, lead_over(k, u, v));
    return least;
  }
  [[nodiscard]] V lead_over(std::size_t k, V u, V v) const {
    const auto &own = field.tile[0], &other = kin.tile[k];
    if (place[k] + 1 == tile) return side(tile - 1, other, own, u, v);
    if (place[k] == tile + 1) return number<V>(0) - side(tile, own, other, u, v);
    return own.field(u, v) - tile_field(other.tile, other.at(u, v));
  }
  template <class Tile>
  V side(std::size_t joint, const Tile& inner, const Tile& outer, V u, V v) const {
    return side_of_joint(numbers_of<V>(finger->joint[joint]), inner.tile,
                         place_on(inner.tile, inner.at(u, v)), outer.tile,
                         place_on(outer.tile, outer.at(u, v)));
  }
};

template <class V>
inline OwnPart<V> see_own(const PatchRows& rows, std::size_t lane, const Bodies& bodies, std::size_t part,
                          float largest) {
  const Wide3<V> zero{number<V>(0), number<V>(0), number<V>(0)};
  OwnPart<V> own;
  if (part == palm_number(bodies)) {
    own.field.add(rows, lane, bodies.palm, zero);
    own.patch = own.field.palm_patch;
    return own;
  }
  own.finger = &bodies.finger[part / Bodies::kTilesApart];
  own.tile = part % Bodies::kTilesApart;
  own.field.add(rows, lane, own.finger->tile[own.tile], zero);
  own.patch = own.field.tile[0].patch;
  const V third = number<V>(1.0 / 3),
          limit = number<V>(2.001) * size_of(own.patch) + V(kOverlapSlack * largest);
  for (std::size_t k = 0; k < own.finger->tile_count; ++k) {
    const std::size_t apart = k > own.tile ? k - own.tile : own.tile - k;
    if (apart != 1 && !(apart == 2 && own.finger->folded)) continue;
    const std::size_t last = own.kin.count;
    own.place[last] = k;
    own.kin.add(rows, lane, own.finger->tile[k], zero);
    const auto is_near = own.lead_over(last, third, third) <= limit;
    own.kin.tile[last].most = select(is_near, number<V>(1e30), number<V>(kNowhere));
    if (!any(is_near)) own.kin.count = last;
  }
  return own;
}

/// The other bodies that may be deeper than `body`, each in its lanes, by their parts in `rivals`.
template <class V>
inline LargestField<V> see_rivals(const PatchRows& rows, std::size_t lane, const Bodies& bodies,
                                  std::size_t body, std::uint64_t rivals, const BodyOffsets& offset, V size) {
  V most[Bodies::kMostFingers + 1];
  for (V& of : most) of = number<V>(kNowhere);
  std::uint32_t open = 0;
  for_tiles<V>(rows, lane, [&](std::uint32_t code, bool, auto its) LUMBRICAL_INLINE {
    const std::uint32_t of_code = code / ListedPatch::kRivals;
    for (std::uint32_t left = of_code; left != 0; left &= left - 1) {
      V& of = most[__builtin_ctz(left)];
      of = select(its, number<V>(1e30), of);
    }
    open |= of_code;
  });
  LargestField<V> seen;
  for_numbers(rivals, [&](std::size_t part) LUMBRICAL_INLINE {
    const std::size_t i = part / Bodies::kTilesApart;
    if ((open >> i & 1u) == 0) return;
    const Wide3<V> from = in_all_lanes<V>(offset[i]);
    const V lead((i < body ? kTie : -kTie) * offset.largest);
    if (part == palm_number(bodies)) return seen.add(rows, lane, bodies.palm, from, most[i], lead);
    seen.add(rows, lane, tile_at(bodies.finger.data(), part), from, most[i], lead);
  });
  const V third = number<V>(1.0 / 3);
  seen.leave_out(seen.field(third, third) - number<V>(2.001) * size - V(kOverlapSlack * offset.largest));
  return seen;
}

/// What a corner of a lattice is told by: the part's field, by how much the point is more its own than its
/// neighbours', and by how much other bodies are deeper than its own.
template <class V>
struct OverlapCorner {
  V own, lead, lack;
};

template <class V>
struct OverlapCentre {
  V own, lack;
};

/// Takes off the sums of a part what other bodies are deeper in than it. All patches are listed for that
/// part.
template <class V>
void overlap_lattice(const PatchList& list, const Bodies& bodies, std::size_t part, std::uint64_t others,
                     const BodyOffsets& offset, std::size_t steps, BodySums& sums) {
  for_rows<V>(list, [&](const PatchRows& rows, std::size_t lane) LUMBRICAL_INLINE {
    const OwnPart<V> own = see_own<V>(rows, lane, bodies, part, offset.largest);
    const LargestField<V> rivals =
        see_rivals(rows, lane, bodies, part / Bodies::kTilesApart, others, offset, size_of(own.patch));
    CellSums<V> cells;
    for_cells<OverlapCorner<V>, OverlapCentre<V>>(
        steps, [](float u) LUMBRICAL_INLINE { return V(u); },
        [&](V u, float v) LUMBRICAL_INLINE {
          const V field = own.field.field(u, V(v));
          const V of_body = max(field, own.kin.field(u, V(v)));
          return OverlapCorner<V>{field, own.lead(u, V(v)), rivals.field(u, V(v)) - of_body};
        },
        [&](V u, float v) LUMBRICAL_INLINE {
          const V field = own.field.field(u, V(v));
          return OverlapCentre<V>{field, rivals.field(u, V(v)) - max(field, own.kin.field(u, V(v)))};
        },
        [&](float u, float v, bool upright, const OverlapCorner<V>& a, const OverlapCorner<V>& b,
            const OverlapCorner<V>& c, const OverlapCentre<V>& centre) LUMBRICAL_INLINE {
          const V level = mean_of(a.own, b.own, c.own), floor = drop_of(level, centre.own);
          const Cell<V> cell = lowered_cell(a.own, b.own, c.own, level, floor);
          const auto where = [&](V at_a, V at_b, V at_c) LUMBRICAL_INLINE {
            return share_of_part_above(at_a, at_b, at_c, a.own, b.own, c.own, floor, cell.mean);
          };
          const V drop = drop_of(mean_of(a.lack, b.lack, c.lack), centre.lack);
          V share = where(a.lack - drop, b.lack - drop, c.lack - drop);
          if (own.kin.count > 0) share = share * where(a.lead, b.lead, c.lead);
          cells.add(V(u), V(v), upright, share * cell);
        });
    const auto [force, moment] = share_of(own.patch, cells.means(steps));
    const Wide3<V> zero{number<V>(0), number<V>(0), number<V>(0)};
    add_wrench(zero - force, zero - moment, lane, sums);
  });
}

}  // namespace lumbrical::LUMBRICAL_ISA
