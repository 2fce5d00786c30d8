// What a session shows of itself in the browser while it runs (`run --view`): the newest tick, sixty times a
// second, read-only.
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "lumbrical/recording.h"
#include "page_server.h"

namespace lumbrical::tool {

class LiveView {
 public:
  /// Serves the page on a free port and tells its address on standard error.
  Status start(const Model& model);

  /// For the ticking thread: copies one tick in rate / 60, and never waits. A tick that meets a reader is
  /// passed over.
  void put(const TickRecord& record) noexcept;

 private:
  void send(const std::function<bool(std::span<const std::uint8_t>)>& send_bytes);

  std::vector<std::uint8_t> session_;
  std::uint64_t every_ = 1, next_ = 0;  // ticks
  std::mutex mutex_;
  TickRecord newest_;        // under the mutex, as is the next
  std::uint64_t count_ = 0;  // of ticks put
  PageServer server_;        // last: its threads use what is above
};

}  // namespace lumbrical::tool
