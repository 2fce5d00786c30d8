// The registers of one cycle: commands into words, words into angles and status.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lumbrical/modbus_sink.h"

namespace lumbrical {

struct DeviceStatus {
  bool ready = true, fault = false, stop = false, dead_man = true;
  std::uint16_t echo = 0;
};

/// The words of all blocks of a profile's plan, one behind the other. Sized once.
struct ExchangeWords {
  ExchangePlan plan;
  std::vector<std::uint16_t> written, read;

  /// Bytes that no field claims hold what the handshake wrote there, or 0.
  explicit ExchangeWords(const DeviceProfile& profile);
  void write(const DeviceProfile& profile, const SafetyOutput& output, const DeviceCommand& command,
             std::uint16_t heartbeat);
  /// The commands that `written` stands for, within each actuator's limits.
  void commands(const DeviceProfile& profile, ActuatorArray& command) const;
  [[nodiscard]] DeviceStatus status(const DeviceProfile& profile) const;
  void angles(const DeviceProfile& profile, std::array<float, 4 * kFingerCount>& angle,
              std::uint32_t& valid) const;
};

}  // namespace lumbrical
