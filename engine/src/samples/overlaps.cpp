#include "samples/overlaps.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <tuple>

#include "base/at_least.h"
#include "base/prefetch.h"
#include "base/set_bits.h"

namespace lumbrical {
namespace {

constexpr std::uint32_t kLanes = PatchBlock::kWidth;

// What a block's patches may be listed for.
constexpr std::size_t kMostOfBlock = kLanes * (Bodies::kMostFingers * FingerBody::kMostTiles + 1);

// The tiles that share patches of a kind, a bit each from the body's first on; the palm's is its first.
constexpr std::array<std::uint8_t, kind::kCount> kPartsOfKind = [] {
  std::array<std::uint8_t, kind::kCount> parts{};
  for (std::uint32_t k = 0; k < kind::kCount; ++k)
    parts[k] = static_cast<std::uint8_t>(((1u << sharers_of(k)) - 1) << kTileOfKind[k]);
  return parts;
}();

using FoundByBody = std::span<const std::span<const FoundPatches>>;

std::uint16_t lanes_of(unsigned lanes) { return static_cast<std::uint16_t>(lanes); }

// The parts of a body that an entry is about.
std::uint64_t parts_in(const FoundPatches& found, std::size_t body) {
  return std::uint64_t{kPartsOfKind[kind_of(found)]} << body * Bodies::kTilesApart;
}

std::uint32_t place_in(const FoundPatches& entry, std::size_t lane) {
  return entry.block * kLanes + static_cast<std::uint32_t>(lane);
}

template <class Take>
void for_entries(FoundByBody found, const Take& take) {
  for (std::size_t body = 0; body < found.size(); ++body) {
    for (const FoundPatches& entry : found[body]) take(body, entry);
  }
}

// ---- Who meets what ----

// Marks what bodies have found and lists the blocks that they share patches of.
void mark_blocks(FoundByBody found, Overlaps& overlaps) {
  overlaps.any_whole = false;
  overlaps.taken_again.clear();
  overlaps.shared.clear();
  for_entries(found, [&](std::size_t, const FoundPatches& entry) {
    if (!is_block(kind_of(entry))) prefetch(&overlaps.met[entry.block], sizeof(MetLanes));
  });
  for_entries(found, [&](std::size_t body, const FoundPatches& entry) {
    if (is_block(kind_of(entry))) {
      const auto part = static_cast<std::uint8_t>(std::countr_zero(parts_in(entry, body)));
      std::uint8_t& by = overlaps.taken_by[entry.block];
      overlaps.any_whole = true;
      if (by != 0) overlaps.taken_again.push_back({entry.block, part});
      if (by == 0) by = static_cast<std::uint8_t>(part + 1);
      return;
    }
    MetLanes& met = overlaps.met[entry.block];
    const unsigned again = met.once & entry.lanes;
    if (again != 0 && met.again == 0) {
      met.number = static_cast<std::uint32_t>(overlaps.shared.size());
      overlaps.shared.push_back({entry.block});
    }
    met.again = lanes_of(met.again | again);
    met.once = lanes_of(met.once | entry.lanes);
  });
}

void unmark_blocks(FoundByBody found, Overlaps& overlaps) {
  for_entries(found, [&](std::size_t, const FoundPatches& entry) {
    if (is_block(kind_of(entry))) {
      overlaps.taken_by[entry.block] = 0;
    } else {
      overlaps.met[entry.block] = {};
    }
  });
}

// Entries of parts that share space with no others are their body's alone.
bool has_rivals(Rivals& rivals, std::uint64_t parts) {
  bool any = false;
  for_numbers(parts, [&](std::size_t part) { any = any || rivals.of(part) != 0; });
  return any;
}

// Of the parts that an entry is about those that share no space with a part that takes its block as one: that
// one is deeper throughout than all others, which were not asked.
std::uint64_t untaken_of(const Patches& patches, const Overlaps& overlaps, Rivals& rivals,
                         std::uint64_t parts, std::uint32_t block) {
  if (!overlaps.any_whole || block >= patches.block.size()) return parts;
  for (const std::uint32_t first : patches.first_samples) {
    if (const std::uint8_t by = overlaps.taken_by[first + block]; by != 0) {
      parts &= ~rivals.of(by - 1u);
      for (const TakenBlock& taken : overlaps.taken_again)
        if (taken.block == first + block) parts &= ~rivals.of(taken.part);
    }
    block /= kBlocksInLarger;
  }
  return parts;
}

// Calls take(entry) about those of its tiles that are left, as if the others were not near: for neighbours
// together, for the ends of a finger one after the other.
template <class Take>
void for_untaken(const Patches& patches, const Overlaps& overlaps, Rivals& rivals, const FoundPatches& entry,
                 std::size_t body, const Take& take) {
  const std::uint64_t parts = parts_in(entry, body),
                      left = untaken_of(patches, overlaps, rivals, parts, entry.block);
  if (left == parts) return take(entry);
  for (std::uint64_t tiles = parts_of_body(left, body); tiles != 0;) {
    const auto first = static_cast<std::uint32_t>(std::countr_zero(tiles));
    const bool has_two = has_bit(tiles, first + 1);
    const std::uint32_t kind = has_two ? kind::kInnerJoint + first : kind::kTile + first;
    take({static_cast<std::uint16_t>(entry.key - kind_of(entry) + kind), entry.lanes, entry.block});
    tiles &= ~((has_two ? std::uint64_t{3} : 1) << first);
  }
}

void see_sharers(const Patches& patches, FoundByBody found, Rivals& rivals, Overlaps& overlaps) {
  for_entries(found, [&](std::size_t body, const FoundPatches& entry) {
    if (is_block(kind_of(entry))) return;
    const MetLanes& met = overlaps.met[entry.block];
    const unsigned lanes = met.again & entry.lanes;
    if (lanes == 0 || !has_rivals(rivals, parts_in(entry, body))) return;
    SharedBlock& shared = overlaps.shared[met.number];
    for_untaken(patches, overlaps, rivals, entry, body, [&](const FoundPatches& left) {
      shared.of_body[body] = lanes_of(shared.of_body[body] | lanes);
      shared.parts |= parts_in(left, body);
      if (sharers_of(kind_of(left)) > 1) shared.at_joint = lanes_of(shared.at_joint | lanes);
      // Alone, what goes through the palm's polygon is exact. A lattice meets the kink there.
      if (class_of(left) >= kPatchSizes || kind_of(left) == kind::kPalmThrough)
        shared.near_skeleton = lanes_of(shared.near_skeleton | lanes);
    });
  });
}

// Of a patch in an entry: near a skeleton where any body that shares it has it so.
std::uint32_t class_in(const SharedBlock& shared, const FoundPatches& entry, std::size_t lane) {
  return static_cast<std::uint32_t>(class_of(entry) % kPatchSizes +
                                    kPatchSizes * (shared.near_skeleton >> lane & 1u));
}

// Lanes that at least one of some bodies has, at least two, and more.
struct LaneCounts {
  unsigned once = 0, twice = 0, more = 0;
  void add(unsigned lanes) {
    more |= twice & lanes;
    twice |= once & lanes;
    once |= lanes;
  }
};

// What goes through which kernel. Of two fingers in one block each has a single tile there, or they are left
// to what takes any.
void sort_lanes(const Bodies& bodies, SharedBlock& shared) {
  const unsigned palm = shared.of_body[bodies.finger_count];
  LaneCounts fingers;
  unsigned plain = ~unsigned{shared.at_joint};
  for (std::size_t i = 0; i < bodies.finger_count; ++i) {
    const unsigned lanes = shared.of_body[i];
    const std::uint64_t tiles = parts_of_body(shared.parts, i);
    if ((tiles & (tiles - 1)) != 0) plain &= ~lanes;
    fingers.add(lanes);
  }
  shared.of_tile = lanes_of(fingers.once & ~fingers.twice & palm & ~shared.at_joint);
  shared.of_two = lanes_of(fingers.twice & ~fingers.more & plain);
  shared.of_others = lanes_of(((fingers.once & palm) | fingers.twice) & ~(shared.of_tile | shared.of_two));
}

// Leaves a block to bodies of which any part near it shares space with others that are near.
void leave_to_rivals(Rivals& rivals, SharedBlock& shared) {
  std::uint64_t sharing = 0;
  for_numbers(shared.parts, [&](std::size_t part) {
    sharing |= std::uint64_t{(rivals.of(part) & shared.parts) != 0} << part;
  });
  if (sharing == shared.parts) return;
  for (std::size_t i = 0; i < std::size(shared.of_body); ++i) {
    if (parts_of_body(sharing, i) != 0) continue;
    shared.of_body[i] = 0;
    shared.parts &= ~(parts_of_body(shared.parts, i) << i * Bodies::kTilesApart);
  }
}

// Leaves patches to those who have a say in them.
void part_lanes(const Model& model, const CutPatches& cuts, const Bodies& bodies, Rivals& rivals,
                Overlaps& overlaps) {
  const Vec3 middle = bodies.finger_count > 0 ? bodies.finger[0].origin : bodies.palm.origin;
  const BodyOffsets offsets = offsets_from(middle, bodies);
  const SplitPoint origin = split_point(middle);
  const auto outdone_lanes = sample_kernels(model.execution.isa).outdone_lanes;
  for (SharedBlock& shared : overlaps.shared) {
    leave_to_rivals(rivals, shared);
    if (shared.parts == 0) continue;
    outdone_lanes(block_at(*model.patches, cuts, shared.block), bodies, shared.parts, offsets, origin,
                  shared.outdone);
    for (std::size_t i = 0; i <= bodies.finger_count; ++i) {
      shared.outdone[i] = lanes_of(shared.outdone[i] & shared.of_body[i]);
      shared.of_body[i] = lanes_of(shared.of_body[i] & ~shared.outdone[i]);
    }
    sort_lanes(bodies, shared);
  }
}

// ---- What is left to whom ----

/// Lists what is found, as long as there is room.
struct Lists {
  const Bodies& bodies;
  Overlaps& overlaps;
  std::size_t kept = 0, together = 0, by_parts = 0;

