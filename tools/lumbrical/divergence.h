// How replay and diff tell where two runs part.
#pragma once

#include <string>

#include "lumbrical/recording.h"
#include "output.h"

namespace lumbrical::tool {

/// {identical, ticks, first_divergence {tick, stage, field, recorded, replayed} | null}
Json divergence_json(const ReplayResult& result);

/// The same for people; `verb` is what was done with the ticks.
std::string divergence_text(const ReplayResult& result, const std::string& verb, bool both_hands = false);

}  // namespace lumbrical::tool
