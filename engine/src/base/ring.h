// A ring between exactly one thread that fills it and exactly one that empties it: no lock, no allocation, no
// system call; neither side can hold up the other.
#pragma once

#include <atomic>
#include <bit>
#include <cstdint>
#include <vector>

namespace lumbrical {

template <class T>
class Ring {
 public:
  /// Room for at least `capacity` (>= 1) items; rounded up to a power of two.
  explicit Ring(std::uint32_t capacity) : slots_(std::bit_ceil(capacity)), mask_(slots_.size() - 1) {}

  /// Filling side: the slot to fill, or nullptr while the ring is full. It counts from publish() on.
  T* claim() noexcept {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (tail - seen_head_ == slots_.size()) {
      seen_head_ = head_.load(std::memory_order_acquire);
      if (tail - seen_head_ == slots_.size()) return nullptr;
    }
    return &slots_[tail & mask_];
  }
  void publish() noexcept {
    tail_.store(tail_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// Filling side: asks the memory for the first `bytes` of the slot to be filled next.
  void prefetch(std::size_t bytes) const noexcept {
    const char* const next =
        reinterpret_cast<const char*>(&slots_[tail_.load(std::memory_order_relaxed) & mask_]);
    for (std::size_t i = 0; i < bytes; i += 64) __builtin_prefetch(next + i, 1);
  }

  /// Emptying side: the oldest item, or nullptr while there is none. Its slot is free again after pop().
  const T* front() noexcept {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head == seen_tail_) {
      seen_tail_ = tail_.load(std::memory_order_acquire);
      if (head == seen_tail_) return nullptr;
    }
    return &slots_[head & mask_];
  }
  void pop() noexcept { head_.store(head_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }

 private:
  std::vector<T> slots_;
  std::uint64_t mask_;
  // Each side's variables have a cache line of their own, and each keeps what it last saw of the other side,
  // so that the two threads touch one another's lines only when the ring looks full or empty.
  alignas(64) std::atomic<std::uint64_t> head_{0};
  std::uint64_t seen_tail_ = 0;
  alignas(64) std::atomic<std::uint64_t> tail_{0};
  std::uint64_t seen_head_ = 0;
};

}  // namespace lumbrical
