// Files that a command may write anew: its own of an earlier run, and nothing else.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "lumbrical/status.h"

namespace lumbrical::tool {

/// Writes text to path.part, a file of its own, which takes the path when it is whole and on the disk. A file
/// that is there is replaced where it is empty or `mark` stands near its beginning, as it does in all of this
/// kind (`kind` is "page of a report", say); any other is left alone, and so is a path.part that is there.
Status replace_file(const std::string& path, std::string_view text, const std::string& kind,
                    std::string_view mark);

/// The same where the caller knows that what is there may go.
Status replace_own_file(const std::string& path, std::string_view text);

/// Refuses two names of one file among those of switches; empty names are none.
Status check_apart(std::initializer_list<std::string> paths);

}  // namespace lumbrical::tool
