#include "index/spatial_order.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace lumbrical {
namespace {

using Numbers = std::span<PlacedNumber>;

constexpr std::size_t kPartsPerThread = 4, kWorthAThread = 16384;

std::size_t longest_side(Numbers numbers) {
  using Four = std::int32_t __attribute__((vector_size(16)));  // the number goes along
  static_assert(sizeof(Four) == sizeof(PlacedNumber));
  const auto four_at = [&](std::size_t i) {
    Four four;
    std::memcpy(&four, &numbers[i], sizeof four);
    return four;
  };
  const auto least = [](Four a, Four b) { return a < b ? a : b; };
  const auto most = [](Four a, Four b) { return a > b ? a : b; };
  // Every other one by itself: they need not wait for each other.
  const std::size_t last = numbers.size() - 1;
  Four low[2] = {four_at(0), four_at(last)}, high[2] = {low[0], low[1]};
  for (std::size_t i = 0; i < last; i += 2) {
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = least(four_at(i + k), low[k]);
      high[k] = most(four_at(i + k), high[k]);
    }
  }
  const Four side = most(high[0], high[1]) - least(low[0], low[1]);
  return side[0] >= side[1] && side[0] >= side[2] ? 0 : side[1] >= side[2] ? 1 : 2;
}

// In the order of cells along an axis, those in one by number.
std::uint64_t key_of(const PlacedNumber& number, std::size_t axis) {
  return std::uint64_t{static_cast<std::uint32_t>(number.cell[axis])} << 32 | number.number;
}

// Moves those before the pivot to the front, without a branch that nobody can foresee or a load that waits
// for a store; how many there are.
std::size_t part(Numbers numbers, Numbers spare, std::size_t axis, std::uint64_t pivot) {
  std::size_t lower = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t is_before = key_of(numbers[i], axis) < pivot ? 1 : 0;
    numbers[lower] = spare[i - lower] = numbers[i];
    lower += is_before;
  }
  std::copy_n(spare.begin(), numbers.size() - lower, numbers.begin() + static_cast<std::ptrdiff_t>(lower));
  return lower;
}

// Of a few of them the one that has about as large a share of them before it as `rank` is of all; never the
// first nor the last. They are from places that no mesh's rows are in step with.
std::uint64_t pivot_for(Numbers numbers, std::size_t axis, std::size_t rank) {
  constexpr std::size_t kFew = 9;
  constexpr std::uint32_t kStride = 2654435769;  // of 2^32, by the golden ratio
  std::array<std::uint64_t, kFew> key;
  for (std::uint32_t i = 0; i < kFew; ++i) {
    const std::uint64_t place = (std::uint64_t{kStride * (i + 1)} * numbers.size()) >> 32;
    key[i] = key_of(numbers[place], axis);
  }
  std::sort(key.begin(), key.end());
  return key[std::clamp<std::size_t>(rank * kFew / numbers.size(), 1, kFew - 2)];
}

// Moves the `rank` first ones along an axis to the front.
void select(Numbers numbers, Numbers spare, std::size_t axis, std::size_t rank) {
  constexpr std::size_t kMany = 32;
  constexpr int kRounds = 16;  // beyond them places were chosen to defeat the pivots
  for (int round = 0; numbers.size() > kMany && round < kRounds; ++round) {
    const std::size_t lower = part(numbers, spare, axis, pivot_for(numbers, axis, rank));
    if (rank == lower) return;
    if (rank < lower) {
      numbers = numbers.first(lower);
    } else {
      numbers = numbers.subspan(lower);
      rank -= lower;
    }
  }
  std::nth_element(
      numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(rank), numbers.end(),
      [axis](const PlacedNumber& a, const PlacedNumber& b) { return key_of(a, axis) < key_of(b, axis); });
}

// Moves the lower half across the longest side to the front: as many whole runs as the largest power of two
// that leaves some. Returns how many that are.
std::size_t halve(Numbers numbers, Numbers spare, std::size_t run) {
  std::size_t lower = run;
  while (2 * lower < numbers.size()) lower *= 2;
  select(numbers, spare, longest_side(numbers), lower);
  return lower;
}

void order_part(Numbers numbers, Numbers spare, std::size_t run) {
  while (numbers.size() > run) {
    const std::size_t lower = halve(numbers, spare, run);
    order_part(numbers.first(lower), spare, run);
    numbers = numbers.subspan(lower);
  }
  std::sort(numbers.begin(), numbers.end(),
            [](const PlacedNumber& a, const PlacedNumber& b) { return a.number < b.number; });
}

}  // namespace

void order_in_space(Numbers numbers, Numbers spare, std::size_t run, std::size_t threads) {
  struct Part {
    Numbers numbers, spare;
  };
  std::vector<Part> parts{{numbers, spare}};
  while (threads > 1 && parts.size() < kPartsPerThread * threads &&
         parts[0].numbers.size() > std::max(run, kWorthAThread)) {
    std::vector<Part> halves(2 * parts.size());
    parallel_chunks(parts.size(), 1, threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const auto& [all, room] = parts[i];
        const std::size_t lower = all.size() > run ? halve(all, room, run) : all.size();
        halves[2 * i] = {all.first(lower), room.first(lower)};
        halves[2 * i + 1] = {all.subspan(lower), room.subspan(lower)};
      }
    });
    parts = std::move(halves);
  }
  parallel_chunks(parts.size(), 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) order_part(parts[i].numbers, parts[i].spare, run);
  });
}

}  // namespace lumbrical
