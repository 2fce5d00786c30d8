// Working memory that several models take turns in.
#pragma once

#include <cstddef>
#include <vector>

namespace lumbrical {

/// Resizes to `count`, unless there is more already.
template <class T>
void at_least(std::size_t count, std::vector<T>& items) {
  if (items.size() < count) items.resize(count);
}

}  // namespace lumbrical
