// Patches that are not the model's, of triangles too large to be cut with it (Patches::large) and of those in
// a world file: cut where a hand comes near, into the same ones as if they had been cut before, and kept as
// long as there is room.
#pragma once

#include <cstdint>
#include <vector>

#include "index/patch_cells.h"
#include "lumbrical/model.h"
#include "samples/limbs.h"

namespace lumbrical {

/// What has been cut at a time, and its blocks: a cell of a triangle, or small triangles side by side.
struct CutCell {
  std::uint64_t build = 0;  ///< of the model; 0: an empty place
  std::uint32_t triangle = 0;
  CellPath path{};
  std::uint32_t larger = 0;  ///< of triangles side by side those that are not small, a bit each
  std::uint32_t first = 0, count = 0;
};

/// Blocks that are not of the model, whose numbers follow those of its own. Which are near only saves asking
/// the others, so bits do not tell what has been cut before.
struct CutPatches {
  std::vector<PatchBlock> block;
  std::vector<PatchShape> shape;  ///< sixteen to a block
  std::vector<Sphere> sphere;     ///< [m] W, round each block
  std::vector<CutCell> cells;     ///< by their hash, with empty places between
  std::uint32_t count = 0;        ///< blocks that have been cut

  std::uint64_t build = 0;           ///< of the model that this is for
  HandPlace about;                   ///< where the hand was: all that is near it as long as nothing of it
  double spare = 0;                  ///< [m] is farther than this from there; 0: there was no room for more
  std::size_t most_near = 0;         ///< blocks at a time, since room for more was last asked for
  std::vector<std::uint32_t> near;   ///< these blocks, in the order of triangles and cells
  std::vector<SphereBlock> round;    ///< spheres round those
  Vec3 origin;                       ///< [m] W, that they and the model's are relative to
  std::vector<std::uint32_t> trees;  ///< of a grid, to look for triangles in
};

/// Has it triangles that are cut where a hand comes near?
inline bool is_cut_near(const Model& model) { return model.world || !model.patches->large.empty(); }

/// Blocks that a search may find: of the model and, if it has triangles to cut, as many as may be.
std::size_t most_blocks(const Model& model);

void size_cuts(const Model& model, CutPatches& cuts);

/// Cuts what is near the hand. False where that is more than there is room for (Settings::max_candidates).
bool cut_near(const Model& model, const Primitives& hand, CutPatches& cuts);

/// Some blocks of patches, from that number on.
struct PatchArrays {
  const PatchBlock* block;
  const PatchShape* shape;
  std::uint32_t first;
};
inline PatchArrays arrays_of(const Patches& patches) {
  return {patches.block.data(), patches.shape.data(), 0};
}
inline PatchArrays arrays_of(const CutPatches& cuts, const Patches& patches) {
  return {cuts.block.data(), cuts.shape.data(), static_cast<std::uint32_t>(patches.block.size())};
}

/// Of the model or cut.
inline const PatchBlock& block_at(const Patches& patches, const CutPatches& cuts, std::uint32_t number) {
  return number < patches.block.size() ? patches.block[number] : cuts.block[number - patches.block.size()];
}

}  // namespace lumbrical
