// Fuzzes device profiles (JSON): what is taken is consistent, and its registers fit into Modbus requests.
#include "fuzz_input.h"
#include "lumbrical/device_profile.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lumbrical;
  const test::MemoryFile file(data, size);
  if (!file.good()) return 0;
  DeviceProfile profile;
  if (!load_device_profile(file.path(), profile).ok()) return 0;
  if (!check_profile(profile).ok() || profile.actuators.empty() || profile.actuators.size() > kMaxActuators ||
      profile.sensors.size() > kAngleCount)
    __builtin_trap();
  const ExchangePlan plan = plan_exchange(profile);
  for (const RegisterBlock& block : plan.writes)
    if (block.count == 0 || block.count > kMaxWriteRegisters || block.address + block.count > 0x10000)
      __builtin_trap();
  for (const RegisterBlock& block : plan.reads)
    if (block.count == 0 || block.count > kMaxReadRegisters || block.address + block.count > 0x10000)
      __builtin_trap();
  return 0;
}
