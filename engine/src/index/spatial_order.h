// The order in which trees hold what they bound: what is close together in space is close together in it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "index/split_point.h"

namespace lumbrical {

/// A place [m] and the number of what is there.
struct PlacedNumber {
  float at[3];
  std::uint32_t number;
};

/// Puts points into the order of the leaves of a balanced k-d tree (Bentley, Multidimensional binary search
/// trees, 1975): they are halved across the longest side of their box until no more than `run` are left, so
/// that every `run` of them, and every 2, 4, 8, ... runs, have a small box. Within a run they are by number.
/// The result does not depend on `threads`. Numbers must be unique.
void order_in_space(std::span<PlacedNumber> points, std::size_t run, std::size_t threads);

/// Puts `members` into that order: centre_of(member) is where one is [m], best relative to a point near by,
/// for it is rounded to single precision. Takes 16 bytes per member of working memory.
template <class CentreOf>
void order_in_space(std::vector<std::uint32_t>& members, std::size_t run, std::size_t threads,
                    const CentreOf& centre_of) {
  constexpr std::size_t kPiece = 16384;
  const std::size_t count = members.size();
  const auto memory = std::make_unique_for_overwrite<PlacedNumber[]>(count);
  const std::span points(memory.get(), count);
  parallel_pieces(count, kPiece, threads, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      points[i].number = members[i];
      put(centre_of(members[i]), points[i].at);
    }
  });
  order_in_space(points, run, threads);
  parallel_pieces(count, kPiece, threads, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) members[i] = points[i].number;
  });
}

}  // namespace lumbrical
