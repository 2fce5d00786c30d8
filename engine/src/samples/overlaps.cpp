#include "samples/overlaps.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/at_least.h"
#include "index/sphere_tree.h"
#include "search/tree_search.h"

namespace lumbrical {
namespace {

constexpr std::size_t kLanes = PatchBlock::kWidth;

// What a block's patches may be listed for.
constexpr std::size_t kMostOfBlock = kLanes * (Bodies::kMostFingers * FingerBody::kMostTiles + 1);

// [m] What rounding may take away of distances between a tree's spheres and bodies.
float slack_of(const TreeHead& tree, const BodyOffsets& offsets, std::size_t body_count) {
  double size = tree.radius + norm(tree.centre);
  for (std::size_t i = 0; i < body_count; ++i)
    size = max(size, norm(Vec3{offsets[i][0], offsets[i][1], offsets[i][2]}));
  return static_cast<float>(kFloatSlack * (size + offsets.largest));
}

// Blocks of patches whose spheres two bodies may reach. That is asked of all blocks' spheres, or of those
// that the tree leads to: for levels above, rounding counts twice, so that no block's is missed.
std::span<const SharedBlock> shared_blocks(const Model& model, const Bodies& bodies, Overlaps& overlaps) {
  const SphereTree& tree = model.patches->tree;
  const BodyOffsets offsets = offsets_from(tree.head.origin, bodies);
  const float slack = slack_of(tree.head, offsets, bodies.finger_count + 1);
  const TreeLayout layout = layout_of(tree.head);
  const std::size_t top = model.execution.broadphase == Broadphase::brute ? 0 : tree.head.level_count - 1;
  SharedBlock *from = overlaps.frontier[0].data(), *to = overlaps.frontier[1].data();
  std::uint32_t count = 0;
  for (; count < layout.blocks[top]; ++count) from[count] = {count, overlaps.rivals.any};
  const SphereBlock* spheres = blocks_of(tree.lines.data());
  for (std::size_t level = tree.head.level_count; level-- > 0; spheres += layout.blocks[level]) {
    if (level > top) continue;
    count = static_cast<std::uint32_t>(
        sample_kernels(model.execution.isa)
            .overlap_hits(spheres, bodies, offsets, level > 0 ? 2 * slack : slack, from, count, to));
    std::swap(from, to);
  }
  return {from, count};
}

std::size_t key_of(const Patches& patches, const ListedPatch& patch) {
  const PatchBlock& block = patches.block[patch.place / kLanes];
  return static_cast<std::size_t>(block.size[patch.place % kLanes]) * Overlaps::kParts +
         patch.tile % ListedPatch::kFarEnd;
}

void put_in_order(const Patches& patches, std::span<const ListedPatch> found, Overlaps& overlaps) {
  auto& begin = overlaps.begin;
  begin.fill(0);
  for (const ListedPatch& patch : found) ++begin[key_of(patches, patch) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  auto next = begin;
  for (const ListedPatch& patch : found) overlaps.listed[next[key_of(patches, patch)]++] = patch;
}

// Nobody has asked what is near them.
std::uint64_t unfelt_parts(const Bodies& bodies) {
  std::uint64_t parts = 0;
  for (std::size_t part = 0; part < Rivals::kParts; ++part)
    parts |= std::uint64_t{!is_felt(bodies, part)} << part;
  return parts;
}

}  // namespace

void size_overlaps(const Model& model, Overlaps& overlaps) {
  const std::size_t blocks =
      std::max<std::size_t>(model.patches->block.size(), frontier_capacity(model.patches->tree.head));
  for (auto& frontier : overlaps.frontier) at_least(blocks, frontier);
  const std::size_t most =
      std::min<std::size_t>(model.settings.max_candidates, model.patches->block.size() * kMostOfBlock);
  at_least(most + kMostOfBlock, overlaps.found);
  at_least(most + kMostOfBlock, overlaps.listed);
}

bool find_overlaps(const Model& model, const Primitives& hand, const Bodies& bodies, std::uint64_t tiles,
                   Overlaps& overlaps) {
  const Patches& patches = *model.patches;
  overlaps.begin.fill(0);
  overlaps.rivals = find_rivals(hand, bodies, tiles | unfelt_parts(bodies));
  if (patches.tree.head.level_count == 0 || overlaps.rivals.any == 0) return true;
  const std::size_t most = overlaps.found.size() - kMostOfBlock;
  const Vec3 middle = bodies.finger_count > 0 ? bodies.finger[0].origin : bodies.palm.origin;
  const BodyOffsets offsets = offsets_from(middle, bodies);
  const SplitPoint origin = split_point(middle);
  std::size_t count = 0;
  for (const SharedBlock& block : shared_blocks(model, bodies, overlaps)) {
    count += sample_kernels(model.execution.isa)
                 .overlap_patches(patches.block.data(), bodies, overlaps.rivals, offsets, origin, block,
                                  overlaps.found.data() + count);
    if (count > most) return false;
  }
  put_in_order(patches, std::span(overlaps.found).first(count), overlaps);
  return true;
}

}  // namespace lumbrical
