// What replay and the question "what if" share.
#pragma once

#include "lumbrical/recording.h"

namespace lumbrical {

inline constexpr std::uint64_t kProgressInterval = 1000;  ///< ticks between reports

/// The recorded scene with the changes the options ask for.
Status scene_for(RecordingReader& reader, const ReplayOptions& options, Scene& scene);

/// The error of a replay that finds tick `found` where `expected` should be.
Status missing_tick(const RecordingReader& reader, std::uint64_t expected, std::uint64_t found);

}  // namespace lumbrical
