// Fuzzes the datagrams of a device's wire, as both ends read them.
#include <span>
#include <vector>

#include "loop/datagram_message.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lumbrical;
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  std::uint64_t cycle = 0;
  WireAnswer answer;
  static_cast<void>(read_feedback(bytes, 1, cycle, answer));
  CommandDatagram command;
  if (!read_command(bytes, 3, command)) return 0;
  // What was believed is written, and read as it was.
  std::vector<std::byte> reply;
  write_feedback(command, {}, answer.angle, answer.valid, reply);
  if (!read_feedback(reply, command.session, cycle, answer) || cycle != command.cycle) __builtin_trap();
  return 0;
}
