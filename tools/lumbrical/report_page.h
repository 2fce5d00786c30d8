// The report's page: everything inline, nothing fetched, no script; light or dark as the reader's system is.
#pragma once

#include <string>
#include <vector>

#include "report_origin.h"

namespace lumbrical::tool {

std::string page_html(const std::vector<ResultFolder>& folders);

}  // namespace lumbrical::tool
