// What a device profile must satisfy beyond the ranges of its single fields.
#pragma once

#include <string>

#include "lumbrical/device_profile.h"

namespace lumbrical {

struct ProfileFault {
  std::string path;  ///< of the field in a profile's file; empty with an empty `what`: no fault
  std::string what;
};

/// The first fault, in the order of the file's fields.
ProfileFault find_fault(const DeviceProfile& profile);

}  // namespace lumbrical
