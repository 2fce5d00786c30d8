// The report's page: everything inline, nothing fetched, no script; light or dark as the reader's system is.
#pragma once

#include <string>
#include <vector>

#include "report_results.h"

namespace lumbrical::tool {

/// The files of one folder: one machine and build.
struct ResultFolder {
  std::string name;
  std::vector<Results> results;
};

std::string page_html(const std::vector<ResultFolder>& folders);

}  // namespace lumbrical::tool
