// Which ticks of a recording an export is of.
#pragma once

#include <cstdint>
#include <string>

#include "lumbrical/recording.h"

namespace lumbrical {

inline bool is_chosen(const ExportOptions& options, std::uint64_t tick) {
  return tick >= options.first && tick <= options.last && (tick - options.first) % options.step == 0;
}

inline Status check_step(const ExportOptions& options) {
  return options.step > 0 ? Status() : Status::error("ticks: a step of 0 leads nowhere; 1 is every tick");
}

/// Refuses a choice that `found` none of the ticks that the recording holds.
inline Status check_choice(const RecordingInfo& info, std::uint64_t found) {
  if (found > 0 || info.ticks == 0) return {};
  return Status::error(info.path + ": no tick is in that range; it holds " + std::to_string(info.first_tick) +
                       " to " + std::to_string(info.last_tick));
}

}  // namespace lumbrical
