#include "base/whole_file.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <system_error>

#include "base/system_status.h"

namespace lumbrical {
namespace {

bool names_standard_input(const std::string& path) { return path == "-"; }

Status too_large(const std::string& name, std::uintmax_t most) {
  const bool small = most >> 30 == 0;
  return Status::error(name + ": is larger than " + std::to_string(most >> (small ? 20 : 30)) +
                       (small ? " MiB" : " GiB") + "; is it the right file?");
}

// In blocks, since what is no file on a disk doesn't tell its size before its end.
Status read_to_end(std::FILE* file, const std::string& name, std::uintmax_t most, std::string& content) {
  std::array<char, 65536> block{};
  while (const std::size_t size = std::fread(block.data(), 1, block.size(), file)) {
    if (size > most - content.size()) return too_large(name, most);
    content.append(block.data(), size);
  }
  return std::ferror(file) == 0 ? Status{} : system_status(name, "can't be read to its end", errno);
}

Status read_file(const std::string& path, std::uintmax_t most, const char* wanted, std::string& content) {
  std::error_code error;
  const std::filesystem::file_status kind = std::filesystem::status(path, error);
  if (kind.type() == std::filesystem::file_type::not_found) return unreadable(path, ENOENT);
  if (error) return unreadable(path, error.value());
  if (!std::filesystem::is_regular_file(kind)) {
    return Status::error(path +
                         (std::filesystem::is_directory(kind) ? ": is a folder" : ": is no regular file") +
                         "; name " + wanted);
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) return unreadable(path, errno);
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && size > most) return too_large(path, most);
  if (!error) content.reserve(static_cast<std::size_t>(size));
  return read_to_end(file.get(), path, most, content);
}

}  // namespace

std::string shown_name(const std::string& path) {
  return names_standard_input(path) ? "standard input" : path;
}

Status read_whole_file(const std::string& path, std::uintmax_t most, const char* wanted,
                       std::string& content) {
  content.clear();
  try {
    return names_standard_input(path) ? read_to_end(stdin, shown_name(path), most, content)
                                      : read_file(path, most, wanted, content);
  } catch (const std::exception&) {  // of memory, or of its length
    return Status::error(shown_name(path) + ": not enough memory to read it; use a smaller file");
  }
}

}  // namespace lumbrical
