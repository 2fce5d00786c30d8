#include "samples/sample_lists.h"

#include <algorithm>

#include "base/set_bits.h"

namespace lumbrical {
namespace {

/// Of every number of steps the parts of the hand whose lattices have so many, a bit each, and which there
/// are.
struct PartsBySteps {
  std::array<std::uint64_t, kMostSteps + 1> of{};
  std::uint64_t any = 0;

  void add(std::size_t part, std::size_t steps) {
    of[steps] |= std::uint64_t{1} << part;
    any |= std::uint64_t{1} << steps;
  }
};

PartsBySteps tiles_by_steps(const Bodies& bodies, std::size_t level, std::size_t patch_class) {
  PartsBySteps tiles;
  for (std::size_t i = 0; i < bodies.finger_count; ++i) {
    for (std::size_t k = 0; k < bodies.finger[i].tile_count; ++k)
      tiles.add(i * Bodies::kTilesApart + k, bodies.finger[i].steps[k][patch_class][level]);
  }
  return tiles;
}

// Patches of kinds `first` to `last`, shared by as many tiles, of which at least one of those is wanted.
PatchList wanted_of(SampleWork& work, std::uint32_t first, std::uint32_t last, std::size_t patch_class,
                    std::size_t steps, std::uint64_t wanted) {
  std::uint64_t innermost = 0;
  for (std::uint32_t k = 0; k < sharers_of(first); ++k) innermost |= wanted >> k;
  const auto is_wanted = [innermost](const ListedPatch& patch) {
    return has_bit(innermost, first_tile(patch.tile));
  };
  const std::uint64_t listed_for = work.near.tiles_of_kinds(first, last, patch_class);
  if ((listed_for & innermost) == 0) return {};
  const std::span<const ListedPatch> all = work.of_kinds(first, last, patch_class);
  PatchList list = work.list(all, steps);
  if ((listed_for & ~innermost) == 0) return list;
  list.patches = work.memory.chosen.data();
  list.count =
      static_cast<std::size_t>(std::copy_if(all.begin(), all.end(), work.memory.chosen.begin(), is_wanted) -
                               work.memory.chosen.begin());
  return list;
}

// Each tile's share goes by its own lattice, so that it does not change where a neighbour comes near or goes:
// what tiles of different lattices share is done once for each.
void run_fingers(SampleWork& work, std::size_t patch_class, std::size_t steps, const TileSums& sums) {
  const auto run = [&](std::uint32_t first, std::uint32_t last, const auto& kernel) {
    const PatchList list = wanted_of(work, first, last, patch_class, steps, sums.wanted);
    if (list.count > 0) work.memory.touched += kernel(list);
  };
  const auto run_part = [&](std::uint32_t first, std::uint32_t last, TilePart part) {
    run(first, last,
        [&](const PatchList& list) { return work.kernels.tile_lattice(list, work.fingers(), part, sums); });
  };
  run_part(kind::kTile, kind::kTile + 2, TilePart::whole);
  run_part(kind::kSide, kind::kSide + 2, TilePart::side);
  run_part(kind::kNearEnd, kind::kFarEnd + 2, TilePart::end);
  const auto run_shared = [&](std::uint32_t first, std::uint32_t last) {
    run(first, last, [&](const PatchList& list) {
      return work.kernels.shared_lattice(list, work.fingers(), sharers_of(first), sums);
    });
  };
  run_shared(kind::kInnerJoint, kind::kOuterJoint);
  run_shared(kind::kFinger, kind::kFinger);
}

// By the patch's size in steps.
std::size_t rule_for(std::size_t size) { return size < 1 ? 0 : size < 2 ? 1 : size < 5 ? 2 : 3; }

// What several bodies share, each by its own lattice.
void run_together(SampleWork& work, std::size_t patch_class, std::size_t steps, const TileSums& sums) {
  const Overlaps& overlaps = work.near.overlaps;
  for (const std::size_t tiles : {1, 2}) {
    const PatchList list = work.list(work.own_part(overlaps.together_of(tiles, patch_class)), steps);
    if (list.count > 0) work.memory.touched += work.kernels.deepest_lattice(list, work.bodies, tiles, sums);
  }
  const SharedPatches shared = overlaps.by_parts_of(patch_class);
  const PatchList list = work.list(work.own_part(shared.patches), steps);
  if (list.count == 0) return;
  const std::uint64_t* const parts = shared.parts + (list.patches - shared.patches.data());
  work.memory.touched += work.kernels.parts_lattice(list, work.bodies, parts, sums);
}

}  // namespace

void run_lattices(SampleWork& work, std::size_t patch_class, std::size_t level, Mix mix) {
  BodySums* const sums = work.sums(mix);
  PartsBySteps parts = tiles_by_steps(work.bodies, level, patch_class);
  for_numbers(parts.any, [&](std::size_t steps) {
    run_fingers(work, patch_class, steps, {sums, parts.of[steps]});
  });
  const PalmBody& palm = work.bodies.palm;
  if (palm.corner_count > 0) {
    const std::size_t number = palm_number(work.bodies), steps = palm.steps[patch_class][level];
    parts.add(number, steps);
    const PatchList list = work.list(work.of_kinds(kind::kPalm, kind::kPalm, patch_class), steps);
    if (list.count > 0) work.memory.touched += work.kernels.palm_lattice(list, palm, sums[number]);
  }
  if (!work.near.overlaps.has(patch_class)) return;
  for_numbers(parts.any, [&](std::size_t steps) {
    const std::uint64_t wanted = parts.of[steps] & work.near.tiles;
    if (wanted != 0) run_together(work, patch_class, steps, {sums, wanted});
  });
}

void run_smooth(SampleWork& work, std::size_t patch_class) {
  const TileSums sums{work.sums(Mix::once), ~std::uint64_t{0}};
  const PatchList inside = work.list(work.of_kinds(kind::kInside, kind::kInside + 2, patch_class)),
                  side = work.list(work.of_kinds(kind::kPalmSide, kind::kPalmSide, patch_class)),
                  through = work.list(work.of_kinds(kind::kPalmThrough, kind::kPalmThrough, patch_class));
  std::uint32_t& touched = work.memory.touched;
  if (inside.count > 0)
    touched += work.kernels.tile_rule(inside, work.fingers(), rule_for(patch_class), sums);
  BodySums& palm_sums = sums.of[palm_number(work.bodies)];
  if (side.count > 0) touched += work.kernels.palm_side(side, work.bodies.palm, palm_sums);
  if (through.count > 0) touched += work.kernels.palm_through(through, work.bodies.palm, palm_sums);
}

void run_blocks(SampleWork& work, std::size_t block_class) {
  const BlockSamples* const samples = work.patches.samples.data();
  const auto fingers = work.of_kinds(kind::kBlockInside, kind::kBlockInside + 2, block_class),
             palm = work.of_kinds(kind::kPalmBlock, kind::kPalmBlockBeside, block_class);
  for (std::size_t i = 0, end = 0; i < fingers.size(); i = end) {
    const std::uint32_t tile = fingers[i].tile;
    while (end < fingers.size() && fingers[end].tile == tile) ++end;
    const BlockList list{samples, fingers.data() + i, end - i, work.bodies.origin[body_of(tile)]};
    work.memory.touched +=
        work.kernels.tile_blocks(list, tile_at(work.fingers(), tile), work.sums(Mix::once)[tile]);
  }
  if (!palm.empty()) {
    const BlockList list{samples, palm.data(), palm.size(), work.bodies.origin[work.bodies.finger_count]};
    work.memory.touched +=
        work.kernels.palm_blocks(list, work.bodies.palm, work.sums(Mix::once)[palm_number(work.bodies)]);
  }
}

}  // namespace lumbrical
