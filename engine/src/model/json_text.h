// JSON texts of others, bounded in their depth: the parser itself would take any.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace lumbrical {

/// Where a text stopped being JSON, and why; `what` is empty where it didn't.
struct JsonFault {
  std::size_t byte = 0;
  std::string what;
};

/// Brackets may be nested `deepest` deep.
JsonFault parse_json_text(std::string_view text, int deepest, nlohmann::json& root);

}  // namespace lumbrical
