// An array that is never changed, and whoever keeps its memory alive: a vector handed over, or a mapped file.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace lumbrical {

/// Copies share the memory, so they are cheap; the last one lets it go.
template <class T>
class SharedArray {
 public:
  using value_type = T;

  SharedArray() = default;
  /// Takes the vector's memory over.
  SharedArray(std::vector<T>&& items) {
    auto kept = std::make_shared<const std::vector<T>>(std::move(items));
    data_ = kept->data();
    size_ = kept->size();
    owner_ = std::move(kept);
  }
  /// `size` items at `data`, which stay as they are while `owner` lives.
  SharedArray(const T* data, std::size_t size, std::shared_ptr<const void> owner)
      : data_(data), size_(size), owner_(std::move(owner)) {}

  [[nodiscard]] const T* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] const T* begin() const { return data_; }
  [[nodiscard]] const T* end() const { return data_ + size_; }
  [[nodiscard]] const T& back() const { return data_[size_ - 1]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

  friend bool operator==(const SharedArray& a, const SharedArray& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  const T* data_ = nullptr;
  std::size_t size_ = 0;
  std::shared_ptr<const void> owner_;
};

}  // namespace lumbrical
