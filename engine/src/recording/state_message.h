// The state before a recording's first tick as a FlatBuffer (schemas/recording.fbs) and back, every bit of
// it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "lumbrical/status.h"
#include "lumbrical/tick.h"

namespace lumbrical {

/// Attachments: of the session's first hand and its second.
inline constexpr std::array<std::string_view, 2> kStateAttachments = {"state", "state of the second hand"};

std::vector<std::uint8_t> encode_state(const State& state);

/// The error tells what is wrong, not where. Refuses numbers that are not finite or out of range.
Status decode_state(std::span<const std::uint8_t> bytes, State& state);

}  // namespace lumbrical
