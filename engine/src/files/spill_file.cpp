#include "files/spill_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <limits>

#include "base/system_status.h"

namespace lumbrical {

Status SpillFile::failed(const char* what) const { return system_status(path_, what, errno); }

Status SpillFile::open(const std::string& path) {
  path_ = path + ".XXXXXX";  // a name that nothing has
  const int descriptor = ::mkostemp(path_.data(), O_CLOEXEC);
  if (descriptor < 0) return failed("cannot be created");
  ::unlink(path_.c_str());  // the open file lives on without its name
  file_.reset(::fdopen(descriptor, "w+b"));
  if (file_) return {};
  const Status status = failed("cannot be created");
  ::close(descriptor);
  return status;
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
      std::fseek(file_.get(), static_cast<long>(offset), SEEK_SET) != 0)
    return failed("cannot be read back");
  if (std::fread(bytes.data(), 1, bytes.size(), file_.get()) == bytes.size()) return {};
  // The end of a file is no error of the system, whose last one may be of anything.
  return std::ferror(file_.get()) != 0 ? failed("cannot be read back")
                                       : Status::error(path_ + ": is shorter than what was written to it");
}

}  // namespace lumbrical
