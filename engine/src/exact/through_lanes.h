// The one way of pairs through a kernel: as many at a time as its terms hold are gathered, a pair per lane,
// computed, and what was found goes where the pair's number says.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "simd/lane_vectors.h"

namespace lumbrical {

/// Calls gather(item, lane, terms) for a group of items, kernel(terms), and give(item, lane, terms) for each
/// of them. `Terms` has a kCapacity, a count, and for_each_row, which calls back with every row of numbers
/// the kernel reads.
template <class Item, class Terms, class Gather, class Give>
void through_lanes(std::span<Item> items, Terms& terms, void (*kernel)(Terms&), const Gather& gather,
                   const Give& give) {
  while (!items.empty()) {
    const std::span<Item> group = items.first(std::min(items.size(), Terms::kCapacity));
    items = items.subspan(group.size());
    terms.count = group.size();
    for (std::size_t k = 0; k < group.size(); ++k) gather(group[k], k, terms);
    terms.for_each_row([&](double* row) { fill_up(row, terms.count); });
    kernel(terms);
    for (std::size_t k = 0; k < group.size(); ++k) give(group[k], k, terms);
  }
}

}  // namespace lumbrical
