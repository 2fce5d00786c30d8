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
    const Kinds<V> kinds = palm_kinds(palm, from(offset));
    return select(kinds.kind >= number<V>(0), kinds.field, number<V>(kNowhere));
  }
};

/// The fields of all parts of a hand, and of its bodies: of each the largest of its parts.
template <class V>
struct PartFields {
  std::size_t body_count = 0;
  V part[(Bodies::kMostFingers + 1) * Bodies::kTilesApart];
  V body[Bodies::kMostFingers + 1];
  V second = number<V>(kNowhere);  // the largest but one of all bodies

  template <class Shape>
  PartFields(const Bodies& bodies, const BodyOffsets& offset, const Shape& shape) {
    V first = number<V>(kNowhere);
    const auto end_body = [&](V field) LUMBRICAL_INLINE {
      body[body_count++] = field;
      second = max(second, min(first, field));
      first = max(first, field);
    };
    for (std::size_t i = 0; i < bodies.finger_count; ++i) {
      const FingerBody& finger = bodies.finger[i];
      V largest = number<V>(kNowhere);
      for (std::size_t k = 0; k < finger.tile_count; ++k) {
        const V field =
            shape.field_of(finger.tile[k], static_cast<std::uint32_t>(k), in_all_lanes<V>(offset[i]));
        part[i * Bodies::kTilesApart + k] = field;
        largest = max(largest, field);
      }
      end_body(largest);
    }
    if (bodies.palm.corner_count == 0) return;
    const std::size_t i = bodies.finger_count;
    part[i * Bodies::kTilesApart] = shape.field_of(bodies.palm, in_all_lanes<V>(offset[i]));
    end_body(part[i * Bodies::kTilesApart]);
  }
};

/// Spheres that two bodies may reach.
template <class V>
std::size_t overlap_hits(const SphereBlock* spheres, const Bodies& bodies, const BodyOffsets& offset,
                         float slack, const std::uint32_t* blocks, std::size_t block_count,
                         std::uint32_t* hits) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < block_count; ++i) {
    const SphereBlock& block = spheres[blocks[i]];
    for (unsigned lane = 0; lane < SphereBlock::kWidth;
         lane += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
      const Spheres<V> centres{{get(block.x.data() + lane, V{}), get(block.y.data() + lane, V{}),
                                get(block.z.data() + lane, V{})}};
      const V reach = get(block.r.data() + lane, V{}) + V(slack);
      const PartFields<V> fields(bodies, offset, centres);
      unsigned bits = wide::bits_of(reach > number<V>(0) && fields.second + reach > number<V>(0));
      for (; bits != 0; bits &= bits - 1)
        hits[count++] =
            blocks[i] * SphereBlock::kWidth + lane + static_cast<std::uint32_t>(__builtin_ctz(bits));
    }
  }
  return count;
}

/// Where a part of the hand may be the deepest of its body, and other bodies deeper yet: a bit per lane for
/// each of those.
struct Rivals {
  unsigned of_body[Bodies::kMostFingers + 1] = {}, any = 0;
};
template <class V>
inline Rivals rivals_of(const PartFields<V>& fields, std::size_t body, std::size_t part, V reach) {
  Rivals rivals;
  const V nowhere = number<V>(kNowhere), twice = reach + reach, own = fields.part[part];
  const auto is_deepest = own > nowhere && own + twice > fields.body[body];
  if (!any(is_deepest)) return rivals;
  for (std::size_t i = 0; i < fields.body_count; ++i) {
    if (i == body) continue;
    const V other = fields.body[i];
    rivals.of_body[i] = wide::bits_of(is_deepest && (other > nowhere && other + twice > own));
    rivals.any |= rivals.of_body[i];
  }
  return rivals;
}

