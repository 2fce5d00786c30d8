// The only file of the libraries that maps memory.
#include "files/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>

namespace lumbrical {
namespace {

Status failed(const std::string& path, const char* what, int error) {
  return Status::error(path + ": " + what + ": " + std::generic_category().message(error));
}

std::size_t page_size() {
  static const auto size = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  return size;
}

}  // namespace

Status map_file(const std::string& path, std::shared_ptr<const std::byte>& bytes, std::size_t& size) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // no pipe is waited for
  if (descriptor < 0) return failed(path, "cannot be opened", errno);
  struct stat status {};
  Status result;
  void* memory = nullptr;
  if (::fstat(descriptor, &status) != 0) {
    result = failed(path, "cannot be opened", errno);
  } else if (!S_ISREG(status.st_mode)) {
    result = Status::error(path + ": is no regular file; name another");
  } else if (status.st_size > 0) {
    memory = ::mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ, MAP_SHARED, descriptor, 0);
    if (memory == MAP_FAILED) result = failed(path, "cannot be mapped", errno);
  }
  ::close(descriptor);
  if (!result.ok()) return result;
  size = static_cast<std::size_t>(status.st_size);
  bytes = std::shared_ptr<const std::byte>(static_cast<const std::byte*>(memory), [size](const std::byte* p) {
    if (p != nullptr) ::munmap(const_cast<std::byte*>(p), size);
  });
  return {};
}

void release_pages(const std::byte* first, std::size_t size) {
  const std::size_t page = page_size();
  const auto address = reinterpret_cast<std::uintptr_t>(first);
  const std::uintptr_t begin = (address + page - 1) / page * page, end = (address + size) / page * page;
  // Fails only where the pages are locked, and those are meant to stay.
  if (end > begin) ::madvise(const_cast<std::byte*>(first) + (begin - address), end - begin, MADV_DONTNEED);
}

void expect_pages(const std::byte* first, std::size_t size) {
  const auto over = reinterpret_cast<std::uintptr_t>(first) % page_size();
  if (size > 0) ::madvise(const_cast<std::byte*>(first) - over, size + over, MADV_WILLNEED);
}

}  // namespace lumbrical
