#include "stages/broadphase.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "base/at_least.h"
#include "base/parallel.h"
#include "base/radix_sort.h"
#include "exact/exact_kernels.h"
#include "index/sphere_grid.h"
#include "index/sphere_tree.h"
#include "index/voxel_index.h"
#include "search/near_pairs.h"
#include "search/pair_search.h"

namespace lumbrical {
namespace {

constexpr std::uint32_t kBatch = MissTerms::kCapacity;

// Pairs below which threads cost more than they bring (measured, bench/results), when searching and when
// lists are gone through.
constexpr std::size_t kSerialSearch = 1024, kSerialLists = 16384;

// A list costs twice a search: no more than this many are made in a tick, so that none takes much longer than
// one without lists.
constexpr int kMostNew = 6;

// Ticks without lists after they did not fit.
constexpr std::uint32_t kRest = 1000;

Box box_round(const Primitives& hand, double skin) {
  Box box;
  for (std::size_t i = 0; i < hand.count; ++i) {
    const Primitive& primitive = hand.primitive[i];
    const double reach = (1 + 1e-6) * (max(primitive.radius1, primitive.radius2) + skin);
    box.add(primitive.end1, reach);
    box.add(primitive.end2, reach);
  }
  return box;
}

// What is to be done about each primitive.
struct Plan {
  double most_skin = 0;                                     // [m]
  std::array<bool, Primitives::kMaxCount> reuse{};          // the list at hand
  std::array<double, Primitives::kMaxCount> skin{};         // [m] to search with; 0: makes no list
  std::array<std::uint8_t, Primitives::kMaxCount> fresh{};  // those to be searched for
  std::size_t fresh_count = 0;
};

// A list is worth its price where it lives for a few ticks, so for a primitive that moves slowly. Of lists
// that are half used up the most used one gives way before it has to: else all would end in the same tick.
Plan make_plan(const Primitives& hand, bool lists, NearPairs& near) {
  const std::size_t count = hand.count;
  Plan plan;
  const SkinLimits limits = lists ? skin_limits(hand) : SkinLimits{};
  plan.most_skin = limits.most;
  double most_used = 0.5 * kUse;
  std::size_t eldest = count;
  for (std::size_t i = 0; limits.most > 0 && i < count; ++i) {
    const Hull& now = near.now[i];
    const NearPairs::List& list = near.list[i];
    const double used = list.skin > 0 ? distance_moved(list.at, now) / list.skin : 1;
    plan.reuse[i] = used <= kUse;
    plan.skin[i] = skin_for(distance_moved(near.last[i], now), limits);
    if (!plan.reuse[i] || !(plan.skin[i] > 0) || !(used > most_used)) continue;
    most_used = used;
    eldest = i;
  }
  if (eldest < count) plan.reuse[eldest] = false;
  int made = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (plan.reuse[i]) continue;
    plan.fresh[plan.fresh_count++] = static_cast<std::uint8_t>(i);
    if (plan.skin[i] > 0 && made++ >= kMostNew) plan.skin[i] = 0;
  }
  return plan;
}

// Searches for the primitives of `fresh`, shared out over as many threads as there is memory for. What is
// found comes in any order.
void search_shared(const Model& model, const Primitives& hand, const Plan& plan, std::uint32_t threads,
                   std::span<const std::uint32_t> cells, Scratch& scratch, FoundPairs& found) {
  const ExactKernels& kernels = exact_kernels(model.execution.isa);
  std::atomic<std::size_t> next{0};
  const auto work = [&](std::size_t first, std::size_t last) {
    MissTerms terms;
    for (std::size_t searcher = first; searcher < last; ++searcher) {
      PairSearch search{model, hand, kernels, scratch.searcher[searcher], terms, found};
      for (std::size_t k = next++; k < plan.fresh_count; k = next++) {
        const std::size_t i = plan.fresh[k];
        search.index = i;
        search.hull = &scratch.near->now[i];
        search.skin = plan.skin[i];
        const std::size_t start = found.count;
        if (!search_for(search, cells)) return;
        // One after the other they are in order, each by itself; a sort of all has little left to do then.
        if (threads == 1) radix_sort(found.room.subspan(start, found.count - start), scratch.sorting);
      }
    }
  };
  parallel_chunks(threads, 1, threads, work);
}

// How many threads pay for searches: by what was found last time, since nothing else is known.
std::uint32_t threads_for_search(const Model& model, const Plan& plan, const Scratch& scratch) {
  std::size_t pairs = 0;
  for (std::size_t k = 0; k < plan.fresh_count; ++k) pairs += scratch.near->list[plan.fresh[k]].count;
  if (pairs < kSerialSearch || model.execution.broadphase == Broadphase::brute) return 1;
  return static_cast<std::uint32_t>(scratch.searcher.size());
}

// Searches for the primitives that need it and puts what is found behind the lists that stay.
bool search_fresh(const Model& model, const Primitives& hand, const Plan& plan, Scratch& scratch) {
  NearPairs& near = *scratch.near;
  const std::uint32_t threads = threads_for_search(model, plan, scratch);
  keep_lists(plan.reuse, near);
  std::span<const std::uint32_t> cells;
  if (model.execution.broadphase == Broadphase::grid)
    cells = {scratch.cells.data(), find_cells(model.grid, box_round(hand, plan.most_skin), scratch.cells)};
  FoundPairs found{std::span(near.pairs).subspan(near.size)};
  search_shared(model, hand, plan, threads, cells, scratch, found);
  if (found.count > found.room.size()) return false;
  const std::span<std::uint64_t> pairs = found.room.first(found.count);
  radix_sort(pairs, scratch.sorting);
  std::size_t next = 0;
  for (std::size_t k = 0; k < plan.fresh_count; ++k) {
    const std::size_t i = plan.fresh[k], first = next;
    while (next < pairs.size() && pairs[next] >> 33 == i) ++next;
    NearPairs::List& list = near.list[i];
    if (plan.skin[i] > 0) list.at = near.now[i];
    list.skin = plan.skin[i];
    list.first = near.size + first;
    list.count = next - first;
  }
  near.size += pairs.size();
  return true;
}

constexpr std::uint64_t kMissed = ~std::uint64_t{0};

// Asks about up to kBatch unclear pairs; those that miss are marked in `to`.
void ask(const Triangles& world, const ExactKernels& kernels, const Hull& hull,
         std::span<const std::uint32_t> places, std::uint64_t* to) {
  MissTerms terms;
  set_terms(hull, 0, terms);
  std::array<std::uint32_t, kBatch> triangles;
  for (std::size_t k = 0; k < places.size(); ++k) triangles[k] = static_cast<std::uint32_t>(to[places[k]]);
  set_triangles(world, {triangles.data(), places.size()}, terms);
  kernels.certain_misses(terms);
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (terms.miss[k] != 0) to[places[k]] = kMissed;
  }
}

