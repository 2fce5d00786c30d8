// How a triangle is cut into patches: halved across its longest edge as often as needed, and first, if it is
// a sliver, cut across into strips. `step`: [m] what patches are measured in (kPatchSizes).
#pragma once

#include <cstdint>
#include <vector>

#include "index/patches.h"
#include "index/sphere_tree.h"
#include "model/corners.h"

namespace lumbrical {

/// Where in its triangle a patch is: the part of its strips, if it has any, and from a leading 1 on a bit for
/// every halving, which half it is.
struct PatchPath {
  static constexpr std::uint32_t kNoStrips = ~0u;
  std::uint32_t part, halves;
};

/// Has it any to cut?
inline bool has_area(const Corners& at) {
  const double area = norm(cross(at.b - at.a, at.c - at.a));
  return area > 0 && is_finite(area);
}

/// About how many patches a triangle is cut into: that is between half as many and five times as many.
double expected_patches(const Corners& at, double step);

/// Lists a triangle's patches.
void cut_triangle(const Corners& at, double step, std::vector<PatchPath>& paths);

/// One of them.
Corners part_at(Corners at, double step, PatchPath path);

/// How many steps a patch is long whose longest edge's square [m^2] and doubled area [m^2] these are. Slivers
/// lie side by side and are all off the same way, so they get finer ones.
double steps_along(double square, double area, double step);

// ---- One cut after the other ----

/// Triangle a b c cut across into strips, of which that at a is a triangle, and all others two each.
struct Needle {
  Corners at;
  std::uint32_t strips = 0;

  [[nodiscard]] std::uint32_t count() const { return strips > 0 ? 2 * strips - 1 : 0; }
  [[nodiscard]] Corners part(std::uint32_t number) const;
  /// Round so many parts from one on [W].
  [[nodiscard]] Sphere sphere_round(std::uint32_t first, std::uint32_t parts) const;

 private:
  // On the edge from a to an end, where a strip begins.
  [[nodiscard]] Vec3 along(Vec3 end, std::uint32_t strip) const {
    return at.a + static_cast<double>(strip) / static_cast<double>(strips) * (end - at.a);
  }
};

/// A triangle as needles: by itself, or the two on either side of its apex.
struct Strips {
  Needle first, second;
  [[nodiscard]] std::uint32_t count() const { return first.count() + second.count(); }
  [[nodiscard]] Corners part(std::uint32_t number) const {
    return number < first.count() ? first.part(number) : second.part(number - first.count());
  }
};

/// Of a sliver that is longer than its strips may be; else none.
Strips strips_of(const Corners& triangle, double step);

/// Corners in turn, the longest edge from a to b, and its square [m^2].
struct LongestFirst {
  Corners at;
  double square;

  /// The half of it up to the middle of that edge, or beyond.
  [[nodiscard]] Corners half(bool second) const {
    const Vec3 middle = at.a + 0.5 * (at.b - at.a);
    return second ? Corners{middle, at.b, at.c} : Corners{at.a, middle, at.c};
  }
};
inline LongestFirst longest_first(const Corners& at) {
  const auto square = [](Vec3 p, Vec3 q) { return dot(q - p, q - p); };
  const double ab = square(at.a, at.b), bc = square(at.b, at.c), ca = square(at.c, at.a);
  if (ab >= bc && ab >= ca) return {at, ab};
  return bc >= ca ? LongestFirst{{at.b, at.c, at.a}, bc} : LongestFirst{{at.c, at.a, at.b}, ca};
}

/// [m] Longest edge that a patch may have.
inline double longest_patch(double step) { return static_cast<double>(kPatchSizes) * step; }

/// Is it no longer than so many times a patch may be?
inline bool is_short(const LongestFirst& triangle, double step, double times = 1) {
  const double most = times * longest_patch(step);
  return !(triangle.square > most * most);
}

/// Calls take(patch, halves) for all patches of a part of a triangle, which has those as PatchPath has them.
template <class Take>
void for_patches_of(const Corners& at, double step, std::uint32_t halves, const Take& take) {
  const LongestFirst part = longest_first(at);
  if (is_short(part, step)) return take(at, halves);
  for_patches_of(part.half(false), step, 2 * halves, take);
  for_patches_of(part.half(true), step, 2 * halves + 1, take);
}

}  // namespace lumbrical
