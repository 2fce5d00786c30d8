// The registers of one cycle: commands into words, words into angles and status.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "lumbrical/device_wire.h"

namespace lumbrical {

inline constexpr std::size_t kLookBack =
    16;  ///< registers read back at once: little beside a cycle of a slow bus

/// The words of all blocks of a profile's plan, one behind the other. Sized once.
struct ExchangeWords {
  ExchangePlan plan;
  std::vector<std::uint16_t> written, read;
  std::vector<std::uint16_t> claimed;                ///< bits of `written` that fields write
  std::array<std::uint16_t, kLookBack> read_back{};  ///< a part of `written` as the device has it

  /// Bytes that no field claims hold what the handshake wrote there, or 0.
  explicit ExchangeWords(const DeviceProfile& profile);
  void write(const DeviceProfile& profile, const WireCommand& command);
  /// The heartbeat's word in `written`; null: the profile has none.
  std::uint16_t* heartbeat(const DeviceProfile& profile);
  /// The commands that `written` stands for, within each actuator's limits.
  void commands(const DeviceProfile& profile, ActuatorArray& command) const;
  /// The index'th of the parts of at most kLookBack registers that what is written consists of, round and
  /// round, and where it begins in `written`.
  [[nodiscard]] std::pair<RegisterBlock, std::size_t> part(std::size_t index) const;
  /// Whether `read_back` holds what was written to that part.
  [[nodiscard]] bool holds(const RegisterBlock& block, std::size_t at) const;
  [[nodiscard]] DeviceStatus status(const DeviceProfile& profile) const;
  void angles(const DeviceProfile& profile, std::array<float, kAngleCount>& angle,
              std::uint32_t& valid) const;
};

}  // namespace lumbrical
