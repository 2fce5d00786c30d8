// The only file of the libraries that maps memory.
#include "files/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <ctime>
#include <mutex>

#include "base/system_status.h"
#include "lumbrical/world.h"

namespace lumbrical {
namespace {

const auto kSystemPage = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
std::size_t page_size() { return kSystemPage; }
std::size_t to_pages(std::size_t size) { return (size + page_size() - 1) / page_size() * page_size(); }

// What is mapped, for a signal's handler too: no lock, no allocation.
struct Mapping {
  std::atomic<std::uintptr_t> first{0};  // 0: none
  std::size_t size = 0;
  int descriptor = -1;
  struct timespec written {};
  std::atomic<bool> lost{false};
};
constexpr std::size_t kMostMappings = 64;  // more than that are mapped all the same, and not watched
std::array<Mapping, kMostMappings> mappings;
std::atomic<bool> page_lost{false};
std::mutex mappings_mutex;  // of those who begin and end one

Mapping* find_mapping(const void* address) noexcept {
  const auto at = reinterpret_cast<std::uintptr_t>(address);
  for (Mapping& mapping : mappings) {
    const std::uintptr_t first = mapping.first.load(std::memory_order_acquire);
    if (first != 0 && at >= first && at - first < to_pages(mapping.size)) return &mapping;
  }
  return nullptr;
}

// False: there is no place; the descriptor is not needed then.
bool begin_watch(const void* memory, std::size_t size, int descriptor, const struct timespec& written) {
  const std::lock_guard lock(mappings_mutex);
  for (Mapping& mapping : mappings) {
    if (mapping.first != 0) continue;
    mapping.size = size;
    mapping.descriptor = descriptor;
    mapping.written = written;
    mapping.lost = false;
    mapping.first.store(reinterpret_cast<std::uintptr_t>(memory), std::memory_order_release);
    return true;
  }
  return false;
}

void end_watch(const void* memory) {
  const std::lock_guard lock(mappings_mutex);
  Mapping* const mapping = find_mapping(memory);
  if (mapping == nullptr) return;
  ::close(mapping->descriptor);
  mapping->first = 0;
}

}  // namespace

Status map_file(const std::string& path, std::shared_ptr<const std::byte>& bytes, std::size_t& size) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // no pipe is waited for
  if (descriptor < 0) return unreadable(path, errno);
  struct stat status {};
  Status result;
  void* memory = nullptr;
  if (::fstat(descriptor, &status) != 0) {
    result = unreadable(path, errno);
  } else if (!S_ISREG(status.st_mode)) {
    result = Status::error(path + ": is no regular file; name another");
  } else if (status.st_size > 0) {
    memory = ::mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ, MAP_SHARED, descriptor, 0);
    if (memory == MAP_FAILED) result = system_status(path, "cannot be mapped", errno);
  }
  size = static_cast<std::size_t>(status.st_size);
  const bool watched =
      result.ok() && memory != nullptr && begin_watch(memory, size, descriptor, status.st_mtim);
  if (!watched) ::close(descriptor);
  if (!result.ok()) return result;
  bytes = std::shared_ptr<const std::byte>(static_cast<const std::byte*>(memory), [size](const std::byte* p) {
    if (p == nullptr) return;
    end_watch(p);
    ::munmap(const_cast<std::byte*>(p), size);
  });
  return {};
}

bool is_whole(const std::byte* mapped) noexcept {
  const Mapping* const mapping = find_mapping(mapped);
  return mapping == nullptr || !mapping->lost.load(std::memory_order_acquire);
}

Status check_mapped(const std::string& path, const std::byte* mapped) {
  const Mapping* const mapping = find_mapping(mapped);
  if (mapping == nullptr) return {};
  struct stat now {};
  if (::fstat(mapping->descriptor, &now) != 0) return system_status(path, "cannot be looked at", errno);
  const struct timespec written = now.st_mtim;
  const bool same = written.tv_sec == mapping->written.tv_sec && written.tv_nsec == mapping->written.tv_nsec;
  if (same && is_whole(mapped) && static_cast<std::size_t>(now.st_size) == mapping->size) return {};
  return changed_while_read(path);
}

Status changed_while_read(const std::string& path) {
  return Status::error(path +
                       ": was changed while it was read; write another file and give it this name instead");
}

bool replace_lost_page(const void* address) noexcept {
  Mapping* const mapping = find_mapping(address);
  if (mapping == nullptr) return false;
  mapping->lost.store(true, std::memory_order_release);
  page_lost.store(true, std::memory_order_release);
  const std::uintptr_t page = reinterpret_cast<std::uintptr_t>(address) / page_size() * page_size();
  void* const place = reinterpret_cast<void*>(page);
  return ::mmap(place, page_size(), PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) == place;
}

bool any_page_lost() noexcept { return page_lost.load(std::memory_order_acquire); }

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
