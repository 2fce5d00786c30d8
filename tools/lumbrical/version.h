// Which program this is.
#pragma once

#include <string>

namespace lumbrical::tool {

/// "lumbrical 0.1.0, commit 1a2b3c4d, arithmetic 5e6f7a8b": the commit it was built from ("+": and what was
/// not committed), and which results its ticks have (arithmetic_version).
std::string version_text();

}  // namespace lumbrical::tool
