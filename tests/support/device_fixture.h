// Profiles and random ones shared by the tests of the device's side.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "lumbrical/device_profile.h"
#include "random.h"

namespace lumbrical::test {

inline DeviceProfile shipped_profile(const std::string& name) {
  DeviceProfile profile;
  const Status status =
      load_device_profile(std::string(LUMBRICAL_SOURCE_DIR) + "/examples/devices/" + name + ".json", profile);
  EXPECT_TRUE(status.ok()) << status.message();
  return profile;
}

/// A device of `count` actuators of all drives, each tied to one to three joints.
inline DeviceProfile random_profile(Random& random, int count) {
  DeviceProfile profile;
  profile.name = "random";
  for (int i = 0; i < count; ++i) {
    Actuator actuator;
    actuator.name = "a" + std::to_string(i);
    actuator.drive = static_cast<Drive>(random.bits() % 3);
    actuator.field.address = static_cast<std::uint16_t>(i);
    actuator.field.scale = 0.01;
    actuator.lower = actuator.drive == Drive::motor ? -random.between(0.1, 3) : 0;
    actuator.upper = random.between(1, 10);
    if (actuator.drive == Drive::wire) actuator.preload = random.between(0, 0.5);
    actuator.slew = random.between(10, 1000);
    const std::size_t tied = 1 + random.bits() % 3;
    for (std::size_t k = 0; k < tied; ++k)
      actuator.arm[random.bits() % kPhalanxCount] = random.between(0.001, 0.05);
    profile.actuators.push_back(actuator);
  }
  return profile;
}

}  // namespace lumbrical::test
