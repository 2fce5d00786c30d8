// Files as memory: pages of them are read when they are first touched, and can be let go of.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "lumbrical/status.h"

namespace lumbrical {

inline constexpr std::size_t kPageSize =
    4096;  ///< what files are laid out for; the system's own may be larger

/// Maps a regular file for reading; the last copy of `bytes` undoes it. A mapped file may be replaced by
/// another of its name, never changed: is_whole and check_mapped tell whether it was.
Status map_file(const std::string& path, std::shared_ptr<const std::byte>& bytes, std::size_t& size);

/// False: pages of the file were lost, since someone has shortened it, and read as zeros now. Costs next to
/// nothing.
bool is_whole(const std::byte* mapped) noexcept;

/// Whether the file of a mapping still is what was mapped: whole, of the same size and time of its last
/// writing. One call of the system.
Status check_mapped(const std::string& path, const std::byte* mapped);

/// The error of a mapped file that was changed.
Status changed_while_read(const std::string& path);

/// Lets go of the whole pages within: they no longer count as this process', and are read again when touched.
void release_pages(const std::byte* first, std::size_t size);

/// Asks the system to start reading, without waiting.
void expect_pages(const std::byte* first, std::size_t size);

}  // namespace lumbrical
