// Which builds results come of, and what that means for reading them together.
#pragma once

#include <string>
#include <vector>

#include "output.h"
#include "report_results.h"

namespace lumbrical::tool {

/// The files of one folder: one machine and build, or so they should be.
struct ResultFolder {
  std::string name;
  std::vector<Results> results;
};

/// What any file may say of the build that made it and of the machine: commit and arithmetic, unknown in
/// older files; the load before it; that it was only tried out.
void add_build(const Json& json, Results& results);

/// What was measured of another arithmetic than its neighbours or this program, only tried out, or twice: a
/// sentence each, with what to do. Errors of different arithmetic are of different forces.
std::vector<std::string> origin_warnings(const std::vector<ResultFolder>& folders);

/// "commit 1a2b3c4d, arithmetic 5e6f7a8b" of the files, each value once; what does not say so is unknown.
std::string builds_of(const std::vector<Results>& all);

}  // namespace lumbrical::tool
