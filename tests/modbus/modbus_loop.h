// A sink that ticks feed, and a simulated device on a real socket.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "lumbrical/device_sink.h"
#include "simulated_wire.h"

namespace lumbrical::test {

class ModbusLoop : public ::testing::Test {
 protected:
  // Connected, armed, and 0.1 N m acting.
  void start(const SinkOptions& options = {}) {
    device.listen();
    profile.transport.port = device.port();
    sink.open(profile, options);
    ASSERT_TRUE(acts()) << sink.log();
  }
  bool acts() {
    return eventually([&] { return std::fabs(device.torque() - 0.1) < 1e-6; });
  }
  bool rests() {
    return eventually([&] { return device.torque() == 0; });
  }
  DeviceProfile profile = test::patient_profile();
  ServedDevice device{profile};
  TickingSink sink;
};

}  // namespace lumbrical::test