  // Lanes of a finger's entry, by the first of two fingers.
  void add_together(const FoundPatches& entry, std::size_t body, unsigned lanes, const SharedBlock& shared) {
    const auto first = static_cast<std::uint32_t>(body * Bodies::kTilesApart) + kTileOfKind[kind_of(entry)];
    for_numbers(lanes, [&](std::size_t lane) {
      const auto is_of = [&](std::size_t i) { return has_bit(shared.of_body[i], lane); };
      const bool has_two = has_bit(shared.of_two, lane), has_palm = is_of(bodies.finger_count);
      std::size_t other = body + 1;
      while (has_two && other < bodies.finger_count && !is_of(other)) ++other;
      if (has_two && other == bodies.finger_count) return;  // listed by the other finger
      const std::uint64_t second =
          has_two ? parts_of_body(shared.parts, other) << other * Bodies::kTilesApart : 0;
      overlaps.parts |= std::uint64_t{1} << first | second | std::uint64_t{has_palm} << palm_number(bodies);
      std::uint32_t code = first;
      if (has_two) code += ListedPatch::kSecond * static_cast<std::uint32_t>(std::countr_zero(second));
      if (!has_palm) code += ListedPatch::kWithoutPalm;
      overlaps.found_together[together++] = {
          {place_in(entry, lane), code},
          static_cast<std::uint32_t>(has_two ? kPatchClasses : 0) + class_in(shared, entry, lane)};
    });
  }
  void add_by_parts(const FoundPatches& entry, std::size_t body, unsigned lanes, const SharedBlock& shared) {
    for_numbers(lanes, [&](std::size_t lane) {
      overlaps.found_by_parts[by_parts++] = {place_in(entry, lane), class_in(shared, entry, lane),
                                             parts_in(entry, body)};
    });
  }
};

// Takes out of a body's entry the lanes that are not its alone and lists them; returns those that it keeps.
unsigned part_entry(const FoundPatches& entry, std::size_t body, Lists& lists) {
  const MetLanes& met = lists.overlaps.met[entry.block];
  if ((met.again & entry.lanes) == 0) return entry.lanes;
  const SharedBlock& shared = lists.overlaps.shared[met.number];
  const unsigned lanes = entry.lanes & ~shared.outdone[body], sharing = lanes & shared.of_body[body],
                 together = sharing & (shared.of_tile | shared.of_two), others = sharing & shared.of_others;
  if (body < lists.bodies.finger_count) lists.add_together(entry, body, together, shared);
  lists.add_by_parts(entry, body, others, shared);
  return lanes & ~(together | others);
}

// What each body that is felt keeps; false where lists are too long.
bool part_entries(const Patches& patches, FoundByBody found, Rivals& rivals, Lists& lists) {
  Overlaps& overlaps = lists.overlaps;
  const std::size_t most = overlaps.found_together.size() - kMostOfBlock;
  for (std::size_t body = 0; body < found.size(); ++body) {
    const std::size_t begin = lists.kept;
    for (const FoundPatches& entry : found[body]) {
      if (is_block(kind_of(entry))) {
        overlaps.kept[lists.kept++] = entry;
        continue;
      }
      for_untaken(patches, overlaps, rivals, entry, body, [&](const FoundPatches& left) {
        const unsigned lanes = part_entry(left, body, lists);
        if (lanes != 0) overlaps.kept[lists.kept++] = {left.key, lanes_of(lanes), left.block};
      });
      if (std::max({lists.kept, lists.together, lists.by_parts}) > most) return false;
    }
    if (!is_felt(lists.bodies, body)) lists.kept = begin;
    overlaps.left[body] = std::span(overlaps.kept).subspan(begin, lists.kept - begin);
  }
  return true;
}

// ---- Order ----

// From a list to another one in order of their keys, where each key's begin in `begin`.
template <std::size_t N>
void put_in_order(std::span<const FoundTogether> found, std::array<std::uint32_t, N>& begin,
                  std::vector<ListedPatch>& listed) {
  for (const FoundTogether& shared : found) ++begin[shared.key + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  auto next = begin;
  for (const FoundTogether& shared : found) listed[next[shared.key]++] = shared.patch;
}

// The parts of each patch in one, and patches of the same class and parts in a row.
void put_by_parts_in_order(std::span<FoundByParts> found, Overlaps& overlaps) {
  std::sort(found.begin(), found.end(), [](const FoundByParts& a, const FoundByParts& b) {
    return std::tie(a.place, a.parts) < std::tie(b.place, b.parts);
  });
  std::size_t count = 0;
  for (const FoundByParts& patch : found) {
    if (count > 0 && found[count - 1].place == patch.place) {
      found[count - 1].parts |= patch.parts;
    } else {
      found[count++] = patch;
    }
  }
  found = found.first(count);
  std::sort(found.begin(), found.end(), [](const FoundByParts& a, const FoundByParts& b) {
    return std::tie(a.patch_class, a.parts, a.place) < std::tie(b.patch_class, b.parts, b.place);
  });
  auto& begin = overlaps.by_parts_begin;
  for (std::size_t i = 0; i < count; ++i) {
    const FoundByParts& patch = found[i];
    ++begin[patch.patch_class + 1];
    overlaps.parts |= patch.parts;
    overlaps.parts_of[i] = patch.parts;
    overlaps.by_parts[i] = {patch.place, static_cast<std::uint32_t>(std::countr_zero(patch.parts))};
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
}

}  // namespace

void size_overlaps(const Model& model, Overlaps& overlaps) {
  const Patches& patches = *model.patches;
  const std::size_t blocks = most_blocks(model);
  at_least(blocks, overlaps.met);
  at_least(patches.samples.size(), overlaps.taken_by);
  const std::size_t most = std::min<std::size_t>(model.settings.max_candidates, blocks * kMostOfBlock);
  overlaps.shared.reserve(std::min(blocks, most));
  overlaps.taken_again.reserve(most);
  at_least(most + kMostOfBlock, overlaps.kept);
  at_least(most + kMostOfBlock, overlaps.found_together);
  at_least(most + kMostOfBlock, overlaps.together);
  at_least(most + kMostOfBlock, overlaps.found_by_parts);
  at_least(most + kMostOfBlock, overlaps.by_parts);
  at_least(most + kMostOfBlock, overlaps.parts_of);
}

bool part_overlaps(const Model& model, const CutPatches& cuts, const Bodies& bodies, Rivals& rivals,
                   FoundByBody found, Overlaps& overlaps) {
  overlaps.forget();
  const auto has_any = [](const auto& of_body) { return !of_body.empty(); };
  if (model.settings.felt_once == FeltOnce::never || std::count_if(found.begin(), found.end(), has_any) < 2) {
    std::copy(found.begin(), found.end(), overlaps.left.begin());
    return true;
  }
  mark_blocks(found, overlaps);
  see_sharers(*model.patches, found, rivals, overlaps);
  part_lanes(model, cuts, bodies, rivals, overlaps);
  Lists lists{bodies, overlaps};
  const bool has_room = part_entries(*model.patches, found, rivals, lists);
  unmark_blocks(found, overlaps);
  put_in_order(std::span(overlaps.found_together).first(lists.together), overlaps.together_begin,
               overlaps.together);
  put_by_parts_in_order(std::span(overlaps.found_by_parts).first(lists.by_parts), overlaps);
  return has_room;
}

}  // namespace lumbrical
