// The name that somebody meant who wrote another one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lumbrical {

/// "; did you mean NAME?": of all names the one with the fewest letters to change, unless those are too many:
/// then nothing.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& names);

}  // namespace lumbrical
