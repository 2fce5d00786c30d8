#include "files/spill_file.h"

#include <cerrno>
#include <limits>
#include <system_error>

namespace lumbrical {

Status SpillFile::failed(const char* what) const {
  return Status::error(path_ + ": " + what + ": " + std::generic_category().message(errno));
}

Status SpillFile::open(const std::string& path) {
  path_ = path;
  file_.reset(std::fopen(path.c_str(), "w+bx"));
  if (!file_ && errno == EEXIST) {  // left over from a process that ended between the two calls below
    std::remove(path.c_str());
    file_.reset(std::fopen(path.c_str(), "w+bx"));
  }
  if (!file_) return failed("cannot be created");
  std::remove(path.c_str());  // the open file lives on without its name
  return {};
}

Status SpillFile::append(std::span<const std::byte> bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size())
    return failed("cannot be written");
  size_ += bytes.size();
  return {};
}

Status SpillFile::read(std::uint64_t offset, std::span<std::byte> bytes) {
  static_assert(sizeof(long) == 8 || sizeof(long) == sizeof(std::size_t));
  if (offset > static_cast<std::uint64_t>(std::numeric_limits<long>::max()) ||
      std::fseek(file_.get(), static_cast<long>(offset), SEEK_SET) != 0 ||
      std::fread(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size())
    return failed("cannot be read back");
  return {};
}

}  // namespace lumbrical
