// The order in which trees hold what they bound: what is close together in space is close together in it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "lumbrical/math.h"

namespace lumbrical {

/// Where something is, in cells of one size along all axes, 0 or more, and its number.
struct alignas(16) PlacedNumber {
  std::int32_t cell[3];
  std::uint32_t number;
};

/// Puts numbers into the order of the leaves of a balanced k-d tree (Bentley, Multidimensional binary search
/// trees, 1975): they are halved across the longest side of their box until no more than `run` are left, so
/// that every `run` of them, and every 2, 4, 8, ... runs, have a small box. Within a run they ascend. The
/// result does not depend on `threads`. Numbers must be unique; `spare` is working memory of the same size.
void order_in_space(std::span<PlacedNumber> numbers, std::span<PlacedNumber> spare, std::size_t run,
                    std::size_t threads);

/// Puts `members` into that order: centre_of(member) [m] is where one is, in `box` or about there. Takes 32
/// bytes per member of working memory.
template <class CentreOf>
void order_in_space(std::vector<std::uint32_t>& members, const Box& box, std::size_t run, std::size_t threads,
                    const CentreOf& centre_of) {
  constexpr std::size_t kPiece = 16384;
  constexpr double kMostCells = 2147483647.0;
  const Vec3 size = box.upper - box.lower;
  const double longest = max(size.x, max(size.y, size.z)), scale = longest > 0 ? kMostCells / longest : 0;
  const auto cell = [scale](double x) { return static_cast<std::int32_t>(clamp(x * scale, 0, kMostCells)); };
  const std::size_t count = members.size();
  const auto memory = std::make_unique_for_overwrite<PlacedNumber[]>(2 * count);
  const std::span numbers(memory.get(), count), spare(memory.get() + count, count);
  parallel_pieces(count, kPiece, threads, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Vec3 from = centre_of(members[i]) - box.lower;
      numbers[i] = {{cell(from.x), cell(from.y), cell(from.z)}, members[i]};
    }
  });
  order_in_space(numbers, spare, run, threads);
  parallel_pieces(count, kPiece, threads, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) members[i] = numbers[i].number;
  });
}

}  // namespace lumbrical
