// Where the viewer's page is, and how it comes before a person's eyes.
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "page_server.h"

namespace lumbrical::tool {

namespace fs = std::filesystem;

namespace {

// Whoever waits for the end of our output doesn't wait for the browser, and a signal to us is none to it.
void let_go_of_everything() {
  setsid();
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  std::signal(SIGPIPE, SIG_DFL);
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int own : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, own);
  close_range(STDERR_FILENO + 1, ~0u, 0);
}

}  // namespace

Status read_viewer_page(std::string& html) {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  // Installed, and in a build's folder.
  for (const char* place : {"../share/lumbrical/viewer.html", "../viewer/viewer.html"}) {
    std::ifstream file(folder / place, std::ios::binary);
    if (!file) continue;
    html.assign(std::istreambuf_iterator<char>(file), {});
    return {};
  }
  return Status::error(
      "the viewer's page is not installed with this program; to build it, install emscripten, node and npm "
      "(tools/setup), "
      "configure anew, and build the target `viewer`");
}

void open_browser(const std::string& address) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  const pid_t child = fork();
  if (child == 0) {
    // Twice, so that nobody has to wait for the browser.
    if (fork() == 0) {
      let_go_of_everything();
      execlp("xdg-open", "xdg-open", address.c_str(), static_cast<char*>(nullptr));
    }
    _exit(0);
  }
  if (child > 0) waitpid(child, nullptr, 0);
}

std::string percent_encoded(const std::string& name) {
  std::string result;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '.' || c == '_';
    if (plain) {
      result += c;
    } else {
      const auto byte = static_cast<unsigned char>(c);
      result += {'%', "0123456789ABCDEF"[byte >> 4], "0123456789ABCDEF"[byte & 15]};
    }
  }
  return result;
}

}  // namespace lumbrical::tool