/// Lists the lanes of a part's patches that have rivals, as ListedPatch has them.
inline ListedPatch* list_rivals(const Rivals& rivals, std::uint32_t first, std::size_t number,
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
std::size_t overlap_patches(const PatchBlock* blocks, const Bodies& bodies, const BodyOffsets& offset,
                            const SplitPoint& origin, std::uint32_t block, ListedPatch* patches) {
  ListedPatch* to = patches;
  for (unsigned lane = 0; lane < PatchBlock::kWidth; lane += static_cast<unsigned>(wide::Lanes<V>::kCount)) {
    const Discs<V> discs = discs_of<V>(blocks[block], origin, offset.largest, lane);
    const PartFields<V> fields(bodies, offset, MetDiscs<V>{discs});
    if (!any(fields.second > number<V>(kNowhere))) continue;
    for (std::size_t body = 0; body < fields.body_count; ++body) {
      const std::size_t tiles = body < bodies.finger_count ? bodies.finger[body].tile_count : 1;
      for (std::size_t k = 0; k < tiles; ++k) {
        const std::size_t part = body * Bodies::kTilesApart + k;
        const Rivals rivals = rivals_of(fields, body, part, discs.reach);
        if (rivals.any != 0) to = list_rivals(rivals, block * PatchBlock::kWidth + lane, part, to);
      }
    }
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
    [[nodiscard]] V field(V u, V v) const { return min(tile_field(tile, at(u, v)) + lead, most); }
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
  [[nodiscard]] V field(V u, V v) const {
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

/// The other bodies that may be deeper than `body`, each in its lanes.
template <class V>
inline LargestField<V> see_rivals(const PatchRows& rows, std::size_t lane, const Bodies& bodies,
                                  std::size_t body, const BodyOffsets& offset, V size) {
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
  LargestField<V> rivals;
  for (; open != 0; open &= open - 1) {
    const auto i = static_cast<std::size_t>(__builtin_ctz(open));
    const Wide3<V> from = in_all_lanes<V>(offset[i]);
    const V lead((i < body ? kTie : -kTie) * offset.largest);
    if (i == bodies.finger_count) {
      rivals.add(rows, lane, bodies.palm, from, most[i], lead);
      continue;
    }
    for (std::size_t k = 0; k < bodies.finger[i].tile_count; ++k)
      rivals.add(rows, lane, bodies.finger[i].tile[k], from, most[i], lead);
  }
  const V third = number<V>(1.0 / 3);
  rivals.leave_out(rivals.field(third, third) - number<V>(2.001) * size - V(kOverlapSlack * offset.largest));
  return rivals;
}

/// What a corner of a lattice is told by: the part's field, by how much the point is more its own than its
/// neighbours', and by how much other bodies are deeper than its own.
template <class V>
struct OverlapCorner {
  V own, lead, lack;
};

/// Takes off the sums of a part what other bodies are deeper in than it. All patches are listed for that
/// part.
template <class V>
void overlap_lattice(const PatchList& list, const Bodies& bodies, std::size_t part, const BodyOffsets& offset,
                     std::size_t steps, BodySums& sums) {
  for_rows<V>(list, [&](const PatchRows& rows, std::size_t lane) LUMBRICAL_INLINE {
    const OwnPart<V> own = see_own<V>(rows, lane, bodies, part, offset.largest);
    const LargestField<V> rivals =
        see_rivals(rows, lane, bodies, part / Bodies::kTilesApart, offset, size_of(own.patch));
    CellSums<V> cells;
    for_cells<OverlapCorner<V>, V>(
        steps, [](float u) LUMBRICAL_INLINE { return V(u); },
        [&](V u, float v) LUMBRICAL_INLINE {
          const V field = own.field.field(u, V(v));
          const V of_body = max(field, own.kin.field(u, V(v)));
          return OverlapCorner<V>{field, own.lead(u, V(v)), rivals.field(u, V(v)) - of_body};
        },
        [&](V u, float v) LUMBRICAL_INLINE { return own.field.field(u, V(v)); },
        [&](float u, float v, bool upright, const OverlapCorner<V>& a, const OverlapCorner<V>& b,
            const OverlapCorner<V>& c, V centre) LUMBRICAL_INLINE {
          const V zero = number<V>(0), of_a = max(a.own, zero), of_b = max(b.own, zero),
                  of_c = max(c.own, zero), of_all = of_a + (of_b + of_c);
          const auto where = [&](V at_a, V at_b, V at_c) LUMBRICAL_INLINE {
            return share_where_positive(at_a, at_b, at_c, of_a, of_b, of_c, of_all);
          };
          V share = where(a.lack, b.lack, c.lack);
          if (own.kin.count > 0) share = share * where(a.lead, b.lead, c.lead);
          cells.add(V(u), V(v), upright, share * cell_of(a.own, b.own, c.own, centre));
        });
    const auto [force, moment] = share_of(own.patch, cells.means(steps));
    const Wide3<V> zero{number<V>(0), number<V>(0), number<V>(0)};
    add_wrench(zero - force, zero - moment, lane, sums);
  });
}

}  // namespace lumbrical::LUMBRICAL_ISA
