// Which build a result comes of, and what else the machine did: every file of results says it.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lumbrical::bench {

/// The commit it was built from ("+": and what was not committed); `arithmetic`: which forces it computes, as
/// recordings name it (arithmetic_version). Of a run that only tries it out (tools/bench --quick): `quick`.
std::vector<std::pair<std::string, std::string>> build_origin();

/// "commit 1a2b3c4d, arithmetic 5e6f7a8b", for tables that people read.
std::string origin_words();

/// build_origin() with the machine's load, as the first members of a JSON object, a comma behind each.
std::string origin_members();

}  // namespace lumbrical::bench
