// The wire that speaks UDP: a datagram to the device in each cycle, one back (schemas/datagram.fbs). For
// simulators and devices with a library of their own, in any language that has FlatBuffers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lumbrical/device_profile.h"
#include "lumbrical/device_wire.h"
#include "lumbrical/status.h"

namespace lumbrical {

inline constexpr std::size_t kMostDatagram = 2048;  ///< [bytes] longer ones are discarded
/// Datagrams looked at in one cycle: who floods the port does not hold up the sink.
inline constexpr int kMostDatagramsPerCycle = 64;

/// To Transport::host and port, from nowhere else and no one else: a datagram from another address, of
/// another session, late, too long or no FlatBuffer of the schema is none. A lost one is a cycle that is not
/// acknowledged. Each open tries the next of the host's addresses. Another machine than this is refused
/// unless Transport::anywhere.
Status make_datagram_wire(const DeviceProfile& profile, std::unique_ptr<DeviceWire>& wire);

// The device's side, for those that are written in C++.

struct CommandDatagram {
  std::uint64_t session = 0, cycle = 0;
  bool active = false;
  ActuatorArray value{};
  std::array<LocalModel, kMaxActuators> local{};
};

/// False: no command, or one of other than `actuator_count` actuators, or with a number that is none.
bool read_command(std::span<const std::byte> datagram, std::size_t actuator_count, CommandDatagram& command);

/// The answer to a command.
void write_feedback(const CommandDatagram& command, const DeviceStatus& status,
                    std::span<const float, kAngleCount> angle, std::uint32_t valid,
                    std::vector<std::byte>& datagram);

}  // namespace lumbrical
