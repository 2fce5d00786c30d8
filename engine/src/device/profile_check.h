// What a device profile must satisfy beyond the ranges of its single fields.
#pragma once

#include <string>
#include <vector>

#include "lumbrical/device_profile.h"
#include "model/ranges.h"

namespace lumbrical {

// What a profile's numbers may be: its file's reader and its check go by this list.
namespace range {

inline constexpr Range exchange_rate{0.1, 20000, " Hz"}, response_timeout{0.001, 10, " s"},
    first_retry{0.001, 60, " s"}, last_retry{0.001, 600, " s"}, read_back{0.01, 10, " s"};  // or none
inline constexpr Range device_fade{0.001, 1, " s"}, soft_start{0, 60, " s"}, tick_hold{0.0001, 1, " s"},
    tick_timeout{0.001, 10, " s"}, answer_timeout{0.001, 10, " s"};
inline constexpr Range baud{300, 10000000}, stop_bits{1, 2};
inline constexpr Range sensed_angle{-7, 7, " rad"}, own_delay{0, 1, " s"};
inline constexpr Range joint_inertia{0, 1, " kg m^2"}, joint_damping{0, 1e3, " N m s/rad"},
    joint_friction{0, 1e3, " N m"}, encoder_step{0, 1, " rad"};

}  // namespace range

struct NamedField {
  RegisterField field;
  std::string path;  ///< in a profile's file
};

/// All that a cycle writes, control word and heartbeat too.
std::vector<NamedField> written_fields(const DeviceProfile& profile);

struct ProfileFault {
  std::string path;  ///< of the field in a profile's file; empty with an empty `what`: no fault
  std::string what;
};

/// Is the encoder of the sensor's joint said to be finer than the register that tells of it?
bool is_finer_than_told(const DeviceProfile& profile, const Sensor& sensor);

/// The first fault that is found.
ProfileFault find_fault(const DeviceProfile& profile);

}  // namespace lumbrical
