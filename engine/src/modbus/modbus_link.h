// One Modbus connection: libmodbus opens it; requests and replies are made, bounded and checked here.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "lumbrical/device_profile.h"
#include "lumbrical/device_wire.h"
#include "modbus/modbus_frame.h"

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
  int exception = 0;      ///< code of a refusal
  [[nodiscard]] bool ok() const { return outcome == LinkOutcome::done; }
};

class ModbusLink {
 public:
  ~ModbusLink() { close(); }
  /// Connects within `timeout` [s] once the host is found, which its addresses share; to a serial line
  /// listens for as long, and forgets what comes: a late reply would pass for one to the first request.
  /// Refuses a serial line that did not take the baud rate (libmodbus then silently uses 9600).
  Status open(const Transport& transport, double timeout);
  void close();

  LinkResult write(const RegisterBlock& block, const std::uint16_t* words);         ///< FC16
  LinkResult read(int function, const RegisterBlock& block, std::uint16_t* words);  ///< FC3, FC4
  LinkResult exchange(const RegisterBlock& write, const std::uint16_t* sent, const RegisterBlock& read,
                      std::uint16_t* words);  ///< FC23

  Patience patience;  ///< of the next request on

 private:
  Status open_tcp(const Transport& transport, double timeout);
  Status open_line(const Transport& transport, double timeout);
  Status lock_line(const std::string& line);
  void await_late_replies(double timeout) const;
  std::int64_t hurry_up(bool& hurried, std::int64_t end) const;
  LinkResult transact(ModbusQuestion question, const std::uint16_t* sent, std::uint16_t* words);
  LinkResult send(std::int64_t end);
  LinkResult receive(const ModbusQuestion& question, std::int64_t end, std::uint16_t* words);
  const char* forget_input();
  struct Free {
    void operator()(_modbus* context) const;
  };
  std::unique_ptr<_modbus, Free> context_;
  int file_ = -1;  // of the connection; libmodbus closes it
  int lock_ = -1;  // the line, opened once more: held until libmodbus has put its settings back
  bool serial_ = false;
  double silence_ = 0;  // [s] between frames of a serial line
  std::uint16_t transaction_ = 0;
  Bytes frame_, received_;
};

}  // namespace lumbrical
