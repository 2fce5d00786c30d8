// The wire of shared memory: for a simulator or a device's own library in another process of this machine.
// What that process does is in shared_device.h.
#pragma once

#include <memory>

#include "lumbrical/device_profile.h"
#include "lumbrical/device_wire.h"
#include "lumbrical/status.h"

namespace lumbrical {

/// Of the region Transport::region, "/name", which the device creates. Refused, again and again until there
/// is another: a region of another user or one that others may write to, too small, of another layout, or one
/// that another session drives. A region that was made anew is opened again.
Status make_shared_memory_wire(const DeviceProfile& profile, std::unique_ptr<DeviceWire>& wire);

}  // namespace lumbrical
