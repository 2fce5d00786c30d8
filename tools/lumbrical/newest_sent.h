// What went to a device last, for the few ticks that are shown of a session while it runs: most tell of
// nothing.
#pragma once

#include <optional>

#include "lumbrical/recording.h"

namespace lumbrical::tool {

class NewestSent {
 public:
  /// Of every tick in turn.
  void take(const TickRecord& record) noexcept {
    if (record.sent_count > 0) sent_ = record.sent[record.sent_count - 1];
  }

  /// Into a record that tells of nothing that was sent.
  void put_into(TickRecord& record) const noexcept {
    if (record.sent_count > 0 || !sent_) return;
    record.sent[0] = *sent_;
    record.sent_count = 1;
  }

 private:
  std::optional<SentCommand> sent_;
};

}  // namespace lumbrical::tool
