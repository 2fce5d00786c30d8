// The figures of a what-if replay as JSON and as a table.
#pragma once

#include "lumbrical/recording.h"
#include "output.h"

namespace lumbrical::tool {

Json what_if_json(const WhatIfResult& result);
std::string what_if_text(const WhatIfResult& result);

}  // namespace lumbrical::tool
