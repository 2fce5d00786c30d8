// The way to what of a large triangle is near: halved again and again, as when it is cut into patches as a
// whole, but only where something is near, and down to cells, which are cut at a time.
#pragma once

#include <cstdint>

#include "index/patch_blocks.h"
#include "index/patch_cuts.h"
#include "index/triangle_bound.h"

namespace lumbrical {

/// Which of a triangle's cells: that from that part of its strips on, if it has any, and by its halves as
/// PatchPath has them; 0: they are more than the number holds.
struct CellPath {
  std::uint32_t part;
  std::uint64_t halves;
};

/// A cell is so many parts of strips that are patches, or of at most so many times a patch's length.
inline constexpr std::uint32_t kCellParts = 16;
inline constexpr double kCellLength = 4;

/// near(sphere [W], limbs) -> those of some limbs, a bit each, that are near the sphere; take(path,
/// for_patches), of which the latter calls what it is given for every patch of the cell.
template <class Near, class Take>
struct CellWalk {
  double step;
  const Near& near;
  const Take& take;

  void go(const Corners& triangle, std::uint32_t limbs) const {
    if (limbs == 0) return;
    const Strips strips = strips_of(triangle, step);
    if (strips.count() == 0) return part(triangle, {PatchPath::kNoStrips, 1}, limbs);
    run(strips.first, 0, 0, strips.first.count(), limbs);
    run(strips.second, strips.first.count(), 0, strips.second.count(), limbs);
  }

 private:
  void part(const Corners& at, CellPath path, std::uint32_t limbs) const {
    limbs = near(sphere_round(at, {}), limbs);
    if (limbs == 0) return;
    const LongestFirst whole = longest_first(at);
    if (is_short(whole, step, kCellLength))
      return take(path, [&](const auto& put) {
        for_patches_of(at, step, 1, [&](const Corners& patch, std::uint32_t) { put(patch); });
      });
    const bool fits = path.halves != 0 && path.halves >> 63 == 0;
    for (const bool second : {false, true})
      part(whole.half(second), {path.part, fits ? 2 * path.halves + (second ? 1 : 0) : 0}, limbs);
  }
  // So many parts of a needle's strips from one on, which grow with their number; those of another needle
  // come before.
  void run(const Needle& needle, std::uint32_t before, std::uint32_t first, std::uint32_t count,
           std::uint32_t limbs) const {
    if (count == 0) return;
    if (count == 1) return part(needle.part(first), {before + first, 1}, limbs);
    limbs = near(needle.sphere_round(first, count), limbs);
    if (limbs == 0) return;
    const std::uint32_t last = first + count - 1;
    const auto is_patch = [&](std::uint32_t i) { return is_short(longest_first(needle.part(i)), step); };
    if (count <= kCellParts && is_patch(last - 1) && is_patch(last)) {
      return take({before + first, 1}, [&](const auto& put) {
        for (std::uint32_t i = first; i <= last; ++i) put(needle.part(i));
      });
    }
    const std::uint32_t half =
        count > kCellParts ? (count / 2 - 1) / kCellParts * kCellParts + kCellParts : count / 2;
    run(needle, before, first, half, limbs);
    run(needle, before, first + half, count - half, limbs);
  }
};
template <class Near, class Take>
CellWalk(double, const Near&, const Take&) -> CellWalk<Near, Take>;

}  // namespace lumbrical
