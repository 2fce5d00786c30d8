#include "samples/near_patches.h"

#include <algorithm>
#include <utility>

#include "base/at_least.h"
#include "base/set_bits.h"

namespace lumbrical {
namespace {

/// Which of four lanes are set, and how many.
struct SetLanes {
  ListedPatch lane[4];
  std::uint32_t count;
};
constexpr std::array<SetLanes, 16> kSetLanes = [] {
  std::array<SetLanes, 16> all{};
  for (std::size_t bits = 0; bits < all.size(); ++bits) {
    for (std::uint32_t lane = 0; lane < 4; ++lane) {
      if (has_bit(bits, lane)) all[bits].lane[all[bits].count++].place = lane;
    }
  }
  return all;
}();

std::uint32_t lane_count(std::uint32_t lanes) {
  return kSetLanes[lanes & 15u].count + kSetLanes[lanes >> 4 & 15u].count +
         kSetLanes[lanes >> 8 & 15u].count + kSetLanes[lanes >> 12].count;
}

// Lists a run's patches, four lanes at a time, set or not: what is too much is written over by what follows.
ListedPatch* put_run(const PatchRun& run, ListedPatch* to) {
  if (run.lanes == 1) {  // as blocks are
    *to = {run.first, run.tile};
    return to + 1;
  }
  for (std::uint32_t from = 0; from < PatchBlock::kWidth; from += 4) {
    const SetLanes& set = kSetLanes[run.lanes >> from & 15u];
    for (std::size_t i = 0; i < 4; ++i)
      to[i] = {set.lane[i].place + (run.first + from), set.lane[i].tile + run.tile};
    to += set.count;
  }
  return to;
}

using CountByKey = std::array<std::uint32_t, kKeyCount + 1>;

// From how many there are of each key to where they begin; `classes`: a bit for each that has any.
void begin_in_order(std::uint32_t classes, CountByKey& by_key) {
  std::uint32_t sum = 0;
  for (std::size_t k = 0; k < kPatchClasses; ++k) {
    const auto of_class = std::span(by_key).subspan(k * kind::kCount, kind::kCount);
    if (!has_bit(classes, k)) {
      std::fill(of_class.begin(), of_class.end(), sum);
    } else {
      for (std::uint32_t& number : of_class) sum += std::exchange(number, sum);
    }
  }
  by_key[kKeyCount] = sum;
}

// Where each key's patches begin, in `near`, and, returned, its entries.
CountByKey count_keys(std::span<const std::span<const FoundPatches>> found, NearPatches& near) {
  CountByKey entries{};
  near.begin.fill(0);
  std::uint32_t classes = 0;
  for (const auto& of_body : found) {
    for (const FoundPatches& patches : of_body) {
      near.begin[patches.key] += lane_count(patches.lanes);
      ++entries[patches.key];
      classes |= 1u << class_of(patches);
    }
  }
  begin_in_order(classes, near.begin);
  begin_in_order(classes, entries);
  return entries;
}

// An entry of a body as patches that follow each other.
PatchRun run_of(const FoundPatches& found, std::size_t body) {
  const std::uint32_t what = kind_of(found);
  const bool at_far_end = what >= kind::kFarEnd && what < kind::kInside;
  return {is_block(what) ? found.block : found.block * PatchBlock::kWidth,
          static_cast<std::uint32_t>(body * Bodies::kTilesApart + kTileOfKind[what] +
                                     (at_far_end ? ListedPatch::kFarEnd : 0)),
          found.lanes};
}

// Lists the patches of each body's entries, by key and, within a key, body by body.
bool put_in_order(std::span<const std::span<const FoundPatches>> found, NearPatches& near) {
  CountByKey next = count_keys(found, near);
  if (near.count() > near.listed.size() - PatchBlock::kWidth) return false;
  const std::size_t run_count = next[kKeyCount];
  near.tiles = 0;
  near.innermost.fill(0);
  for (std::size_t body = 0; body < found.size(); ++body) {
    for (const FoundPatches& patches : found[body]) {
      const PatchRun run = near.runs[next[patches.key]++] = run_of(patches, body);
      const std::uint64_t innermost = std::uint64_t{1} << first_tile(run.tile);
      near.innermost[patches.key] |= innermost;
      for (std::uint32_t k = 0; k < sharers_of(kind_of(patches)); ++k) near.tiles |= innermost << k;
    }
  }
  ListedPatch* to = near.listed.data();
  for (const PatchRun& run : std::span(near.runs).first(run_count)) to = put_run(run, to);
  return true;
}

}  // namespace

void size_near(const Model& model, NearPatches& near) {
  at_least(most_patches(model), near.runs);
  at_least(most_patches(model) + PatchBlock::kWidth, near.listed);
  if (model.settings.felt_once != FeltOnce::never) size_overlaps(model, near.overlaps);
}

bool list_patches(const Model& model, const Bodies& bodies, PatchSearchMemory& memory, NearPatches& near) {
  Overlaps& overlaps = near.overlaps;
  const std::size_t body_count = bodies.finger_count + 1;
  if (part_overlaps(model, memory.cuts, bodies, *memory.searcher[0].rivals,
                    std::span(memory.found).first(body_count), overlaps) &&
      put_in_order(std::span(overlaps.left).first(body_count), near)) {
    near.tiles |= felt_of(bodies, overlaps.parts);
    memory.listed = near.count();
    return true;
  }
  near.forget();
  return false;
}

}  // namespace lumbrical
