#include "index/patch_cuts.h"

#include <bit>
#include <cmath>

#include "base/set_bits.h"

namespace lumbrical {
namespace {

// Slivers are more than so many times as long as wide and more than so many steps, and patches that are get
// lattices so many times finer at most.
constexpr double kSliver = 3, kSliverSteps = 3, kFinerSlivers = 2.2;

// They are cut into strips so many times as long as wide, or as long as so many steps, and by a share less:
// patches' longest edges are longer than their strips.
constexpr double kStrip = 2, kStripShare = 0.94;

// [square of the longest edge a patch may have] The area of half a square of such a patch.
constexpr double kPatchArea = 0.25;

}  // namespace

double steps_along(double square, double area, double step) {
  const double longest = std::sqrt(square);
  return longest / step * clamp(square / (kSliver * area), 1, kFinerSlivers);
}

Corners Needle::part(std::uint32_t number) const {
  const std::uint32_t strip = (number + 1) / 2;
  const Vec3 b = along(at.b, strip + 1), c = along(at.c, strip + 1);
  if (strip == 0) return {at.a, b, c};
  if (number % 2 == 1) return {along(at.b, strip), b, c};
  return {along(at.b, strip), c, along(at.c, strip)};
}

Sphere Needle::sphere_round(std::uint32_t first, std::uint32_t parts) const {
  const std::uint32_t begin = (first + 1) / 2, end = (first + parts) / 2 + 1;
  const double share = 1 / static_cast<double>(strips), here = share * begin, there = share * end;
  const Vec3 b = at.b - at.a, c = at.c - at.a, middle = 0.25 * (here + there) * (b + c);
  double square = 0;
  for (const Vec3 corner : {here * b, here * c, there * b, there * c})
    square = max(square, dot(corner - middle, corner - middle));
  return {at.a + middle, std::sqrt(square)};
}

Strips strips_of(const Corners& triangle, double step) {
  const auto [at, square] = longest_first(triangle);
  const Vec3 along = at.b - at.a;
  const double longest = std::sqrt(square), width = norm(cross(along, at.c - at.a)) / longest,
               most = max(kStrip * width, kSliverSteps * step);
  if (!(longest > max(kSliver * width, most))) return {};
  const double place = dot(at.c - at.a, along) / dot(along, along);
  const auto needle = [&](Vec3 a, Vec3 b, Vec3 c, double length) {
    return Needle{{a, b, c}, static_cast<std::uint32_t>(std::ceil(min(length / (kStripShare * most), 1e9)))};
  };
  // Next to nothing of a needle is no needle.
  const double least = 0.25 * most / longest;
  if (place < least) return {needle(at.b, at.c, at.a, longest), {}};
  if (place > 1 - least) return {needle(at.a, at.b, at.c, longest), {}};
  const Vec3 foot = at.a + place * along;
  return {needle(at.a, foot, at.c, place * longest), needle(at.b, at.c, foot, (1 - place) * longest)};
}

double expected_patches(const Corners& at, double step) {
  const double longest = longest_patch(step), area = 0.5 * norm(cross(at.b - at.a, at.c - at.a));
  return max(max(1, strips_of(at, step).count()), area / (kPatchArea * longest * longest));
}

void cut_triangle(const Corners& at, double step, std::vector<PatchPath>& paths) {
  const auto cut = [&](const Corners& whole, std::uint32_t part) {
    for_patches_of(whole, step, 1, [&](const Corners&, std::uint32_t halves) {
      paths.push_back({part, halves});
    });
  };
  const Strips strips = strips_of(at, step);
  if (strips.count() == 0) return cut(at, PatchPath::kNoStrips);
  for (std::uint32_t i = 0; i < strips.count(); ++i) cut(strips.part(i), i);
}

Corners part_at(Corners at, double step, PatchPath path) {
  if (path.part != PatchPath::kNoStrips) at = strips_of(at, step).part(path.part);
  for (int bit = static_cast<int>(std::bit_width(path.halves)) - 2; bit >= 0; --bit)
    at = longest_first(at).half(has_bit(path.halves, bit));
  return at;
}

}  // namespace lumbrical
