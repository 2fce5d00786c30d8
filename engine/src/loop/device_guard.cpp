// See lumbrical/device_guard.h.
#include "lumbrical/device_guard.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "base/steady_clock.h"

extern char** environ;

namespace lumbrical {
namespace {

constexpr char kReady = 'r', kDismissed = 'x';
constexpr double kPatience = 5;  // [s] with a guard that starts

// A process with `input` as its standard input. Returns an error as errno has it.
int spawn(std::vector<std::string>& command, int input, pid_t& process) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  std::vector<char*> words;
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  const int error = posix_spawn(&process, words[0], &files, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return error;
}

// Why there is no guard at the other end; nullptr: it has said that it stands there.
const char* await_guard(int pipe) {
  const std::int64_t end = steady_ns() + in_ns(kPatience);
  for (std::int64_t left = end - steady_ns(); left > 0; left = end - steady_ns()) {
    pollfd file{pipe, POLLIN, 0};
    if (poll(&file, 1, static_cast<int>(left / 1000000 + 1)) <= 0) continue;
    char word = 0;
    return recv(pipe, &word, 1, 0) == 1 ? nullptr : "ended before it stood guard, and may have said why";
  }
  return "did not say in 5 s that it stands guard";
}

}  // namespace

DeviceGuard::~DeviceGuard() {
  if (pipe_ >= 0) close(pipe_);
}

Status DeviceGuard::start(std::vector<std::string> command) {
  assert(!command.empty());
  assert(pipe_ < 0 && "one guard at a time: dismiss the last");
  std::array<int, 2> ends{};
  // Sockets do for a pipe: both ends speak, and a word to a guard that is gone is no signal.
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return Status::error(std::string("no guard: ") + std::strerror(errno));
  const int error = spawn(command, ends[0], process_);
  close(ends[0]);
  const char* const fault = error != 0 ? std::strerror(error) : await_guard(ends[1]);
  if (fault == nullptr) {
    pipe_ = ends[1];
    return {};
  }
  // What is slow must not take the end of the pipe for that of the session.
  if (error == 0 && waitpid(process_, nullptr, WNOHANG) == 0) {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  close(ends[1]);
  return Status::error("no guard: " + command[0] + ": " + fault);
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
  const ssize_t sent = send(STDIN_FILENO, &kReady, 1, MSG_NOSIGNAL);  // to no one where it is no socket
  static_cast<void>(sent);
  char word = 0;
  for (;;) {
    const ssize_t count = read(STDIN_FILENO, &word, 1);
    if (count < 0 && errno == EINTR) continue;
    return count <= 0 || word != kDismissed;
  }
}

}  // namespace lumbrical
