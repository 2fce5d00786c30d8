#include "samples/cut_patches.h"

#include <algorithm>
#include <limits>
#include <span>

#include "base/at_least.h"
#include "base/fixed_list.h"
#include "base/parallel.h"
#include "base/set_bits.h"
#include "index/sphere_grid.h"
#include "index/sphere_tree.h"

namespace lumbrical {
namespace {

// Blocks there is room for, of each so many candidates.
constexpr std::size_t kCandidatesPerBlock = 16;

// Triangles of at most so many times a patch's length are small: they are cut side by side.
constexpr double kSmallLength = 2;

// The path of small triangles that are cut at a time, by the number of the first.
constexpr CellPath kSideBySide{~0u - 1, 1};

// [m] What is cut reaches so much farther than the hand: it moves that far until it asks again.
constexpr double kSpareReach = 0.005;

std::size_t room_for_blocks(const Model& model) {
  return std::max<std::size_t>(16, model.settings.max_candidates / kCandidatesPerBlock);
}

std::size_t hash_of(const CutCell& cell) {
  std::uint64_t hash = cell.build;
  for (const std::uint64_t part : {std::uint64_t{cell.triangle} << 32 | cell.path.part, cell.path.halves}) {
    hash = (hash ^ part) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return static_cast<std::size_t>(hash);
}

bool is_same(const CutCell& a, const CutCell& b) {
  return a.build == b.build && a.triangle == b.triangle && a.path.part == b.path.part &&
         a.path.halves == b.path.halves;
}

// Where a cell is, or where there is a place for it. There are more places than blocks.
CutCell& find_cell(const CutCell& cell, CutPatches& cuts) {
  std::size_t place = hash_of(cell) % cuts.cells.size();
  while (cuts.cells[place].build != 0 && !is_same(cuts.cells[place], cell))
    place = (place + 1) % cuts.cells.size();
  return cuts.cells[place];
}

void forget(CutPatches& cuts) {
  std::fill(cuts.cells.begin(), cuts.cells.end(), CutCell{});
  cuts.near.clear();
  cuts.count = 0;
  cuts.build = 0;
}

/// Patches on their way into blocks.
struct BlockFiller {
  double step;
  std::size_t room;
  CutPatches& cuts;
  FixedList<Corners, PatchBlock::kWidth> members;

  void add(const Corners& patch) {
    if (members.size() == PatchBlock::kWidth) flush();
    members.push_back(patch);
  }
  void flush() {
    if (members.empty()) return;
    if (cuts.count < room) {
      cuts.sphere[cuts.count] = put_block(members, step, {}, cuts.block[cuts.count],
                                          cuts.shape.data() + cuts.count * PatchBlock::kWidth);
    }
    ++cuts.count;
    members.clear();
  }
};

/// Lists the blocks of what is near a hand, and cuts what has not been cut before.
class NearBlocks {
 public:
  NearBlocks(const Model& model, const Limbs& limbs, CutPatches& cuts)
      : model_(model),
        limbs_(limbs),
        cuts_(cuts),
        room_(room_for_blocks(model)),
        brute_(model.execution.broadphase == Broadphase::brute) {
    cuts.near.clear();
  }

  /// Was there room for all?
  [[nodiscard]] bool fit() const { return fit_; }

  /// Of a tree; with brute force all of it is asked, in the same order.
  void add_from(const TreeHead& tree, const TreeLine* lines) {
    if (tree.level_count == 0) return;
    const Tree in{tree, layout_of(tree), lines};
    const std::size_t last = tree.level_count - 1;
    for (std::size_t block = 0; block < in.layout.blocks[last]; ++block)
      add_below(in, last, blocks_of(lines), block, limbs_.all());
  }

 private:
  struct Tree {
    const TreeHead& head;
    const TreeLayout layout;
    const TreeLine* lines;
  };

  // Down a level's block, of which `spheres` is the first, with the limbs that are near what holds it.
  void add_below(const Tree& tree, std::size_t level, const SphereBlock* spheres, std::size_t block,
                 std::uint32_t limbs) {
    const SphereBlock& round = spheres[block];
    // A file that is gone reads as zeros, so empty places are not known by their radius alone.
    const std::size_t first = block * SphereBlock::kWidth,
                      all = level > 0 ? tree.layout.blocks[level - 1] : tree.head.leaf_count;
    for (std::size_t i = 0; i < SphereBlock::kWidth && first + i < all; ++i) {
      if (!(round.r[i] >= 0)) continue;
      const Sphere sphere{tree.head.origin + Vec3{round.x[i], round.y[i], round.z[i]}, round.r[i]};
      const std::uint32_t near = brute_ && level > 0 ? limbs : limbs_.near(sphere, limbs);
      if (near == 0) continue;
      if (level > 0) add_below(tree, level - 1, spheres + tree.layout.blocks[level], first + i, near);
      for (std::size_t k = 0; level == 0 && k < tree.head.blocks_per_leaf; ++k)
        add_leaf_block(tree, (first + i) * tree.head.blocks_per_leaf + k);
    }
  }

  void add_leaf_block(const Tree& tree, std::size_t block) {
    const SphereBlock& spheres = blocks_of(tree.lines)[tree.layout.upper + block];
    std::size_t count = 0;
    while (count < SphereBlock::kWidth && spheres.r[count] >= 0) ++count;
    add({numbers_of(tree.lines, tree.layout) + block * SphereBlock::kWidth, count});
  }

  [[nodiscard]] double step() const { return model_.patches->rules.step; }

  // Triangles side by side, up to sixteen: the small ones together, of larger ones what is near.
  void add(std::span<const std::uint32_t> triangles) {
    if (!fit_ || triangles.empty()) return;
    const std::uint32_t larger =
        add_cell({model_.build, triangles[0], kSideBySide}, [&](CutCell& cell, BlockFiller& filler) {
          for (std::size_t i = 0; i < triangles.size(); ++i) {
            const Corners at = corners_of(model_.triangles, triangles[i]);
            if (!has_area(at)) continue;
            const bool is_small =
                is_short(longest_first(at), step(), kSmallLength) && strips_of(at, step()).count() == 0;
            cell.larger |= std::uint32_t{!is_small} << i;
            if (is_small)
              for_patches_of(at, step(), 1, [&](const Corners& patch, std::uint32_t) { filler.add(patch); });
          }
        });
    for_numbers(larger, [&](std::size_t i) { add_larger(triangles[i]); });
  }

  void add_larger(std::uint32_t triangle) {
    const auto near = [&](const Sphere& sphere, std::uint32_t some) {
      return fit_ ? limbs_.near(sphere, some) : 0;
    };
    const auto take = [&](CellPath path, const auto& for_patches) {
      add_cell({model_.build, triangle, path}, [&](CutCell&, BlockFiller& filler) {
        for_patches([&](const Corners& patch) { filler.add(patch); });
      });
    };
    const Corners at = corners_of(model_.triangles, triangle);
    CellWalk{step(), near, take}.go(at, limbs_.near_plane(at));
  }

  // Its blocks, of patches that put(cell, filler) hands on unless they are there; returns CutCell::larger.
  template <class Put>
  std::uint32_t add_cell(CutCell cell, const Put& put) {
    const bool has_place = cell.path.halves != 0;
    if (CutCell* const place = has_place ? &find_cell(cell, cuts_) : nullptr; place && place->build != 0) {
      cell = *place;
    } else {
      cell.first = cuts_.count;
      BlockFiller filler{step(), room_, cuts_, {}};
      put(cell, filler);
      filler.flush();
      cell.count = cuts_.count - cell.first;
      // So there are never more cells than blocks.
      if (place && cell.count > 0) *place = cell;
    }
    fit_ = cuts_.count <= room_ && cuts_.near.size() + cell.count <= room_;
    for (std::uint32_t i = 0; fit_ && i < cell.count; ++i) cuts_.near.push_back(cell.first + i);
    return cell.larger;
  }

  const Model& model_;
  const Limbs& limbs_;
  CutPatches& cuts_;
  const std::size_t room_;
  const bool brute_;
  bool fit_ = true;
};

// False where there is no room for all blocks near a hand.
bool find_near(const Model& model, const Limbs& limbs, CutPatches& cuts) {
  NearBlocks near(model, limbs, cuts);
  if (!model.world) {
    const SphereTree& large = model.patches->large_tree;
    near.add_from(large.head, large.lines.data());
    return near.fit();
  }
  const SphereGrid& grid = model.world->grid;
  const bool brute = model.execution.broadphase == Broadphase::brute;
  const std::size_t count = brute ? grid.tree.size() : find_cells(grid, limbs.box(), cuts.trees);
  for (std::size_t i = 0; i < count; ++i) {
    const TreeHead& tree = grid.tree[brute ? i : cuts.trees[i]];
    near.add_from(tree, grid.lines.data() + tree.first_line);
  }
  return near.fit();
}

void put_spheres(CutPatches& cuts) {
  constexpr Sphere kNone{{}, -std::numeric_limits<double>::infinity()};
  const std::size_t end = piece_count(cuts.near.size(), SphereBlock::kWidth) * SphereBlock::kWidth;
  for (std::size_t i = 0; i < end; ++i) {
    Sphere sphere = kNone;
    if (i < cuts.near.size()) {
      sphere = cuts.sphere[cuts.near[i]];
      sphere.centre = sphere.centre - cuts.origin;
    }
    put_sphere(sphere, i, cuts.round.data());
  }
}

}  // namespace

std::size_t most_blocks(const Model& model) {
  return model.patches->block.size() + (is_cut_near(model) ? room_for_blocks(model) : 0);
}

void size_cuts(const Model& model, CutPatches& cuts) {
  if (!is_cut_near(model)) return;
  const std::size_t room = room_for_blocks(model);
  at_least(room, cuts.block);
  at_least(room * PatchBlock::kWidth, cuts.shape);
  at_least(room, cuts.sphere);
  at_least(2 * room, cuts.cells);
  at_least(piece_count(room, SphereBlock::kWidth), cuts.round);
  cuts.near.reserve(room);
  if (model.world) at_least(model.world->grid.tree.size(), cuts.trees);
}

bool cut_near(const Model& model, const Primitives& hand, CutPatches& cuts) {
  if (!is_cut_near(model)) return true;
  const HandPlace place = place_of(hand);
  const bool is_again = cuts.build == model.build;
  if (is_again && is_within(cuts.spare, cuts.about, place)) return true;
  cuts.about = place;
  // Where there was no room to spare there may be once less than half as much is near: asking more often
  // would cut anew in every tick.
  const bool is_full = is_again && cuts.spare == 0 && 2 * cuts.near.size() >= cuts.most_near;
  const double at_first = is_full ? 0 : kSpareReach;
  if (!is_full) cuts.most_near = 0;
  for (const double spare : {at_first, at_first, 0.0}) {
    const Limbs limbs(cuts.about, spare);
    if (find_near(model, limbs, cuts)) {
      cuts.origin = model.world ? limbs.ball().centre : model.patches->tree.head.origin;
      put_spheres(cuts);
      cuts.build = model.build;
      cuts.spare = spare;
      cuts.most_near = std::max(cuts.most_near, cuts.near.size());
      return true;
    }
    forget(cuts);
  }
  return false;
}

}  // namespace lumbrical
