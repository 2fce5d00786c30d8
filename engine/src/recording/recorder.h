// How a recording's file starts, for those who write one: the recorder and recover.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "recording/mcap_writer.h"

namespace lumbrical {

inline constexpr const char* kMetadataName = "lumbrical";

/// Opens `writer` for ticks of the given rate [Hz], with the session in front and the state before the first
/// tick where that is not the default (`state` empty: it is); on error no file stays behind. The options'
/// period is set from the rate.
Status open_recording(const std::string& path, double rate, const std::vector<std::uint8_t>& session,
                      const std::vector<std::uint8_t>& state,
                      const std::map<std::string, std::string>& metadata, McapWriterOptions options,
                      McapWriter& writer);

}  // namespace lumbrical
