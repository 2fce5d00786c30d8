// lumbrical view: recordings in the browser.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>

#include "commands.h"
#include "output.h"
#include "page_server.h"
#include "result_lines.h"
#include "switches.h"

namespace lumbrical::tool {
namespace {

struct ViewOptions {
  std::string recording, other;
  std::uint32_t port = 0;
  bool no_browser = false;
};

/// As the page calls it, whose addresses hold UTF-8 only.
std::string name_in_link(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return told_entry(name) == name ? name : "recording.mcap";
}

// One that is still written is under the name that it has until it is closed.
Status find_recording(std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::path growing = file.string() + ".part";
  const std::filesystem::file_type type = std::filesystem::status(file, error).type();
  if (type == std::filesystem::file_type::not_found) {
    if (!std::filesystem::is_regular_file(growing, error))
      return Status::error(file.string() + ": there is no such file; check the path");
    file = growing;
  } else if (type != std::filesystem::file_type::regular) {
    return Status::error(file.string() + ": is no file; name a recording");
  }
  return {};
}

// By its first bytes: what else cannot be read is told by the page, which says what and where.
Status check_recording(const std::filesystem::path& file) {
  constexpr std::string_view kMagic = "\x89MCAP0\r\n";
  std::string begin(kMagic.size(), '\0');
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return Status::error(file.string() + ": can't be opened; check its permissions");
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  const bool begun = file.extension() == ".part" && static_cast<std::size_t>(stream.gcount()) < kMagic.size();
  if (begun || begin == kMagic) return {};
  if (file.extension() == ".json")
    return Status::error(file.string() +
                         ": this is no recording; a scene is run: `lumbrical run SCENE --rate 1000 --view`");
  return Status::error(file.string() + ": this is not an MCAP file; name a recording");
}

int view(const ViewOptions& options) {
  PageContent content;
  std::string link;
  for (std::filesystem::path file : {options.recording, options.other}) {
    if (file.empty()) continue;
    if (Status status = find_recording(file); !status.ok()) return fail(status);
    if (Status status = check_recording(file); !status.ok()) return fail(status);
    const std::string place = link.empty() ? "a/" : "b/", name = name_in_link(file);
    content.files["/" + place + name] = std::filesystem::absolute(file).string();
    link += (link.empty() ? "#recording=" : "&recording=") + place + percent_encoded(name);
  }
  if (Status status = read_viewer_page(content.html); !status.ok()) return fail(status);
  // Blocked before the server's threads are there, so that the signal comes to this one.
  sigset_t ends;
  sigemptyset(&ends);
  sigaddset(&ends, SIGINT);
  sigaddset(&ends, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &ends, nullptr);
  PageServer server;
  if (Status status = server.start(std::move(content), static_cast<std::uint16_t>(options.port));
      !status.ok())
    return fail(status);
  const std::string address = "http://127.0.0.1:" + std::to_string(server.port()) + "/" + link;
  if (const int printed = print_text(address + "\nOpen it in a browser on this machine; Ctrl-C ends it.\n");
      printed != kDone)
    return printed;
  if (!options.no_browser) open_browser(address);
  int signal = 0;
  sigwait(&ends, &signal);
  return kDone;
}

}  // namespace

void add_view(Command& app, int& exit_code) {
  const auto options = std::make_shared<ViewOptions>();
  Command* const command =
      app.add_subcommand("view", "Show recordings in the browser, the second against the first");
  command
      ->add_option("recording", options->recording, "What to show; without it a lab opens, to move a hand in")
      ->type_name("REC.mcap");
  command->add_option("other", options->other, "What to compare it with")->type_name("OTHER.mcap");
  command->add_option("--port", options->port, "Of 127.0.0.1 to serve on; 0: any that is free")
      ->check(whole_number_in(0, 65535));
  command->add_flag("--no-browser", options->no_browser, "Print the address and open nothing");
  command->callback([options, &exit_code] { exit_code = view(*options); });
}

}  // namespace lumbrical::tool
