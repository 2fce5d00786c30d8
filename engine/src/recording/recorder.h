// How a recording's file starts, for those who write one: the recorder and recover.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "recording/channels.h"
#include "recording/mcap_writer.h"

namespace lumbrical {

inline constexpr const char* kMetadataName = "lumbrical";

/// By hand: the state before the first tick, encoded; empty where that is the default.
using StateMessages = std::array<std::vector<std::uint8_t>, kMostHands>;

/// Opens `writer` for ticks of the given rate [Hz], with the session and states in front; on error no file
/// stays behind. The options' period is set from the rate.
Status open_recording(const std::string& path, double rate, const std::vector<std::uint8_t>& session,
                      const StateMessages& states, const std::map<std::string, std::string>& metadata,
                      McapWriterOptions options, McapWriter& writer,
                      const std::vector<RecordingChannel>& channels = {{}});

}  // namespace lumbrical
