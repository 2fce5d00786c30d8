// What the program says about devices where it was built without libmodbus.
#include "commands.h"
#include "device_loop.h"

namespace lumbrical::tool {

struct DeviceLoop::Loop {};

namespace {
const char* const kRemedy =
    "this program was built without libmodbus; install libmodbus-dev and build it again";
}

std::string check_sink_uri(std::string& text) { return text == "null" ? std::string() : kRemedy; }

DeviceLoop::DeviceLoop() = default;
DeviceLoop::~DeviceLoop() = default;
Status DeviceLoop::open(const std::string&, const std::vector<Model>&, std::size_t&) {
  return Status::error(kRemedy);
}
void DeviceLoop::before(DeviceFrame&) {}
bool DeviceLoop::after(const Scratch&, const DeviceFrame&, const ActuatorFrame&, TickRecord&) {
  return false;
}
void DeviceLoop::certify() {}
void DeviceLoop::measure_again() {}
void DeviceLoop::arm() {}
bool DeviceLoop::forces_flow() const { return false; }
std::vector<std::string> DeviceLoop::trouble() const { return {}; }
std::uint64_t DeviceLoop::ticks_without_angles() const { return 0; }
std::string DeviceLoop::certificate_text() const { return {}; }
void DeviceLoop::close() {}
Json DeviceLoop::json() const { return {}; }
void DeviceLoop::add_rows(Table&) const {}

namespace {
void add_missing(Command& app, const char* name, int& exit_code) {
  Command* const command = app.add_subcommand(name, kRemedy);
  command->allow_extras();
  command->callback([&exit_code] { exit_code = fail(kRemedy); });
}
}  // namespace

void add_sim_device(Command& app, int& exit_code) { add_missing(app, "sim-device", exit_code); }
void add_guard(Command& app, int& exit_code) { add_missing(app, "guard", exit_code); }

}  // namespace lumbrical::tool
