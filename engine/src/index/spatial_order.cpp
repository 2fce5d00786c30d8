#include "index/spatial_order.h"

#include <algorithm>
#include <array>
#include <bit>

namespace lumbrical {
namespace {

using Points = std::span<PlacedNumber>;

constexpr std::size_t kPartsPerThread = 4, kWorthAThread = 16384;

std::size_t longest_side(Points points) {
  float low[3], high[3];
  for (std::size_t axis = 0; axis < 3; ++axis) low[axis] = high[axis] = points[0].at[axis];
  for (const PlacedNumber& point : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], point.at[axis]);
      high[axis] = std::max(high[axis], point.at[axis]);
    }
  }
  const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

// In the order of places along an axis, those at one place by number.
std::uint64_t key_of(const PlacedNumber& point, std::size_t axis) {
  const auto bits = std::bit_cast<std::uint32_t>(point.at[axis] + 0.0f);  // -0 is 0
  const std::uint32_t ascending = bits ^ ((bits >> 31) != 0 ? 0xffffffffu : 0x80000000u);
  return std::uint64_t{ascending} << 32 | point.number;
}

// Moves those before the pivot to the front, without a branch that nobody can foresee; how many there are.
std::size_t part(Points points, std::size_t axis, std::uint64_t pivot) {
  std::size_t lower = 0;
  for (PlacedNumber& point : points) {
    const PlacedNumber here = point;
    point = points[lower];
    points[lower] = here;
    lower += key_of(here, axis) < pivot ? 1 : 0;
  }
  return lower;
}

// Of a few of the points the one that has about as large a share of them before it as `rank` is of all; never
// the first nor the last.
std::uint64_t pivot_for(Points points, std::size_t axis, std::size_t rank) {
  constexpr std::size_t kFew = 9;
  std::array<std::uint64_t, kFew> key;
  for (std::size_t i = 0; i < kFew; ++i) key[i] = key_of(points[i * (points.size() - 1) / (kFew - 1)], axis);
  std::sort(key.begin(), key.end());
  return key[std::clamp<std::size_t>(rank * kFew / points.size(), 1, kFew - 2)];
}

// Moves the `rank` first ones along an axis to the front.
void select(Points points, std::size_t axis, std::size_t rank) {
  constexpr std::size_t kMany = 32;
  constexpr int kRounds = 16;  // beyond them points were chosen to defeat the pivots
  for (int round = 0; points.size() > kMany && round < kRounds; ++round) {
    const std::size_t lower = part(points, axis, pivot_for(points, axis, rank));
    if (rank == lower) return;
    if (rank < lower) {
      points = points.first(lower);
    } else {
      points = points.subspan(lower);
      rank -= lower;
    }
  }
  std::nth_element(
      points.begin(), points.begin() + static_cast<std::ptrdiff_t>(rank), points.end(),
      [axis](const PlacedNumber& a, const PlacedNumber& b) { return key_of(a, axis) < key_of(b, axis); });
}

// Moves the lower half across the longest side to the front: as many whole runs as the largest power of two
// that leaves some. Returns how many points that are.
std::size_t halve(Points points, std::size_t run) {
  std::size_t lower = run;
  while (2 * lower < points.size()) lower *= 2;
  select(points, longest_side(points), lower);
  return lower;
}

void order_part(Points points, std::size_t run) {
  while (points.size() > run) {
    const std::size_t lower = halve(points, run);
    order_part(points.first(lower), run);
    points = points.subspan(lower);
  }
  std::sort(points.begin(), points.end(),
            [](const PlacedNumber& a, const PlacedNumber& b) { return a.number < b.number; });
}

}  // namespace

void order_in_space(Points points, std::size_t run, std::size_t threads) {
  std::vector<Points> parts{points};
  while (threads > 1 && parts.size() < kPartsPerThread * threads &&
         parts[0].size() > std::max(run, kWorthAThread)) {
    std::vector<Points> halves(2 * parts.size());
    parallel_chunks(parts.size(), 1, threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const std::size_t lower = parts[i].size() > run ? halve(parts[i], run) : parts[i].size();
        halves[2 * i] = parts[i].first(lower);
        halves[2 * i + 1] = parts[i].subspan(lower);
      }
    });
    parts = std::move(halves);
  }
  parallel_chunks(parts.size(), 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) order_part(parts[i], run);
  });
}

}  // namespace lumbrical
