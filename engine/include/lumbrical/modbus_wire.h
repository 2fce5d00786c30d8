// The wire that speaks Modbus: registers of a device's profile, over TCP or a serial line.
#pragma once

#include <memory>

#include "lumbrical/device_profile.h"
#include "lumbrical/device_wire.h"
#include "lumbrical/status.h"

namespace lumbrical {

/// Refuses a profile whose registers don't agree (check_profile), and a public address.
Status make_modbus_wire(const DeviceProfile& profile, std::unique_ptr<DeviceWire>& wire);

}  // namespace lumbrical
