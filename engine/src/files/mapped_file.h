// Files as memory: pages of them are read when they are first touched, and can be let go of.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "lumbrical/status.h"

namespace lumbrical {

inline constexpr std::size_t kPageSize =
    4096;  ///< what files are laid out for; the system's own may be larger

/// Maps a regular file for reading; the last copy of `bytes` undoes it. Whoever shortens the file in the
/// meantime ends the process (SIGBUS): a mapped file may be replaced by another of its name, never changed.
Status map_file(const std::string& path, std::shared_ptr<const std::byte>& bytes, std::size_t& size);

/// Lets go of the whole pages within: they no longer count as this process', and are read again when touched.
void release_pages(const std::byte* first, std::size_t size);

/// Asks the system to start reading, without waiting.
void expect_pages(const std::byte* first, std::size_t size);

}  // namespace lumbrical
