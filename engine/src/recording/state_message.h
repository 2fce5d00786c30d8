// The state before a recording's first tick as a FlatBuffer (schemas/recording.fbs) and back, every bit of
// it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/status.h"
#include "lumbrical/tick.h"

namespace lumbrical {

inline constexpr const char* kStateAttachment = "state";

std::vector<std::uint8_t> encode_state(const State& state);

/// The error tells what is wrong, not where. Refuses numbers that are not finite or out of range.
Status decode_state(std::span<const std::uint8_t> bytes, State& state);

}  // namespace lumbrical
