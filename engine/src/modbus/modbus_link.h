// One Modbus connection: libmodbus with its recovery switched off and its traps checked.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "lumbrical/device_profile.h"

struct _modbus;

namespace lumbrical {

enum class LinkOutcome : std::uint8_t {
  done,
  refused,  ///< an exception reply: the device lives and said no
  broken,   ///< late, torn, foreign or no reply: what comes next on this connection can't be trusted
};

struct LinkResult {
  LinkOutcome outcome = LinkOutcome::done;
  const char* text = "";  ///< of the error; static
  [[nodiscard]] bool ok() const { return outcome == LinkOutcome::done; }
};

class ModbusLink {
 public:
  ModbusLink() = default;
  ModbusLink(ModbusLink&&) = default;
  ModbusLink& operator=(ModbusLink&&) = default;
  ~ModbusLink() { close(); }

  /// Connects within `timeout` [s], which is also what every later request waits for its reply. Refuses a
  /// serial line that did not take the baud rate (libmodbus then silently uses 9600).
  Status open(const Transport& transport, double timeout);
  void close();
  [[nodiscard]] bool is_open() const { return context_ != nullptr; }

  LinkResult write(const RegisterBlock& block, const std::uint16_t* words);         ///< FC16
  LinkResult read(int function, const RegisterBlock& block, std::uint16_t* words);  ///< FC3, FC4
  LinkResult exchange(const RegisterBlock& write, const std::uint16_t* sent, const RegisterBlock& read,
                      std::uint16_t* words);  ///< FC23

 private:
  LinkResult result(int answer, int count);
  bool address(std::uint8_t unit);
  void keep_silence() const;
  struct Free {
    void operator()(_modbus* context) const;
  };
  std::unique_ptr<_modbus, Free> context_;
  double silence_ = 0;  // [s] between frames of a serial line
};

/// [s] one cycle takes on a serial line: characters on the wire and the silence of 3.5 of them between
/// frames. 0 for TCP.
double line_time(const DeviceProfile& profile);

}  // namespace lumbrical
