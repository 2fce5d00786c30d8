#include "samples/sample_search.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "base/at_least.h"
#include "base/parallel.h"

namespace lumbrical {
namespace {

// Patches of the blocks that are classified at a time.
constexpr std::size_t kSpare = kBlocksAtATime * PatchBlock::kWidth;

// Listed patches, the last time, below which threads cost more than they bring.
constexpr std::size_t kSerialBelow = 1600;

// Blocks of which some bodies have found patches, ascending; there is room for one more than all.
std::span<const std::uint32_t> blocks_found(const PatchSearchMemory& memory, std::uint64_t parts,
                                            std::span<std::uint32_t> blocks) {
  auto end = blocks.begin();
  const auto leave_out_doubles = [&] {
    std::sort(blocks.begin(), end);
    end = std::unique(blocks.begin(), end);
  };
  for (std::size_t body = 0; body < memory.found.size(); ++body) {
    if (parts_of_body(parts, body) == 0) continue;
    for (const FoundPatches& found : memory.found[body]) {
      if (is_block(kind_of(found))) continue;
      if (end == blocks.end()) leave_out_doubles();
      *end++ = found.block;
    }
  }
  leave_out_doubles();
  return {blocks.begin(), end};
}

// Bodies that are not felt but may be in the way of others: of the blocks that those have found patches of.
void find_in_the_way(const HandSearch& search, PatchSearchMemory& memory) {
  const Bodies& bodies = search.bodies;
  PatchSearcher& searcher = memory.searcher[0];
  const std::uint64_t parts = parts_of(bodies);
  for (std::size_t body = 0; body <= bodies.finger_count; ++body) {
    if (is_felt(bodies, body)) continue;
    std::uint64_t others = 0;
    for_numbers(parts_of_body(parts, body), [&](std::size_t k) {
      others |= felt_of(bodies, searcher.rivals->of(body * Bodies::kTilesApart + k));
    });
    if (others == 0) continue;
    CentroidForce unused;
    const SearchFrom from{SearchFrom::Where::blocks, {}, blocks_found(memory, others, searcher.frontier[1])};
    memory.found[body] = find_for_body(search, body, from, searcher, unused);
  }
}

// Bodies are shared out among the searchers, whoever is free. False where they find too much.
bool find_all(const HandSearch& search, bool open, PatchSearchMemory& memory) {
  const Bodies& bodies = search.bodies;
  const std::size_t threads = memory.listed < kSerialBelow ? 1 : memory.searcher.size();
  const std::size_t most = most_patches(search.model);
  for (PatchSearcher& searcher : memory.searcher) {
    searcher.count = 0;
    searcher.rivals.emplace(search.hand, bodies);
    if (open) std::swap(searcher.found, searcher.before);
  }
  const auto before = memory.found;
  memory.found.fill({});
  if (!open) std::fill_n(memory.force.begin(), bodies.finger_count + 1, CentroidForce{});
  const std::size_t count = bodies.finger_count + (bodies.palm.corner_count > 0 ? 1 : 0);
  std::atomic<std::size_t> next{0};
  parallel_chunks(threads, 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      PatchSearcher& searcher = memory.searcher[k];
      for (std::size_t turn = next++; turn < count && searcher.count <= most; turn = next++) {
        const std::size_t body = count - 1 - turn;  // the palm takes longest
        if (!is_felt(bodies, body)) continue;
        SearchFrom from;
        if (open) from = {SearchFrom::Where::before, before[body], {}};
        CentroidForce unused;
        memory.found[body] = find_for_body(search, body, from, searcher, open ? unused : memory.force[body]);
      }
    }
  });
  find_in_the_way(search, memory);
  std::size_t total = 0;
  for (const PatchSearcher& searcher : memory.searcher) total += searcher.count;
  return total <= most;
}

}  // namespace

void size_search(const Model& model, PatchSearchMemory& memory) {
  const Patches& patches = *model.patches;
  const std::size_t most = most_patches(model);
  const std::size_t blocks = std::max(most_blocks(model), frontier_capacity(patches.tree.head));
  size_cuts(model, memory.cuts);
  at_least(model.execution.threads, memory.searcher);
  for (PatchSearcher& searcher : memory.searcher) {
    for (auto& frontier : searcher.frontier) at_least(blocks + 1, frontier);
    at_least(most + std::max(patches.block.size(), kSpare), searcher.found);
    at_least(searcher.found.size(), searcher.before);  // they change places, and models take turns
  }
}

bool find_patches(const Model& model, const Primitives& hand, const Bodies& bodies,
                  PatchSearchMemory& memory) {
  return find_all({model, hand, bodies, memory.cuts}, false, memory);
}
bool open_patches(const Model& model, const Primitives& hand, const Bodies& bodies,
                  PatchSearchMemory& memory) {
  return find_all({model, hand, bodies, memory.cuts}, true, memory);
}

bool found_any(const PatchSearchMemory& memory) {
  return std::any_of(memory.found.begin(), memory.found.end(),
                     [](const auto& of_body) { return !of_body.empty(); });
}

double force_at_centroids(const Bodies& bodies, const PatchSearchMemory& memory) {
  double sum = 0;
  for (std::size_t body = 0; body <= bodies.finger_count; ++body) {
    if (!is_felt(bodies, body)) continue;
    const auto& lane = memory.force[body].lane;
    sum += 0.5 * norm(Vec3{sum_of(lane[0]), sum_of(lane[1]), sum_of(lane[2])});
  }
  return sum;
}

}  // namespace lumbrical
