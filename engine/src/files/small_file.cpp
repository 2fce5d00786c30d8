#include "files/small_file.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "base/standard_input.h"

namespace lumbrical {

Status read_small_file(const std::string& path, const char* wanted, std::string& content) {
  constexpr std::size_t kMaxSize = std::size_t{16} << 20;
  if (names_standard_input(path)) return read_standard_input(kMaxSize, content);
  std::error_code ignored;
  const std::filesystem::file_status kind = std::filesystem::status(path, ignored);
  if (std::filesystem::exists(kind) && !std::filesystem::is_regular_file(kind)) {
    return Status::error(path +
                         (std::filesystem::is_directory(kind) ? ": is a folder" : ": is no regular file") +
                         "; name " + wanted);
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) return Status::error(path + ": can't be opened; check the name and your permission to read it");
  content.clear();
  std::array<char, 65536> block{};
  while (const std::size_t size = std::fread(block.data(), 1, block.size(), file.get())) {
    content.append(block.data(), size);
    if (content.size() > kMaxSize)
      return Status::error(path + ": is larger than 16 MiB; is it the right file?");
  }
  if (std::ferror(file.get())) return Status::error(path + ": can't be read to its end; check the disk");
  return {};
}

}  // namespace lumbrical
