// See replace_file.h.
#include "replace_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

namespace lumbrical::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMarkWithin = 4096;  // bytes from a file's beginning

bool write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

// A file's new name is on the disk when its folder is. Some file systems can't: then it is as good as it
// gets.
void sync_folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  const int opened = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) return;
  ::fsync(opened);
  ::close(opened);
}

bool is_ours(const std::string& path, std::string_view mark) {
  std::ifstream file(path, std::ios::binary);
  std::string start(kMarkWithin, '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  return file.is_open() && !file.bad() && (start.empty() || start.find(mark) != std::string::npos);
}

Status write_part(const std::string& path, const std::string& part, std::string_view text) {
  const int file = ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (file < 0 && errno == EEXIST)
    return Status::error(part + ": exists: another process is writing it, or one was killed and it can go");
  const auto why = [] { return std::generic_category().message(errno) + "; give it another name or place"; };
  if (file < 0 && errno == ENOENT)
    return Status::error(path + ": its folder is not there; make it or check the path");
  if (file < 0) return Status::error(path + ": cannot be created: " + why());
  Status status;
  if (!write_all(file, text) || ::fsync(file) != 0)
    status = Status::error(part + ": cannot be written: " + why());
  if (::close(file) != 0 && status.ok()) status = Status::error(part + ": cannot be written: " + why());
  if (!status.ok()) ::unlink(part.c_str());
  return status;
}

}  // namespace

Status replace_own_file(const std::string& path, std::string_view text) {
  struct stat there {};
  if (::stat(path.c_str(), &there) == 0 && !S_ISREG(there.st_mode))
    return Status::error(path + ": is not a file; give it another name");
  const std::string part = path + ".part";
  if (Status status = write_part(path, part, text); !status.ok()) return status;
  if (std::rename(part.c_str(), path.c_str()) != 0) {
    const std::string why = std::generic_category().message(errno);
    ::unlink(part.c_str());
    return Status::error(path + ": cannot be replaced: " + why + "; give it another name or place");
  }
  sync_folder_of(path);
  return {};
}

Status replace_file(const std::string& path, std::string_view text, const std::string& kind,
                    std::string_view mark) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored) && !is_ours(path, mark))
    return Status::error(path + ": exists and is no " + kind + "; give it another name");
  return replace_own_file(path, text);
}

Status check_apart(std::initializer_list<std::string> paths) {
  std::vector<fs::path> seen;
  for (const std::string& path : paths) {
    if (path.empty()) continue;
    std::error_code ignored;
    const fs::path whole = fs::weakly_canonical(fs::absolute(path, ignored), ignored);
    for (const fs::path& other : seen)
      if (whole == other || fs::equivalent(whole, other, ignored))
        return Status::error(path + ": is named twice; give each its own file");
    seen.push_back(whole);
  }
  return {};
}

}  // namespace lumbrical::tool
