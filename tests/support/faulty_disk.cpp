// See faulty_disk.h.
#include "faulty_disk.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <condition_variable>
#include <filesystem>
#include <mutex>

namespace {

struct Disk {
  std::mutex mutex;
  std::condition_variable changed;
  std::string path;  // empty: no faults
  std::uint64_t room = UINT64_MAX, written = 0;
  int write_error = 0, cut_error = 0, sync_error = 0, rename_error = 0;
  bool held = false;
  int waiting = 0;  // writes that are held
  lumbrical::test::Kept kept;
};

// Never destroyed: threads may write to the very end of the program.
Disk& disk() {
  static Disk& instance = *new Disk;
  return instance;
}

bool is_ours(const std::string& path) { return !disk().path.empty() && path.starts_with(disk().path); }

std::string path_of(int descriptor) {
  std::array<char, 4096> target{};
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  const ssize_t size = ::readlink(link.c_str(), target.data(), target.size());
  return size > 0 ? std::string(target.data(), static_cast<std::size_t>(size)) : std::string();
}

bool is_ours(int descriptor) { return !disk().path.empty() && is_ours(path_of(descriptor)); }

bool is_our_folder(int descriptor) {
  return !disk().path.empty() &&
         std::filesystem::path(disk().path).parent_path() == std::filesystem::path(path_of(descriptor));
}

int failed(int error) {
  errno = error;
  return -1;
}

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* bytes, std::size_t count) {
  std::unique_lock lock(disk().mutex);
  if (is_ours(descriptor)) {
    ++disk().waiting;
    disk().changed.notify_all();
    disk().changed.wait(lock, [] { return !disk().held; });
    --disk().waiting;
    if (disk().room == 0) return failed(disk().write_error);
    count = static_cast<std::size_t>(std::min<std::uint64_t>(count, disk().room));
    if (disk().room != UINT64_MAX) disk().room -= count;
    disk().written += count;
  }
  lock.unlock();
  return ::syscall(SYS_write, descriptor, bytes, count);
}

int ftruncate(int descriptor, off_t size) noexcept {
  const std::lock_guard lock(disk().mutex);
  if (disk().cut_error != 0 && is_ours(descriptor)) return failed(disk().cut_error);
  return static_cast<int>(::syscall(SYS_ftruncate, descriptor, size));
}

int fsync(int descriptor) {
  std::unique_lock lock(disk().mutex);
  const bool ours = is_ours(descriptor), folder = is_our_folder(descriptor);
  if (disk().sync_error != 0 && ours) return failed(disk().sync_error);
  struct stat status {};
  if (ours) ::fstat(descriptor, &status);
  const bool part = ::access((disk().path + ".part").c_str(), F_OK) == 0;
  const bool whole = ::access(disk().path.c_str(), F_OK) == 0;
  lock.unlock();
  const int result = static_cast<int>(::syscall(SYS_fsync, descriptor));
  lock.lock();
  if (ours) disk().kept.bytes = static_cast<std::uint64_t>(status.st_size);
  if (ours) ++disk().kept.syncs;
  if (folder) disk().kept.part = part;
  if (folder) disk().kept.whole = whole;
  return result;
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept {
  const std::lock_guard lock(disk().mutex);
  if (disk().rename_error != 0 && is_ours(std::string(to))) return failed(disk().rename_error);
  struct stat status {};
  if (is_ours(std::string(from)) && ::stat(from, &status) == 0)
    disk().kept.renamed_unsynced = static_cast<std::uint64_t>(status.st_size) != disk().kept.bytes;
  return static_cast<int>(::syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}

}  // extern "C"

namespace lumbrical::test {

FaultyDisk::FaultyDisk(const std::string& path) {
  const std::lock_guard lock(disk().mutex);
  disk().path = path;
  disk().written = 0;
  disk().kept = {};
}

FaultyDisk::~FaultyDisk() {
  const std::lock_guard lock(disk().mutex);
  disk().path.clear();
  disk().room = UINT64_MAX;
  disk().write_error = disk().cut_error = disk().sync_error = disk().rename_error = 0;
  disk().held = false;
  disk().changed.notify_all();
}

void FaultyDisk::fail_after(std::uint64_t bytes, int error) {
  const std::lock_guard lock(disk().mutex);
  disk().room = bytes;
  disk().write_error = error;
}

void FaultyDisk::fail_cuts(int error) {
  const std::lock_guard lock(disk().mutex);
  disk().cut_error = error;
}

void FaultyDisk::fail_syncs(int error) {
  const std::lock_guard lock(disk().mutex);
  disk().sync_error = error;
}

void FaultyDisk::fail_renames(int error) {
  const std::lock_guard lock(disk().mutex);
  disk().rename_error = error;
}

void FaultyDisk::hold() {
  const std::lock_guard lock(disk().mutex);
  disk().held = true;
}

void FaultyDisk::release() {
  const std::lock_guard lock(disk().mutex);
  disk().held = false;
  disk().changed.notify_all();
}

void FaultyDisk::wait_until_held() const {
  std::unique_lock lock(disk().mutex);
  disk().changed.wait(lock, [] { return disk().held && disk().waiting > 0; });
}

Kept FaultyDisk::kept() const {
  const std::lock_guard lock(disk().mutex);
  return disk().kept;
}

std::uint64_t FaultyDisk::written() const {
  const std::lock_guard lock(disk().mutex);
  return disk().written;
}

}  // namespace lumbrical::test
