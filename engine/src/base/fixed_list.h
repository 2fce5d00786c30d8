// A list of up to so many items in place, which costs nothing before items are there: an array of them would
// be set to their defaults first, in every tick.
#pragma once

#include <cassert>
#include <cstddef>
#include <new>
#include <type_traits>

namespace lumbrical {

template <class T, std::size_t Capacity>
class FixedList {
  static_assert(std::is_trivially_destructible_v<T> && std::is_trivially_copyable_v<T>);

 public:
  FixedList() = default;
  FixedList(const FixedList&) = delete;
  FixedList& operator=(const FixedList&) = delete;

  T& push_back(const T& item) {
    assert(size_ < Capacity);
    return *::new (static_cast<void*>(place_ + size_++ * sizeof(T))) T(item);
  }
  [[nodiscard]] T& back() { return *(end() - 1); }
  void pop_back() {
    assert(size_ > 0);
    --size_;
  }
  void clear() { size_ = 0; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] T* data() { return std::launder(reinterpret_cast<T*>(place_)); }
  [[nodiscard]] const T* data() const { return std::launder(reinterpret_cast<const T*>(place_)); }
  [[nodiscard]] T* begin() { return data(); }
  [[nodiscard]] T* end() { return data() + size_; }
  [[nodiscard]] const T* begin() const { return data(); }
  [[nodiscard]] const T* end() const { return data() + size_; }

 private:
  std::size_t size_ = 0;
  alignas(T) std::byte place_[Capacity * sizeof(T)];
};

}  // namespace lumbrical
