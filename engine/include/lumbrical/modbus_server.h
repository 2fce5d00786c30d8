// A simulated device on the wire: a Modbus server over TCP or over a pseudo-terminal (RTU), in real time,
// with faults on request.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "lumbrical/device_simulation.h"
#include "lumbrical/status.h"

namespace lumbrical {

/// What is wrong with a reply. `registers` is of the address that acknowledges a write (FC16), `behind` a
/// byte too many.
enum class WrongReply : std::uint8_t {
  nothing,
  transaction,
  protocol,
  length,
  unit,
  function,
  registers,
  behind
};

/// What goes wrong on the wire; may change while the server runs.
struct ServerFaults {
  std::atomic<bool> silent{false};     ///< takes requests, answers nothing
  std::atomic<bool> cut_reply{false};  ///< sends half of a reply, then closes (TCP) or falls silent (RTU)
  std::atomic<WrongReply> wrong{WrongReply::nothing};
  std::atomic<bool> garbage{false};   ///< random bytes before every reply (RTU), in its place (TCP)
  std::atomic<int> hide_commands{0};  ///< exception code for who reads them; 0: they can be read
  std::atomic<bool> refuse{false};    ///< closes every new connection at once
  std::atomic<int> exception{0};      ///< exception code in the place of every answer; 0: none
  std::atomic<double> delay{0};       ///< [s] before every reply
  std::atomic<double> jitter{0};      ///< [s] up to this much more, at random
  std::atomic<double> trickle{0};     ///< [s] between the bytes of a reply
};

/// Has one place at a time: a new one is opened in place of the one before.
class ModbusServer {
 public:
  ModbusServer();
  ~ModbusServer();  ///< closes
  ModbusServer(const ModbusServer&) = delete;
  ModbusServer& operator=(const ModbusServer&) = delete;

  /// Listens on an address of this machine, a number of IPv4 or IPv6; port 0 takes a free one, which port()
  /// tells.
  Status listen(const std::string& host, std::uint16_t port);
  /// Opens a pseudo-terminal; its other end is name(), and `link` (if not empty) a symbolic link to that.
  Status open_terminal(const std::string& link);
  /// Opens an existing serial line at the given baud rate.
  Status open_line(const std::string& path, std::uint32_t baud);

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool is_open_to_others() const { return open_to_others_; }  ///< listens beyond loopback

  /// Serves until `stop()` is true, asked at least every few milliseconds. Simulated time follows the clock.
  /// `observe` (may be empty) is called after every advance of it, on this thread.
  void serve(SimulatedDevice& device, ServerFaults& faults, const std::function<bool()>& stop,
             const std::function<void(SimulatedDevice&)>& observe = {});
  void close();

  [[nodiscard]] std::uint64_t requests() const { return requests_.load(); }

 private:
  struct Peer;
  struct Session;
  int listener_ = -1, line_ = -1;
  std::uint16_t port_ = 0;
  bool open_to_others_ = false;
  std::string name_, link_;
  std::atomic<std::uint64_t> requests_{0};
};

}  // namespace lumbrical
