// What a session shows of itself in the browser while it runs (`run --view`): the newest tick, sixty times a
// second, read-only.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <vector>

#include "lumbrical/recording.h"
#include "newest_sent.h"
#include "page_server.h"

namespace lumbrical::tool {

class LiveView {
 public:
  /// Serves the page on a free port and tells its address on standard error. `models`: of the session's
  /// hands.
  Status start(const std::vector<Model>& models);

  /// For the ticking thread, every tick: copies one in rate / 60 of each hand, with what a device was sent
  /// until then, and never waits. A tick that meets a reader is passed over.
  void put(const TickRecord& record) noexcept;

 private:
  void send(const std::function<bool(std::span<const std::uint8_t>)>& send_bytes);

  struct Newest {
    TickRecord record;
    std::uint64_t count = 0;  // of ticks put
  };

  std::vector<std::uint8_t> session_;
  std::uint64_t every_ = 1;                       // ticks
  std::array<std::uint64_t, kMostHands> next_{};  // tick, of each hand; the ticking thread's own
  std::array<NewestSent, kMostHands> sent_;       // likewise
  std::mutex mutex_;
  std::array<Newest, kMostHands> newest_;  // under the mutex
  PageServer server_;                      // last: its threads use what is above
};

}  // namespace lumbrical::tool
