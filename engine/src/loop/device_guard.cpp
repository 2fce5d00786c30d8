// See lumbrical/device_guard.h.
#include "lumbrical/device_guard.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <cstring>

extern char** environ;

namespace lumbrical {
namespace {

constexpr char kDismissed = 'x';

}  // namespace

DeviceGuard::~DeviceGuard() {
  if (pipe_ >= 0) close(pipe_);
}

Status DeviceGuard::start(std::vector<std::string> command) {
  assert(!command.empty());
  assert(pipe_ < 0 && "one guard at a time: dismiss the last");
  std::array<int, 2> ends{};
  // Sockets do for a pipe, and a word to a guard that is gone is then no signal.
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return Status::error(std::string("no guard: ") + std::strerror(errno));
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, ends[0], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  std::vector<char*> words;
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  const int error = posix_spawn(&process_, words[0], &files, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  close(ends[0]);
  if (error != 0) {
    close(ends[1]);
    return Status::error(std::string("no guard process: ") + std::strerror(error));
  }
  pipe_ = ends[1];
  return {};
}

void DeviceGuard::dismiss() {
  if (pipe_ < 0) return;
  const ssize_t written = send(pipe_, &kDismissed, 1, MSG_NOSIGNAL);  // a guard that is gone needs no word
  static_cast<void>(written);
  close(pipe_);
  pipe_ = -1;
  waitpid(process_, nullptr, 0);
}

bool bereaved() {
  char word = 0;
  for (;;) {
    const ssize_t count = read(STDIN_FILENO, &word, 1);
    if (count < 0 && errno == EINTR) continue;
    return count <= 0 || word != kDismissed;
  }
}

}  // namespace lumbrical
