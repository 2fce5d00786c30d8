#include "samples/body_search.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "base/prefetch.h"
#include "index/sphere_tree.h"
#include "model/primitive.h"
#include "samples/near_skeleton.h"
#include "search/tree_search.h"

namespace lumbrical {
namespace {

constexpr std::size_t kWidth = PatchBlock::kWidth;

/// How one body asks: which spheres of blocks it may meet, which blocks have to be opened, as what it meets
/// patches. Places are given as place << shift plus, if asked for, a bit per tile.
template <class Hits, class Sort, class Classify>
struct BodySearch {
  Hits hits;          // (spheres, blocks, count, with bits, to) -> count
  Sort sort;          // (level, found, count, to) -> Sorted
  Classify classify;  // (arrays, found, count, to) -> count
  float largest;      // [m] block that it may take as one
  std::uint32_t shift, every_tile;
};
template <class Hits, class Sort, class Classify>
BodySearch(Hits, Sort, Classify, float, std::uint32_t, std::uint32_t) -> BodySearch<Hits, Sort, Classify>;

// All spheres of the blocks that there are.
std::size_t every_sphere(std::span<const std::uint32_t> blocks, std::size_t spheres, bool with_bits,
                         std::uint32_t shift, std::uint32_t bits, std::uint32_t* to) {
  std::size_t count = 0;
  for (const std::uint32_t block : blocks) {
    for (std::uint32_t i = block * SphereBlock::kWidth; i < (block + 1) * SphereBlock::kWidth && i < spheres;
         ++i)
      to[count++] = with_bits ? i << shift | bits : i;
  }
  return count;
}

// All blocks in larger ones, of `all` that there are, with the bits of those.
template <class Search>
std::size_t every_block(const Search& search, std::span<const std::uint32_t> larger, std::size_t all,
                        std::uint32_t* to) {
  std::size_t count = 0;
  for (const std::uint32_t place : larger) {
    const std::size_t first = kBlocksInLarger * std::size_t{place >> search.shift};
    const std::uint32_t bits = place & ((1u << search.shift) - 1);
    for (std::size_t i = first; i < std::min(first + kBlocksInLarger, all); ++i)
      to[count++] = static_cast<std::uint32_t>(i) << search.shift | bits;
  }
  return count;
}

// Takes out of the blocks of a level, sixteen at a time, what is nothing or felt as a whole; how many are
// left.
template <class Search>
std::size_t open_blocks(const Search& search, const Patches& patches, std::size_t level,
                        std::span<std::uint32_t> blocks, PatchSearcher& searcher) {
  const std::uint32_t first = patches.first_samples[level];
  const BlockLevel of_level{patches.samples.data() + first, first};
  std::size_t open = 0;
  for (std::size_t i = 0; i < blocks.size(); i += kWidth) {
    const std::size_t next = i + kWidth;
    for (std::size_t k = next; k < std::min(next + kWidth, blocks.size()); ++k)
      prefetch(&of_level.blocks[blocks[k] >> search.shift], offsetof(BlockSamples, weight));
    const auto sorted =
        search.sort(of_level, blocks.data() + i, std::min(kWidth, blocks.size() - i), searcher.end());
    searcher.count += sorted.whole_count;
    std::copy_n(blocks.data() + i, sorted.open_count, blocks.data() + open);
    open += sorted.open_count;
  }
  return open;
}

// `blocks`: places in those arrays.
template <class Search>
void classify_blocks(const Search& search, const PatchArrays& arrays, std::span<const std::uint32_t> blocks,
                     std::size_t most, PatchSearcher& searcher) {
  const std::size_t begin = searcher.count;
  for (std::size_t i = 0; i < blocks.size() && searcher.count <= most; i += kBlocksAtATime)
    searcher.count += search.classify(arrays, blocks.data() + i, std::min(kBlocksAtATime, blocks.size() - i),
                                      searcher.end());
  for (std::size_t i = begin; arrays.first > 0 && i < searcher.count; ++i)
    searcher.found[i].block += arrays.first;
}

// A body's way down the levels of the tree, from one to the next by the spheres it may meet, or, where it may
// take blocks of the level between the two as ones, through those; and to patches. It stops where a searcher
// has found too much: there is room for a step beyond that.
template <class Search>
void find_in_model(const Search& search, const Model& model, PatchSearcher& searcher) {
  const Patches& patches = *model.patches;
  const SphereTree& tree = patches.tree;
  const bool brute = model.execution.broadphase == Broadphase::brute;
  const std::size_t most = most_patches(model), sampled = patches.first_samples.size();
  if (tree.head.level_count == 0) return;
  const TreeLayout layout = layout_of(tree.head);
  std::size_t level = tree.head.level_count, count = layout.blocks[level - 1];
  std::uint32_t* from = searcher.frontier[0].data();
  std::uint32_t* to = searcher.frontier[1].data();
  std::iota(from, from + count, 0u);
  bool is_opened = false;  // `from` has blocks of the level already, not their larger ones' places
  for (const SphereBlock* spheres = blocks_of(tree.lines.data()); level-- > 0;
       spheres += layout.blocks[level]) {
    const bool with_bits = 2 * level <= sampled;
    const std::size_t all = level > 0 ? layout.blocks[level - 1] : patches.block.size();
    if (!is_opened) {
      count = brute ? every_sphere({from, count}, all, with_bits, search.shift, search.every_tile, to)
                    : search.hits(spheres, from, count, with_bits, to);
      std::swap(from, to);
    }
    if (2 * level < sampled) count = open_blocks(search, patches, 2 * level, {from, count}, searcher);
    is_opened = level > 0 && with_bits && patches.least_size[2 * level - 1] <= search.largest;
    if (is_opened) {
      const std::size_t below = 2 * level - 1;
      count = every_block(search, {from, count}, samples_of_level(patches, below).size(), to);
      count = open_blocks(search, patches, below, {to, count}, searcher);
      count = every_block(search, {to, count}, samples_of_level(patches, below - 1).size(), from);
    } else if (level > 0 && with_bits) {
      for (std::size_t i = 0; i < count; ++i) from[i] >>= search.shift;
    }
    if (searcher.count > most) return;
  }
  classify_blocks(search, arrays_of(patches), {from, count}, most, searcher);
}

// The same among what was cut for the tick.
template <class Search>
void find_in_cuts(const Search& search, const Model& model, const CutPatches& cuts, PatchSearcher& searcher) {
  if (!is_cut_near(model)) return;  // what is there is another model's
  std::uint32_t* const all = searcher.frontier[0].data();
  std::uint32_t* const blocks = searcher.frontier[1].data();
  const std::size_t lines = piece_count(cuts.near.size(), SphereBlock::kWidth);
  std::iota(all, all + lines, 0u);
  const std::size_t count =
      model.execution.broadphase == Broadphase::brute
          ? every_sphere({all, lines}, cuts.near.size(), true, search.shift, search.every_tile, blocks)
          : search.hits(cuts.round.data(), all, lines, true, blocks);
  for (std::size_t i = 0; i < count; ++i)
    blocks[i] = cuts.near[blocks[i] >> search.shift] << search.shift | (blocks[i] & search.every_tile);
  classify_blocks(search, arrays_of(cuts, *model.patches), {blocks, count}, most_patches(model), searcher);
}

// The same from what was found for larger blocks on the skin: those are asked again, and what is in those
// that are opened now.
template <class Search>
void open_for_body(const Search& search, const Model& model, std::span<const FoundPatches> before,
                   PatchSearcher& searcher) {
  const Patches& patches = *model.patches;
  const std::size_t most = most_patches(model);
  for (const FoundPatches& found : before) {
    if (is_on_skin(found)) continue;
    searcher.found[searcher.count++] = found;
    if (searcher.count > most) return;
  }
  std::uint32_t* from = searcher.frontier[0].data();
  std::uint32_t* to = searcher.frontier[1].data();
  std::size_t count = 0;
  for (std::size_t level = patches.first_samples.size(); level-- > 0; std::swap(from, to)) {
    const auto blocks = samples_of_level(patches, level);
    const std::uint32_t first = patches.first_samples[level];
    count = every_block(search, {from, count}, blocks.size(), to);
    for (const FoundPatches& found : before) {
      if (is_on_skin(found) && found.block >= first && found.block - first < blocks.size())
        to[count++] = (found.block - first) << search.shift | search.every_tile;
    }
    count = open_blocks(search, patches, level, {to, count}, searcher);
    if (searcher.count > most) return;
  }
  classify_blocks(search, arrays_of(patches), {from, count}, most, searcher);
}

template <class Search>
void find_from(const Search& search, const Model& model, const CutPatches& cuts, const SearchFrom& from,
               PatchSearcher& searcher) {
  switch (from.where) {
    case SearchFrom::Where::everywhere:
      find_in_model(search, model, searcher);
      return find_in_cuts(search, model, cuts, searcher);
    case SearchFrom::Where::before:
      return open_for_body(search, model, from.before, searcher);
    case SearchFrom::Where::blocks:
      break;
  }
  const Patches& patches = *model.patches;
  const auto end = std::lower_bound(from.blocks.begin(), from.blocks.end(), patches.block.size());
  const auto of_model = static_cast<std::size_t>(end - from.blocks.begin());
  const auto classify = [&](const PatchArrays& arrays, std::span<const std::uint32_t> numbers) {
    std::uint32_t* const blocks = searcher.frontier[0].data();
    std::transform(numbers.begin(), numbers.end(), blocks, [&](std::uint32_t block) {
      return (block - arrays.first) << search.shift | search.every_tile;
    });
    classify_blocks(search, arrays, {blocks, numbers.size()}, most_patches(model), searcher);
  };
  classify(arrays_of(patches), from.blocks.first(of_model));
  classify(arrays_of(cuts, patches), from.blocks.subspan(of_model));
}

// [m] The part of it that a body has; spheres have theirs.
float distance_slack(const OtherParts& others) {
  return static_cast<float>(kDistanceSlack) * others.offset.largest;
}

// Of spheres round blocks, those that are cut too. A world file has no others, so those count from the hand.
TreeHead head_of_blocks(const Model& model, const CutPatches& cuts) {
  TreeHead head = model.patches->tree.head;
  if (is_cut_near(model)) head.origin = cuts.origin;
  return head;
}

void find_for_finger(const HandSearch& task, const OtherParts& others, const SearchFrom& from,
                     PatchSearcher& searcher, CentroidForce& force) {
  const FingerBody& finger = others.bodies.finger[others.body];
  const SampleKernels& kernels = sample_kernels(task.model.execution.isa);
  const TreeHead head = head_of_blocks(task.model, task.cuts);
  SphereQuery queries[FingerBody::kMostTiles];
  for (std::size_t k = 0; k < finger.tile_count; ++k) {
    queries[k] = query_of(head, task.hand.capsule[finger.segment[k]]);
    queries[k].reach += distance_slack(others);
  }
  const BodySearch search{
      [&](const SphereBlock* spheres, const std::uint32_t* blocks, std::size_t count, bool with_bits,
          std::uint32_t* to) {
        return kernels.finger_hits(spheres, queries, finger.tile_count, blocks, count, with_bits, to);
      },
      [&](const BlockLevel& level, std::uint32_t* blocks, std::size_t count, FoundPatches* to) {
        return kernels.sort_blocks(level, others, blocks, count, {to, force});
      },
      [&](const PatchArrays& arrays, const std::uint32_t* blocks, std::size_t count, FoundPatches* to) {
        return leave_near(
            arrays.shape, others.origin(), finger, to,
            kernels.classify_finger(arrays.block, finger, others.origin(), blocks, count, {to, force}));
      },
      std::max(*std::max_element(finger.block_size, finger.block_size + finger.tile_count),
               finger.block_on_skin),
      FingerBody::kTileBits,
      finger.tiles()};
  find_from(search, task.model, task.cuts, from, searcher);
}

void set_plane(Vec3 normal, double offset, float (&plane)[4]) {
  plane[0] = static_cast<float>(normal.x);
  plane[1] = static_cast<float>(normal.y);
  plane[2] = static_cast<float>(normal.z);
  plane[3] = static_cast<float>(offset);
}

PalmQuery query_of_palm(const TreeHead& tree, const SweptPolygon& palm) {
  PalmQuery query;
  double size = tree.radius + norm(tree.centre);
  const auto add = [&](Vec3 normal, Vec3 point) {
    const Vec3 from = point - tree.origin;
    size = max(size, norm(from));
    set_plane(normal, -dot(normal, from) - palm.radius, query.plane[query.plane_count++]);
  };
  add(palm.normal, palm.corner[0]);
  add(-palm.normal, palm.corner[0]);
  for (std::size_t k = 0; k < palm.corner_count; ++k) add(palm.outward[k], palm.corner[k]);
  query.slack = static_cast<float>(kFloatSlack * (size + palm.radius));
  return query;
}

void find_for_palm(const HandSearch& task, const OtherParts& others, const SearchFrom& from,
                   PatchSearcher& searcher, CentroidForce& force) {
  const PalmBody& palm = others.bodies.palm;
  const SampleKernels& kernels = sample_kernels(task.model.execution.isa);
  PalmQuery query = query_of_palm(head_of_blocks(task.model, task.cuts), task.hand.palm);
  query.slack += distance_slack(others);
  const BodySearch search{
      [&](const SphereBlock* spheres, const std::uint32_t* blocks, std::size_t count, bool,
          std::uint32_t* to) { return kernels.palm_hits(spheres, query, blocks, count, to); },
      [&](const BlockLevel& level, std::uint32_t* blocks, std::size_t count, FoundPatches* to) {
        return kernels.sort_palm_blocks(level, others, blocks, count, {to, force});
      },
      [&](const PatchArrays& arrays, const std::uint32_t* blocks, std::size_t count, FoundPatches* to) {
        return leave_near(
            arrays.shape, others.origin(), palm, to,
            kernels.classify_palm(arrays.block, palm, others.origin(), blocks, count, {to, force}));
      },
      std::max({palm.block_size[0], palm.block_size[1], palm.block_on_skin}),
      0,
      0};
  find_from(search, task.model, task.cuts, from, searcher);
}

}  // namespace

std::size_t most_patches(const Model& model) {
  return std::min<std::size_t>(model.settings.max_candidates,
                               (Bodies::kMostFingers + 1) * most_blocks(model) * kWidth);
}

std::span<const FoundPatches> find_for_body(const HandSearch& task, std::size_t body, const SearchFrom& from,
                                            PatchSearcher& searcher, CentroidForce& force) {
  const Bodies& bodies = task.bodies;
  const std::size_t begin = searcher.count;
  const bool is_finger = body < bodies.finger_count;
  const Vec3 origin = is_finger ? bodies.finger[body].origin : bodies.palm.origin;
  const OtherParts others{bodies, body, offsets_from(origin, bodies),
                          task.model.settings.felt_once == FeltOnce::never ? nullptr : &*searcher.rivals};
  const auto find = is_finger ? find_for_finger : find_for_palm;
  find(task, others, from, searcher, force);
  return std::span(searcher.found).subspan(begin, searcher.count - begin);
}

}  // namespace lumbrical
