// lumbrical guard: what DeviceGuard starts, so that someone lets go of the device of a session that was
// killed.
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "commands.h"
#include "lumbrical/device_guard.h"
#include "lumbrical/device_sink.h"
#include "output.h"
#include "sink_uri.h"

namespace lumbrical::tool {
namespace {

constexpr double kPersistence = 10;  // [s] to reach a device that may still hold the dead one's connection

int guard(const std::string& text) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, SIG_IGN);
  if (text == "null")
    return fail("\"null\" is no device that could be let go of; name one as for run --sink, without null");
  SinkUri uri;
  DeviceProfile profile;
  if (Status status = parse_sink_uri(text, uri); !status.ok()) return fail(status);
  if (Status status = load_profile(uri, profile); !status.ok()) return fail(status);
  std::unique_ptr<DeviceWire> wire;
  if (Status status = make_wire(profile, wire); !status.ok()) return fail(status);
  if (!bereaved()) return kDone;
  SinkOptions options;
  options.arm = false;
  options.take_over = true;
  options.thread = true;
  DeviceSink sink;
  if (Status status = sink.open(profile, std::move(wire), options); !status.ok()) return fail(status);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kPersistence);
  while (!sink.is_safe() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const bool safe = sink.close();  // before a word is said, which may find no one who reads it
  std::fprintf(stderr, "guard: the session has ended without letting go of %s; what was done about it:\n",
               printable(profile.name).c_str());
  for (const SinkEvent& event : sink.events())
    std::fprintf(stderr, "guard: %s\n", printable(event.text).c_str());
  return safe ? kDone : kNoForces;
}

}  // namespace

void add_guard(Command& app, int& exit_code) {
  const auto uri = std::make_shared<std::string>();
  Command* const command = app.add_subcommand(
      "guard", "Let go of a device when standard input ends; `run` has one of its own for when it is killed");
  command->add_option("sink", *uri, "As for run --sink")->required();
  command->callback([uri, &exit_code] { exit_code = guard(*uri); });
}

}  // namespace lumbrical::tool
