// Hands the newest value from one thread to one other: neither waits, nothing is queued, nothing is torn.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace lumbrical {

/// Three slots: one being written, one being read, one in between. put() and take() are wait-free.
template <class T>
class Newest {
 public:
  void put(const T& value) noexcept {
    slots_[writing_] = value;
    writing_ =
        between_.exchange(static_cast<std::uint8_t>(writing_ | kFresh), std::memory_order_acq_rel) & kSlot;
  }

  /// True, and the newest value, if one was put since the last take.
  bool take(T& value) noexcept {
    if ((between_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    reading_ = between_.exchange(reading_, std::memory_order_acq_rel) & kSlot;
    value = slots_[reading_];
    return true;
  }

 private:
  static constexpr std::uint8_t kFresh = 4, kSlot = 3;
  std::array<T, 3> slots_{};
  std::atomic<std::uint8_t> between_{2};
  std::uint8_t writing_ = 0;  // the writer's own
  std::uint8_t reading_ = 1;  // the reader's own
};

}  // namespace lumbrical
