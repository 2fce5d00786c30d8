#include "samples/sample_search.h"

#include <algorithm>
#include <numeric>

#include "index/sphere_tree.h"
#include "lanes/tree_search.h"
#include "model/primitive.h"

namespace lumbrical {
namespace {

constexpr std::size_t kWidth = PatchBlock::kWidth;

// Blocks that are classified at a time: the list has room for all they may hold.
constexpr std::size_t kBlocksAtATime = 64;
constexpr std::size_t kSpare = kBlocksAtATime * kWidth;

// ---- Search ----

// Goes down the levels; `hits(spheres, blocks, count, is_last, to)` asks the spheres of one.
template <class Hits>
std::span<std::uint32_t> search_levels(const SphereTree& tree, PatchSearchMemory& memory, const Hits& hits) {
  if (tree.head.level_count == 0) return {};
  const TreeLayout layout = layout_of(tree.head);
  std::size_t level = tree.head.level_count, count = layout.blocks[level - 1];
  std::uint32_t* from = memory.frontier[0].data();
  std::uint32_t* to = memory.frontier[1].data();
  std::iota(from, from + count, 0u);
  for (const SphereBlock* spheres = blocks_of(tree.lines.data()); level-- > 0;
       spheres += layout.blocks[level]) {
    count = hits(spheres, from, count, level == 0, to);
    std::swap(from, to);
  }
  return {from, count};
}

std::span<std::uint32_t> search_for_finger(const Model& model, const Primitives& hand,
                                           const FingerBody& finger, PatchSearchMemory& memory) {
  const SphereTree& tree = model.patches->tree;
  const SampleKernels& kernels = sample_kernels(model.execution.isa);
  if (model.execution.broadphase == Broadphase::brute) {
    const auto all = static_cast<std::uint32_t>(model.patches->block.size());
    for (std::uint32_t i = 0; i < all; ++i) memory.frontier[0][i] = i << 3 | finger.tiles();
    return {memory.frontier[0].data(), all};
  }
  SphereQuery queries[FingerBody::kMostTiles];
  for (std::size_t k = 0; k < finger.tile_count; ++k)
    queries[k] = query_of(tree.head, hand.capsule[finger.segment[k]]);
  return search_levels(tree, memory,
                       [&](const SphereBlock* spheres, const std::uint32_t* blocks, std::size_t count,
                           bool is_last, std::uint32_t* to) {
                         return kernels.finger_hits(spheres, queries, finger.tile_count, blocks, count,
                                                    is_last, to);
                       });
}

void set_plane(Vec3 normal, double offset, float (&plane)[4]) {
  plane[0] = static_cast<float>(normal.x);
  plane[1] = static_cast<float>(normal.y);
  plane[2] = static_cast<float>(normal.z);
  plane[3] = static_cast<float>(offset);
}

PalmQuery query_of_palm(const TreeHead& tree, const SweptPolygon& palm) {
  constexpr double kFloatSlack = 1.6e-6;
  PalmQuery query;
  double size = tree.radius + norm(tree.centre);
  const auto add = [&](Vec3 normal, Vec3 point) {
    const Vec3 from = point - tree.origin;
    size = max(size, norm(from));
    set_plane(normal, -dot(normal, from) - palm.radius, query.plane[query.plane_count++]);
  };
  add(palm.normal, palm.corner[0]);
  add(-palm.normal, palm.corner[0]);
  for (int k = 0; k < palm.corner_count; ++k)
    add(palm.outward[static_cast<std::size_t>(k)], palm.corner[static_cast<std::size_t>(k)]);
  query.slack = static_cast<float>(kFloatSlack * (size + palm.radius));
  return query;
}

std::span<std::uint32_t> search_for_palm(const Model& model, const Primitives& hand,
                                         PatchSearchMemory& memory) {
  const SphereTree& tree = model.patches->tree;
  if (model.execution.broadphase == Broadphase::brute) {
    std::iota(memory.frontier[0].begin(), memory.frontier[0].end(), 0u);
    return {memory.frontier[0].data(), model.patches->block.size()};
  }
  const SampleKernels& kernels = sample_kernels(model.execution.isa);
  const PalmQuery query = query_of_palm(tree.head, hand.palm);
  return search_levels(
      tree, memory,
      [&](const SphereBlock* spheres, const std::uint32_t* blocks, std::size_t count, bool,
          std::uint32_t* to) { return kernels.palm_hits(spheres, query, blocks, count, to); });
}

// ---- Classification ----

/// What bodies have found so far, and where each one's begins.
struct Found {
  std::span<FoundPatches> room;
  std::size_t count = 0;
  std::array<std::size_t, Bodies::kMostFingers + 2> begin{};
};

// Appends what a body may meet of the blocks near it: `sort` takes out, sixteen blocks at a time, what is
// nothing or taken as a whole, `classify` looks at the patches of the rest. False where there is no room.
template <class Sort, class Classify>
bool append_patches(std::span<std::uint32_t> blocks, Found& found, const Sort& sort,
                    const Classify& classify) {
  const auto has_room = [&](std::size_t more) { return found.count + more <= found.room.size(); };
  const auto to = [&] { return found.room.data() + found.count; };
  std::size_t open = 0;
  for (std::size_t i = 0; i < blocks.size(); i += kWidth) {
    if (!has_room(kWidth)) return false;
    const auto sorted = sort(blocks.data() + i, std::min(kWidth, blocks.size() - i), to());
    found.count += sorted.whole_count;
    std::copy_n(blocks.data() + i, sorted.open_count, blocks.data() + open);
    open += sorted.open_count;
  }
  for (std::size_t i = 0; i < open; i += kBlocksAtATime) {
    if (!has_room(kSpare)) return false;
    found.count += classify(blocks.data() + i, std::min(kBlocksAtATime, open - i), to());
  }
  return has_room(kSpare);  // whatever else was looked at
}

bool find_all(const Model& model, const Primitives& hand, const Bodies& bodies, PatchSearchMemory& memory,
              Found& found) {
  const SampleKernels& kernels = sample_kernels(model.execution.isa);
  const PatchBlock* const blocks = model.patches->block.data();
  const BlockSamples* const samples = model.patches->samples.data();
  for (std::size_t i = 0; i < bodies.finger_count; ++i) {
    const FingerBody& finger = bodies.finger[i];
    const auto sort = [&](std::uint32_t* from, std::size_t count, FoundPatches* to) {
      return kernels.sort_blocks(samples, finger, from, count, to);
    };
    const auto classify = [&](const std::uint32_t* from, std::size_t count, FoundPatches* to) {
      return kernels.classify_finger(blocks, finger, from, count, to);
    };
    if (!append_patches(search_for_finger(model, hand, finger, memory), found, sort, classify)) return false;
    found.begin[i + 1] = found.count;
  }
  if (bodies.palm.corner_count > 0) {
    const auto sort = [&](std::uint32_t* from, std::size_t count, FoundPatches* to) {
      return kernels.sort_palm_blocks(samples, bodies.palm, from, count, to);
    };
    const auto classify = [&](const std::uint32_t* from, std::size_t count, FoundPatches* to) {
      return kernels.classify_palm(blocks, bodies.palm, from, count, to);
    };
    if (!append_patches(search_for_palm(model, hand, memory), found, sort, classify)) return false;
  }
  found.begin[bodies.finger_count + 1] = found.count;
  return true;
}

// ---- Order ----

// Lists the patches of each body's entries, by key and, within a key, body by body.
bool put_in_order(const Found& found, std::size_t body_count, NearPatches& near) {
  near.begin.fill(0);
  for (const FoundPatches& patches : found.room.first(found.count))
    near.begin[patches.key + 1u] += static_cast<std::uint32_t>(__builtin_popcount(patches.lanes));
  std::partial_sum(near.begin.begin(), near.begin.end(), near.begin.begin());
  if (near.count() > near.listed.size()) return false;
  std::array<std::uint32_t, kKeyCount> next;
  std::copy_n(near.begin.begin(), kKeyCount, next.begin());
  for (std::size_t body = 0; body < body_count; ++body) {
    for (std::size_t i = found.begin[body]; i < found.begin[body + 1]; ++i) {
      const auto [key, lanes, block] = found.room[i];
      const std::uint32_t what = key % kind::kCount;
      const bool is_block =
                     (what >= kind::kBlockInside && what < kind::kPalmSide) || what == kind::kPalmBlock,
                 at_far_end = what >= kind::kFarEnd && what < kind::kInside;
      const auto tile = static_cast<std::uint32_t>(body * Bodies::kTilesApart + kTileOfKind[what] +
                                                   (at_far_end ? ListedPatch::kFarEnd : 0));
      const std::uint32_t first = is_block ? block : block * PatchBlock::kWidth;
      ListedPatch* to = near.listed.data() + next[key];
      for (std::uint32_t left = lanes; left != 0; left &= left - 1)
        *to++ = {first + static_cast<std::uint32_t>(__builtin_ctz(left)), tile};
      next[key] = static_cast<std::uint32_t>(to - near.listed.data());
    }
  }
  return true;
}

}  // namespace

void size_search(const Model& model, PatchSearchMemory& memory, NearPatches& near) {
  const Patches& patches = *model.patches;
  const std::size_t blocks =
      std::max<std::size_t>(patches.block.size(), frontier_capacity(patches.tree.head));
  for (auto& frontier : memory.frontier) frontier.resize(blocks);
  const std::size_t most = (Bodies::kMostFingers + 1) * patches.block.size() * kWidth;
  const std::size_t room = std::min<std::size_t>(model.settings.max_candidates, most) + kSpare;
  memory.found.resize(room);
  near.listed.resize(room);
}

bool find_patches(const Model& model, const Primitives& hand, const Bodies& bodies, PatchSearchMemory& memory,
                  NearPatches& near) {
  Found found{memory.found};
  if (find_all(model, hand, bodies, memory, found) && put_in_order(found, bodies.finger_count + 1, near))
    return true;
  near.begin.fill(0);
  return false;
}

}  // namespace lumbrical