// Writes a list's pairs to `to`, those that certainly miss as kMissed. Returns how many were unclear.
std::size_t write_list(const Model& model, const Hull& now, std::span<const std::uint64_t> pairs,
                       std::uint64_t* to) {
  const ExactKernels& kernels = exact_kernels(model.execution.isa);
  std::array<std::uint32_t, kBatch> places;
  std::size_t open = 0, asked = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    to[k] = pairs[k] >> 1;
    places[open] = static_cast<std::uint32_t>(k);
    open += pairs[k] & 1;
    if (open < kBatch) continue;
    ask(model.triangles, kernels, now, {places.data(), open}, to);
    asked += open;
    open = 0;
  }
  if (open > 0) ask(model.triangles, kernels, now, {places.data(), open}, to);
  return asked + open;
}

// From the lists to the candidates; false where they don't fit. Every list has places of its own, so the
// order of the work doesn't matter.
bool write_candidates(const Model& model, const Primitives& hand, Scratch& scratch) {
  NearPairs& near = *scratch.near;
  const std::size_t lists = hand.count;
  std::array<std::size_t, Primitives::kMaxCount> place{}, unclear{};
  std::size_t total = 0;
  for (std::size_t i = 0; i < lists; ++i) {
    place[i] = total;
    total += near.list[i].count;
  }
  if (total > scratch.candidates.size()) return false;
  std::uint64_t* const to = scratch.candidates.data();
  const std::uint32_t threads = total < kSerialLists ? 1 : model.execution.threads;
  parallel_chunks(lists, 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::span pairs = std::span(near.pairs).subspan(near.list[i].first, near.list[i].count);
      unclear[i] = write_list(model, near.now[i], pairs, to + place[i]);
    }
  });
  const std::size_t asked = std::accumulate(unclear.begin(), unclear.end(), std::size_t{0});
  std::size_t count = asked > 0 ? 0 : total;
  for (std::size_t k = 0; asked > 0 && k < total; ++k) {
    to[count] = to[k];
    count += to[k] != kMissed;
  }
  near.asked = static_cast<std::uint32_t>(asked);
  scratch.candidate_count = static_cast<std::uint32_t>(count);
  return true;
}

bool try_find(const Model& model, const Primitives& hand, bool lists, Scratch& scratch) {
  const Plan plan = make_plan(hand, lists, *scratch.near);
  scratch.near->searches = static_cast<std::uint32_t>(plan.fresh_count);
  return (plan.fresh_count == 0 || search_fresh(model, hand, plan, scratch)) &&
         write_candidates(model, hand, scratch);
}

}  // namespace

void size_candidates(const Model& model, Scratch& scratch) {
  const std::size_t all_pairs = Primitives::kMaxCount * model.triangles.size();
  const std::size_t capacity = std::min<std::size_t>(model.settings.max_candidates, all_pairs);
  at_least(capacity, scratch.candidates);
  at_least(capacity, scratch.sorting);
  if (!scratch.near) scratch.near = std::make_shared<NearPairs>();
  at_least(capacity, scratch.near->pairs);
  at_least(capacity, scratch.near->other);
  std::size_t frontier_size = std::max<std::size_t>(frontier_capacity(model.tree.head), model.grid.frontier);
  if (model.voxels) frontier_size = std::max(frontier_size, frontier_capacity(model.voxels->wide.head));
  at_least(model.execution.threads, scratch.searcher);
  for (SearchMemory& searcher : scratch.searcher) {
    for (auto& frontier : searcher.frontier) at_least(frontier_size, frontier);
    at_least(model.voxels ? model.voxels->lists.voxel.size() : 0, searcher.cells);
  }
  at_least(model.grid.tree.size(), scratch.cells);
}

bool find_candidates(const Model& model, const Primitives& hand, Scratch& scratch) {
  scratch.candidate_count = 0;
  NearPairs& near = *scratch.near;
  near.searches = near.asked = 0;
  if (hand.count == 0 || model.triangles.size() == 0) return true;
  const bool other_world = near.build != model.build;
  near.build = model.build;
  for (std::size_t i = 0; i < hand.count; ++i) set_hull(hand.primitive[i], hand.palm, near.now[i]);
  if (near.rest > 0) --near.rest;
  const bool lists = scratch.keep_near && !other_world && near.rest == 0 && model.build != 0 &&
                     model.execution.broadphase != Broadphase::brute;
  bool fits = try_find(model, hand, lists, scratch);
  if (!fits && lists) {
    near.rest = kRest;
    fits = try_find(model, hand, false, scratch);
  }
  near.now.swap(near.last);
  return fits;
}

}  // namespace lumbrical
