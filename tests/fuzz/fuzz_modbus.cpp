// Fuzzes Modbus as both ends meet it: replies against the question they should answer, requests cut out of a
// stream and answered.
#include <algorithm>
#include <array>
#include <cstring>
#include <span>

#include "modbus/modbus_frame.h"

namespace {

using namespace lumbrical;

// A right reply holds its words, and is not called wrong before its last byte has come.
void check_replies(std::span<const std::uint8_t> input) {
  if (input.size() < 12) return;
  const auto word = [&](std::size_t at) {
    return static_cast<std::uint16_t>(input[at] << 8 | input[at + 1]);
  };
  constexpr std::uint8_t kFunctions[] = {3, 4, 16, 23};
  ModbusQuestion question;
  question.serial = (input[0] & 1) != 0;
  question.function = kFunctions[input[0] >> 1 & 3];
  question.unit = input[1];
  question.transaction = word(2);
  question.write_address = word(4);
  question.write_count = static_cast<std::uint16_t>(word(6) % 122);
  question.read_address = word(8);
  question.read_count = static_cast<std::uint16_t>(word(10) % 126);
  const std::span<const std::uint8_t> received = input.subspan(12);
  const ReplyCheck check = check_reply(question, received);
  if (check.kind == ReplyKind::wrong && std::strlen(check.why) == 0) __builtin_trap();
  if (check.kind != ReplyKind::right && check.kind != ReplyKind::exception) return;
  if (check.kind == ReplyKind::right && question.function != 16 &&
      check.words + 2 * std::size_t{question.read_count} > received.size())
    __builtin_trap();
  for (std::size_t size = 0; size < received.size(); ++size)
    if (check_reply(question, received.first(size)).kind != ReplyKind::incomplete) __builtin_trap();
}

// However the bytes of a stream are parted, no request is made of bytes that are not there.
void answer_stream(std::span<const std::uint8_t> input, bool serial) {
  std::array<std::uint16_t, 200> registers{};
  RegisterAccess access;
  access.has_unit = [](std::uint8_t unit) { return unit < 3; };
  const auto is_there = [&](std::uint16_t address, std::size_t count) {
    return address + count <= registers.size();
  };
  access.read = [&](std::uint8_t, std::uint16_t address, std::span<std::uint16_t> words) {
    if (!is_there(address, words.size())) return 2;
    for (std::size_t i = 0; i < words.size(); ++i) words[i] = registers[address + i];
    return 0;
  };
  access.write = [&](std::uint8_t, std::uint16_t address, std::span<const std::uint16_t> words) {
    if (!is_there(address, words.size())) return 2;
    for (std::size_t i = 0; i < words.size(); ++i) registers[address + i] = words[i];
    return 0;
  };
  Bytes received;
  for (std::size_t at = 0; at < input.size();) {
    const std::size_t piece = std::min<std::size_t>(1 + input[at] % 16, input.size() - at);
    received.insert(received.end(), input.begin() + static_cast<std::ptrdiff_t>(at),
                    input.begin() + static_cast<std::ptrdiff_t>(at + piece));
    at += piece;
    for (;;) {
      const std::size_t before = received.size();
      ModbusRequest request;
      const Cut cut = serial ? cut_rtu(received, request) : cut_tcp(received, request);
      if (cut == Cut::broken) return;
      if (cut == Cut::incomplete) break;
      if (received.size() >= before || request.body.empty()) __builtin_trap();
      const Bytes answer = answer_request(access, request.unit, request.body);
      if (answer.size() < 2 || answer.size() > 253) __builtin_trap();
      static_cast<void>(serial ? frame_rtu(request, answer) : frame_tcp(request, answer));
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const std::uint8_t> input(data + 1, size - 1);
  if (data[0] % 4 < 2) {
    check_replies(input);
  } else {
    answer_stream(input, data[0] % 4 == 3);
  }
  return 0;
}
