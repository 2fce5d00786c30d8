// Writing files on POSIX: complete writes, errors with the path and the system's own words.
#include "files/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>

#include "base/system_status.h"

namespace lumbrical {
namespace {

bool exists(const std::string& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0;
}

bool has_writer(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
  if (descriptor < 0) return false;
  const bool held = is_being_written(descriptor);
  ::close(descriptor);
  return held;
}

// Held for as long as the file is open; it ends with its process, however that ends.
void lock_for_writing(int descriptor) {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  // Nobody else has the new file; where locks are unknown, O_EXCL alone keeps others out.
  ::fcntl(descriptor, F_OFD_SETLK, &lock);
}

Status part_exists(const std::string& part) {
  if (has_writer(part))
    return Status::error(part + ": is being written by another process; name another file");
  return Status::error(part +
                       ": is left from a process that was killed, or whose disk was full, and nothing is "
                       "written over it; recover it "
                       "if it is a recording, then move it away");
}

// Of the name that was asked for: nobody gave that of the part.
Status uncreatable(const std::string& path, int error) {
  if (error == ENOENT) return Status::error(path + ": its folder is not there; make it or check the path");
  return system_status(path, "cannot be created", error);
}

// The names in a folder are on the disk when the folder is; some file systems have no such thing to ask for.
int sync_folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int error = ::fsync(descriptor) == 0 || errno == EINVAL ? 0 : errno;
  ::close(descriptor);
  return error;
}

// Never over another file. File systems that can't promise it are asked first, which leaves a moment.
bool rename_to_free(const std::string& from, const std::string& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS) return false;
  errno = EEXIST;
  return !exists(to) && std::rename(from.c_str(), to.c_str()) == 0;
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

Status OutputFile::open(const std::string& path) {
  if (descriptor_ >= 0) return Status::error(growing_at_ + ": is still open; close it first");
  if (path.empty()) return Status::error("the path of the file to write is empty; name one");
  if (exists(path))
    return Status::error(
        path + ": is there already, and nothing is written over it; name another file or move it away");
  path_ = path;
  const std::string part = path + kPartSuffix;
  descriptor_ = ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor_ < 0) return errno == EEXIST ? part_exists(part) : uncreatable(path, errno);
  growing_at_ = part;
  size_ = 0;
  name_synced_ = false;
  lock_for_writing(descriptor_);
  return {};
}

Status OutputFile::write(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return system_status(growing_at_, "cannot be written", written < 0 ? errno : ENOSPC);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    size_ += static_cast<std::uint64_t>(written);
  }
  return {};
}

Status OutputFile::cut(std::uint64_t size) {
  const off_t end = static_cast<off_t>(size);
  if (::ftruncate(descriptor_, end) != 0 || ::lseek(descriptor_, end, SEEK_SET) != end)
    return system_status(growing_at_, "cannot be cut back", errno);
  size_ = size;
  return {};
}

Status OutputFile::sync() {
  if (::fsync(descriptor_) != 0) return system_status(growing_at_, "cannot be written", errno);
  if (name_synced_) return {};
  if (const int error = sync_folder_of(growing_at_))
    return system_status(growing_at_, "cannot be written", error);
  name_synced_ = true;
  return {};
}

Status OutputFile::commit() {
  if (::fsync(descriptor_) != 0) return system_status(growing_at_, "cannot be written", errno);
  // Renamed before it is closed: nobody finds the finished part without its lock.
  if (!rename_to_free(growing_at_, path_))
    return system_status(path_, "cannot be the name of " + growing_at_, errno);
  growing_at_.clear();
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0) return system_status(path_, "cannot be closed", errno);
  if (const int error = sync_folder_of(path_)) return system_status(path_, "cannot be written", error);
  return {};
}

void OutputFile::discard() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  if (!growing_at_.empty()) ::unlink(growing_at_.c_str());
  growing_at_.clear();
}

}  // namespace lumbrical
