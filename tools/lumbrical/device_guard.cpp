// See device_guard.h.
#include "device_guard.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>
#include <thread>

#include "commands.h"
#include "lumbrical/modbus_sink.h"
#include "output.h"
#include "sink_uri.h"

extern char** environ;

namespace lumbrical::tool {
namespace {

constexpr char kDismissed = 'x';
constexpr double kPersistence = 10;  // [s] to reach a device that may still hold the dead one's connection

// Whether the process at the other end of the pipe is gone without a word.
bool bereaved() {
  char word = 0;
  for (;;) {
    const ssize_t count = read(STDIN_FILENO, &word, 1);
    if (count < 0 && errno == EINTR) continue;
    return count <= 0 || word != kDismissed;
  }
}

int guard(const std::string& text) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, SIG_IGN);
  SinkUri uri;
  DeviceProfile profile;
  if (Status status = parse_sink_uri(text, uri); !status.ok()) return fail(status);
  if (Status status = load_profile(uri, profile); !status.ok()) return fail(status);
  if (!bereaved()) return kDone;
  std::fprintf(stderr, "guard: the session was killed; letting go of %s\n", printable(profile.name).c_str());
  SinkOptions options;
  options.arm = false;
  options.take_over = true;
  ModbusSink sink;
  if (Status status = sink.open(profile, options); !status.ok()) return fail(status);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kPersistence);
  while (!sink.is_safe() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const bool safe = sink.close();
  for (const SinkEvent& event : sink.events())
    std::fprintf(stderr, "guard: %s\n", printable(event.text).c_str());
  return safe ? kDone : kNoForces;
}

}  // namespace

DeviceGuard::~DeviceGuard() {
  if (pipe_ >= 0) close(pipe_);
}

Status DeviceGuard::start(const std::string& sink_uri) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    return Status::error(std::string("no guard: ") + std::strerror(errno));
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, ends[0], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  std::string name = "lumbrical", command = "guard", uri = sink_uri;
  std::array<char*, 4> words = {name.data(), command.data(), uri.data(), nullptr};
  const int error = posix_spawn(&process_, "/proc/self/exe", &files, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  close(ends[0]);
  if (error != 0) {
    close(ends[1]);
    return Status::error(std::string("no guard process: ") + std::strerror(error) +
                         "; guard=off goes without");
  }
  pipe_ = ends[1];
  return {};
}

void DeviceGuard::dismiss() {
  if (pipe_ < 0) return;
  const ssize_t written = write(pipe_, &kDismissed, 1);  // a guard that is gone needs no word
  static_cast<void>(written);
  close(pipe_);
  pipe_ = -1;
  waitpid(process_, nullptr, 0);
}

void add_guard(Command& app, int& exit_code) {
  const auto uri = std::make_shared<std::string>();
  Command* const command = app.add_subcommand(
      "guard", "Let go of a device when standard input ends; `run` has one of its own for when it is killed");
  command->add_option("sink", *uri, "As for run --sink")->required();
  command->callback([uri, &exit_code] { exit_code = guard(*uri); });
}

}  // namespace lumbrical::tool
