// Modbus frames (MODBUS Application Protocol V1.1b3; Messaging on TCP/IP V1.0b; Serial Line V1.02). For a
// server: requests cut out of a stream, checked, answered. For a master: requests made, replies checked.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace lumbrical {

using Bytes = std::vector<std::uint8_t>;

/// Exceptions that we give. Of those that we get, the first two say that it will be no other the next time.
enum ModbusException : int { kIllegalFunction = 1, kIllegalAddress = 2, kIllegalValue = 3 };

/// The registers behind a server. Both answer 0 or an exception code.
struct RegisterAccess {
  std::function<bool(std::uint8_t unit)> has_unit;
  std::function<int(std::uint8_t unit, std::uint16_t address, std::span<std::uint16_t> words)> read;
  std::function<int(std::uint8_t unit, std::uint16_t address, std::span<const std::uint16_t> words)> write;
  /// Input registers (function 4); empty: the same as `read`.
  std::function<int(std::uint8_t unit, std::uint16_t address, std::span<std::uint16_t> words)> read_inputs{};
};

/// Answers a request of functions 3, 4, 6, 16 and 23; an exception for any other, and for counts that are
/// wrong. Both are function code and data, without address or checksum. Writes come before reads (FC23).
Bytes answer_request(const RegisterAccess& access, std::uint8_t unit, std::span<const std::uint8_t> request);

struct ModbusRequest {
  std::uint16_t transaction = 0;  ///< TCP only
  std::uint8_t unit = 0;
  Bytes body;  ///< function code and data
};

enum class Cut : std::uint8_t { request, incomplete, broken };

/// Takes the first request out of the bytes received so far. TCP: `broken` (close the connection) where the
/// bytes are no Modbus header. RTU: garbage is skipped byte by byte until a frame's checksum is right.
Cut cut_tcp(Bytes& received, ModbusRequest& request);
Cut cut_rtu(Bytes& received, ModbusRequest& request);

Bytes frame_tcp(const ModbusRequest& request, const Bytes& answer);
Bytes frame_rtu(const ModbusRequest& request, const Bytes& answer);

/// What a master asks: everything in the reply but the words is known from it.
struct ModbusQuestion {
  bool serial = false;
  std::uint16_t transaction = 0;  ///< TCP only
  std::uint8_t unit = 0;
  std::uint8_t function = 3;  ///< 3, 4, 16 or 23
  std::uint16_t write_address = 0, write_count = 0;
  std::uint16_t read_address = 0, read_count = 0;
};

/// The whole frame of a question over `frame`, whose memory is used again; `words` has write_count of them.
void frame_question(const ModbusQuestion& question, const std::uint16_t* words, Bytes& frame);

enum class ReplyKind : std::uint8_t { incomplete, right, exception, wrong };

struct ReplyCheck {
  ReplyKind kind = ReplyKind::incomplete;
  const char* why = "";   ///< of a wrong one, static
  int exception = 0;      ///< code of an exception
  std::size_t words = 0;  ///< where the read_count words of a right one begin [bytes]
};

/// Holds the bytes received so far against all that a reply must be: transaction, protocol, length, unit,
/// function, count of bytes or address, checksum, and nothing behind it. A wrong one is told from its first
/// wrong byte on.
ReplyCheck check_reply(const ModbusQuestion& question, std::span<const std::uint8_t> received);

}  // namespace lumbrical
