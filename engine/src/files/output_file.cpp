// Writing files on POSIX: complete writes, errors with the path and the system's own words.
#include "files/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

namespace lumbrical {
namespace {

Status failed(const std::string& path, const char* what, int error) {
  return Status::error(path + ": " + what + ": " + std::generic_category().message(error));
}

// Held for as long as the file is open, by whoever has it open for writing; it ends with its process.
bool lock_for_writing(int descriptor) {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  // A file system without locks can't tell of another writer.
  return ::fcntl(descriptor, F_OFD_SETLK, &lock) == 0 || (errno != EAGAIN && errno != EACCES);
}

}  // namespace

bool is_being_written(int descriptor) {
  struct flock lock {};
  lock.l_type = F_RDLCK;
  lock.l_whence = SEEK_SET;
  return ::fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type == F_WRLCK;
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Status OutputFile::open(const std::string& path, Place place) {
  if (descriptor_ >= 0) return Status::error(growing_at_ + ": is still open; close it first");
  if (path.empty()) return Status::error("the path of the file to write is empty; name one");
  struct stat status {};
  const bool exists = ::stat(path.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) return Status::error(path + ": is a directory; name a file in it");
  if (exists && !S_ISREG(status.st_mode))
    return Status::error(path + ": is not a regular file; name another");

  path_ = path;
  const bool beside = exists || place == Place::beside;
  const std::string growing_at = beside ? path + ".part" : path;
  // A file of that name that came into being since stat() is not ours to overwrite, hence O_EXCL; a .part
  // that nobody holds is left over from a writer that was killed.
  const int creation = beside ? 0 : O_EXCL;
  descriptor_ = ::open(growing_at.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | creation, 0666);
  if (descriptor_ < 0) return failed(growing_at, "cannot be created", errno);
  const bool ours = lock_for_writing(descriptor_);
  if (!ours || (beside && ::ftruncate(descriptor_, 0) != 0)) {
    const int error = errno;
    ::close(descriptor_);
    descriptor_ = -1;
    return ours ? failed(growing_at, "cannot be created", error)
                : Status::error(growing_at + ": is being written by another program; name another file");
  }
  growing_at_ = growing_at;
  size_ = 0;
  return {};
}

Status OutputFile::write(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return failed(growing_at_, "cannot be written", written < 0 ? errno : ENOSPC);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    size_ += static_cast<std::uint64_t>(written);
  }
  return {};
}

Status OutputFile::cut(std::uint64_t size) {
  const off_t end = static_cast<off_t>(size);
  if (::ftruncate(descriptor_, end) != 0 || ::lseek(descriptor_, end, SEEK_SET) != end)
    return failed(growing_at_, "cannot be cut back", errno);
  size_ = size;
  return {};
}

Status OutputFile::commit() {
  // Only when the bytes are on the disk may they replace a good file; otherwise the system may take its time.
  const bool replaces = growing_at_ != path_ && ::access(path_.c_str(), F_OK) == 0;
  if (replaces && ::fsync(descriptor_) != 0) return failed(growing_at_, "cannot be written", errno);
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0) return failed(growing_at_, "cannot be closed", errno);
  if (growing_at_ != path_ && std::rename(growing_at_.c_str(), path_.c_str()) != 0)
    return failed(path_, ("cannot be replaced by " + growing_at_).c_str(), errno);
  growing_at_.clear();
  return {};
}

void OutputFile::discard() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  if (!growing_at_.empty()) ::unlink(growing_at_.c_str());
  growing_at_.clear();
}

}  // namespace lumbrical
