// Patches, sixteen at a time, as blocks of them are kept.
#pragma once

#include <cstddef>
#include <span>

#include "index/patches.h"
#include "index/sphere_tree.h"
#include "model/corners.h"

namespace lumbrical {

/// Triangles or patches, the least that is worth another thread.
inline constexpr std::size_t kPatchPiece = 4096;

/// Fills a block, its shapes too, with up to sixteen patches; returns a sphere round them, relative to
/// `origin`. `step`: as patch_cuts.h has it.
Sphere put_block(std::span<const Corners> patches, double step, Vec3 origin, PatchBlock& block,
                 PatchShape* shapes);

}  // namespace lumbrical
