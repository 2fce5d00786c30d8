// What the program says about Modbus where it was built without libmodbus.
#include "commands.h"
#include "lumbrical/modbus_wire.h"
#include "output.h"

namespace lumbrical {
namespace {
const char* const kRemedy =
    "this program was built without libmodbus; install libmodbus-dev and build it again";
}

Status make_modbus_wire(const DeviceProfile&, std::unique_ptr<DeviceWire>&) { return Status::error(kRemedy); }

namespace tool {

void add_sim_device(Command& app, int& exit_code) {
  Command* const command = app.add_subcommand("sim-device", kRemedy);
  command->allow_extras();
  command->callback([&exit_code] { exit_code = fail(kRemedy); });
}

}  // namespace tool
}  // namespace lumbrical
