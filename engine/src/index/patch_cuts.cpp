#include "index/patch_cuts.h"

#include <bit>
#include <cmath>

#include "index/patches.h"

namespace lumbrical {
namespace {

// Slivers are more than so many times as long as wide and more than so many steps, and patches that are get
// lattices so many times finer at most.
constexpr double kSliver = 3, kSliverSteps = 3, kFinerSlivers = 2.2;

// They are cut into strips so many times as long as wide, or as long as so many steps, and by a share less:
// patches' longest edges are longer than their strips.
constexpr double kStrip = 2, kStripShare = 0.94;

double longest_edge(const Corners& at) {
  const Vec3 ab = at.b - at.a, ac = at.c - at.a, bc = at.c - at.b;
  return std::sqrt(max(dot(ab, ab), max(dot(ac, ac), dot(bc, bc))));
}

double width_of(const Corners& at) { return norm(cross(at.b - at.a, at.c - at.a)) / longest_edge(at); }

/// Triangle a b c cut across into strips, of which that at a is a triangle, and all others two each.
struct Needle {
  Corners at;
  std::uint32_t strips = 0;

  [[nodiscard]] std::uint32_t count() const { return strips > 0 ? 2 * strips - 1 : 0; }
  [[nodiscard]] Corners part(std::uint32_t number) const {
    const std::uint32_t strip = (number + 1) / 2;
    const auto along = [&](Vec3 end, std::uint32_t i) {
      return at.a + static_cast<double>(i) / static_cast<double>(strips) * (end - at.a);
    };
    const Vec3 b = along(at.b, strip + 1), c = along(at.c, strip + 1);
    if (strip == 0) return {at.a, b, c};
    if (number % 2 == 1) return {along(at.b, strip), b, c};
    return {along(at.b, strip), c, along(at.c, strip)};
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

// Corners in turn, the longest edge first.
Corners longest_first(const Corners& at) {
  const auto square = [](Vec3 p, Vec3 q) { return dot(q - p, q - p); };
  const double ab = square(at.a, at.b), bc = square(at.b, at.c), ca = square(at.c, at.a);
  if (ab >= bc && ab >= ca) return at;
  return bc >= ca ? Corners{at.b, at.c, at.a} : Corners{at.c, at.a, at.b};
}

// Of a sliver that is longer than its strips may be; else none.
Strips strips_of(const Corners& triangle, double step) {
  const double longest = longest_edge(triangle), width = width_of(triangle),
               most = max(kStrip * width, kSliverSteps * step);
  if (!(longest > max(kSliver * width, most))) return {};
  const Corners at = longest_first(triangle);
  const Vec3 along = at.b - at.a;
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

// The half of a triangle cut at the middle of its longest edge.
Corners half_of(const Corners& triangle, bool second) {
  const Corners at = longest_first(triangle);
  const Vec3 middle = at.a + 0.5 * (at.b - at.a);
  return second ? Corners{middle, at.b, at.c} : Corners{at.a, middle, at.c};
}

bool is_patch(const Corners& at, double step) {
  return !(longest_edge(at) > static_cast<double>(kPatchSizes) * step);
}

// Into how many patches a part of a triangle is cut; 0: it would have to be halved more often than `most`
// times in a row.
std::size_t count_of_part(const Corners& at, double step, unsigned most) {
  if (is_patch(at, step)) return 1;
  if (most == 0) return 0;
  const std::size_t first = count_of_part(half_of(at, false), step, most - 1),
                    second = first > 0 ? count_of_part(half_of(at, true), step, most - 1) : 0;
  return second > 0 ? first + second : 0;
}
// Lists all patches of a part.
void cut_part(const Corners& at, double step, PatchPath path, std::vector<PatchPath>& paths) {
  if (is_patch(at, step)) return paths.push_back(path);
  cut_part(half_of(at, false), step, {path.part, 2 * path.halves}, paths);
  cut_part(half_of(at, true), step, {path.part, 2 * path.halves + 1}, paths);
}

}  // namespace

double steps_along(const Corners& patch, double step) {
  const double longest = longest_edge(patch);
  return longest / step * clamp(longest / (kSliver * width_of(patch)), 1, kFinerSlivers);
}

std::size_t count_parts(const Corners& at, double step, unsigned most) {
  const Strips strips = strips_of(at, step);
  if (strips.count() == 0) return count_of_part(at, step, most);
  if (strips.count() >> most > 1) return 0;
  std::size_t total = 0;
  for (std::uint32_t i = 0; i < strips.count(); ++i) {
    const std::size_t count = count_of_part(strips.part(i), step, most);
    if (count == 0) return 0;
    total += count;
  }
  return total;
}

void cut_triangle(const Corners& at, double step, std::vector<PatchPath>& paths) {
  const Strips strips = strips_of(at, step);
  if (strips.count() == 0) return cut_part(at, step, {PatchPath::kNoStrips, 1}, paths);
  for (std::uint32_t i = 0; i < strips.count(); ++i) cut_part(strips.part(i), step, {i, 1}, paths);
}

Corners part_at(Corners at, double step, PatchPath path) {
  if (path.part != PatchPath::kNoStrips) at = strips_of(at, step).part(path.part);
  for (int bit = static_cast<int>(std::bit_width(path.halves)) - 2; bit >= 0; --bit)
    at = half_of(at, (path.halves >> bit & 1u) != 0);
  return at;
}

}  // namespace lumbrical
