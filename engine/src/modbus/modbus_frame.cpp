// See modbus_frame.h.
#include "modbus/modbus_frame.h"

#include <array>
#include <cstddef>

#include "lumbrical/device_profile.h"

namespace lumbrical {
namespace {

constexpr std::size_t kLongestBody = 253;
constexpr std::uint8_t kWriteRegisters = 16, kReadInputs = 4;

std::uint16_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

void put_word(Bytes& bytes, std::uint16_t value) {
  bytes.push_back(static_cast<std::uint8_t>(value >> 8));
  bytes.push_back(static_cast<std::uint8_t>(value & 0xFF));
}

std::uint16_t modbus_crc(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? crc >> 1 ^ 0xA001u : crc >> 1;
  }
  return static_cast<std::uint16_t>(crc);
}

void put_checksum(Bytes& frame) {
  const std::uint16_t crc = modbus_crc(frame);
  frame.push_back(static_cast<std::uint8_t>(crc & 0xFF));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8));
}

Bytes exception(std::uint8_t function, int code) {
  return {static_cast<std::uint8_t>(function | 0x80), static_cast<std::uint8_t>(code)};
}

int read_words(const RegisterAccess& access, bool inputs, std::uint8_t unit, std::uint16_t address,
               std::uint16_t count, Bytes& answer) {
  if (count < 1 || count > kMaxReadRegisters) return kIllegalValue;
  std::vector<std::uint16_t> words(count);
  const auto& read = inputs && access.read_inputs ? access.read_inputs : access.read;
  if (const int code = read(unit, address, words); code != 0) return code;
  answer.push_back(static_cast<std::uint8_t>(2 * count));
  for (const std::uint16_t value : words) put_word(answer, value);
  return 0;
}

// `data` starts at the count: count, byte count, words.
int write_words(const RegisterAccess& access, std::uint8_t unit, std::uint16_t address,
                std::span<const std::uint8_t> data, int most) {
  if (data.size() < 3) return kIllegalValue;
  const std::uint16_t count = word(data, 0);
  if (count < 1 || count > most || data[2] != 2 * count || data.size() != 3u + 2u * count)
    return kIllegalValue;
  std::vector<std::uint16_t> words;
  for (std::size_t i = 0; i < count; ++i) words.push_back(word(data, 3 + 2 * i));
  return access.write(unit, address, words);
}

// The length of an RTU request from its first bytes; 0: not yet known, -1: no function we know.
int rtu_length(const Bytes& bytes) {
  if (bytes.size() < 2) return 0;
  switch (bytes[1]) {
    case 3:
    case 4:
    case 6:
      return 8;
    case 16:
      return bytes.size() < 7 ? 0 : 9 + bytes[6];
    case 23:
      return bytes.size() < 11 ? 0 : 13 + bytes[10];
    default:
      return -1;
  }
}

}  // namespace

Bytes answer_request(const RegisterAccess& access, std::uint8_t unit, std::span<const std::uint8_t> request) {
  if (request.empty()) return exception(0, kIllegalFunction);
  const std::uint8_t function = request[0];
  const std::span<const std::uint8_t> data = request.subspan(1);
  Bytes answer = {function};
  int code = kIllegalValue;
  switch (function) {
    case 3:
    case 4:
      if (data.size() == 4)
        code = read_words(access, function == kReadInputs, unit, word(data, 0), word(data, 2), answer);
      break;
    case 6:
      if (data.size() == 4) {
        const std::array<std::uint16_t, 1> value = {word(data, 2)};
        code = access.write(unit, word(data, 0), value);
        answer.insert(answer.end(), data.begin(), data.end());
      }
      break;
    case 16:
      if (data.size() >= 4) {
        code = write_words(access, unit, word(data, 0), data.subspan(2), kMaxWriteRegisters);
        answer.insert(answer.end(), data.begin(), data.begin() + 4);
      }
      break;
    case 23:
      if (data.size() >= 8) {
        code = write_words(access, unit, word(data, 4), data.subspan(6), kMaxExchangeRegisters);
        if (code == 0) code = read_words(access, false, unit, word(data, 0), word(data, 2), answer);
      }
      break;
    default:
      code = kIllegalFunction;
  }
  return code == 0 ? answer : exception(function, code);
}

Cut cut_tcp(Bytes& received, ModbusRequest& request) {
  if (received.size() < 7) return Cut::incomplete;
  const std::size_t length = word(received, 4);  // of unit and body
  if (word(received, 2) != 0 || length < 2 || length > kLongestBody + 1) return Cut::broken;
  if (received.size() < 6 + length) return Cut::incomplete;
  request.transaction = word(received, 0);
  request.unit = received[6];
  const auto end = received.begin() + static_cast<std::ptrdiff_t>(6 + length);
  request.body.assign(received.begin() + 7, end);
  received.erase(received.begin(), end);
  return Cut::request;
}

Cut cut_rtu(Bytes& received, ModbusRequest& request) {
  while (!received.empty()) {
    const int length = rtu_length(received);
    if (length == 0) return Cut::incomplete;
    if (length > 0 && length <= 256) {
      const auto size = static_cast<std::size_t>(length);
      if (received.size() < size) return Cut::incomplete;
      const std::span<const std::uint8_t> frame(received.data(), size - 2);
      const std::uint16_t crc = modbus_crc(frame);
      if (received[size - 2] == (crc & 0xFF) && received[size - 1] == crc >> 8) {
        request.unit = frame[0];
        request.body.assign(frame.begin() + 1, frame.end());
        received.erase(received.begin(), received.begin() + length);
        return Cut::request;
      }
    }
    received.erase(received.begin());
  }
  return Cut::incomplete;
}

Bytes frame_tcp(const ModbusRequest& request, const Bytes& answer) {
  Bytes frame;
  put_word(frame, request.transaction);
  put_word(frame, 0);
  put_word(frame, static_cast<std::uint16_t>(answer.size() + 1));
  frame.push_back(request.unit);
  frame.insert(frame.end(), answer.begin(), answer.end());
  return frame;
}

Bytes frame_rtu(const ModbusRequest& request, const Bytes& answer) {
  Bytes frame;
  frame.reserve(answer.size() + 3);  // the address before, the checksum behind
  frame.push_back(request.unit);
  frame.insert(frame.end(), answer.begin(), answer.end());
  put_checksum(frame);
  return frame;
}

void frame_question(const ModbusQuestion& question, const std::uint16_t* words, Bytes& frame) {
  frame.clear();
  const bool reads = question.function != kWriteRegisters, writes = question.write_count > 0;
  if (!question.serial) {
    const int body = 1 + (reads ? 4 : 0) + (writes ? 5 + 2 * question.write_count : 0);
    put_word(frame, question.transaction);
    put_word(frame, 0);
    put_word(frame, static_cast<std::uint16_t>(body + 1));
  }
  frame.push_back(question.unit);
  frame.push_back(question.function);
  if (reads) {
    put_word(frame, question.read_address);
    put_word(frame, question.read_count);
  }
  if (writes) {
    put_word(frame, question.write_address);
    put_word(frame, question.write_count);
    frame.push_back(static_cast<std::uint8_t>(2 * question.write_count));
    for (int i = 0; i < question.write_count; ++i) put_word(frame, words[i]);
  }
  if (question.serial) put_checksum(frame);
}

ReplyCheck check_reply(const ModbusQuestion& question, std::span<const std::uint8_t> received) {
  const auto wrong = [](const char* why) { return ReplyCheck{ReplyKind::wrong, why}; };
  const std::size_t size = received.size();
  const std::size_t unit_at = question.serial ? 0 : 6, body = unit_at + 1, checksum = question.serial ? 2 : 0;
  const bool reads = question.function != kWriteRegisters;
  const std::size_t right = reads ? 2u + 2u * question.read_count : 5u;  // function code and data
  if (!question.serial) {
    if (size >= 2 && word(received, 0) != question.transaction) return wrong("a reply to another request");
    if (size >= 4 && word(received, 2) != 0) return wrong("a reply of another protocol");
    if (size >= 6 && word(received, 4) != right + 1 && word(received, 4) != 3)
      return wrong("a reply of the wrong length");
  }
  if (size > unit_at && received[unit_at] != question.unit) return wrong("a reply of another unit");
  if (size <= body) return {};
  const bool exception = received[body] == (question.function | 0x80);
  if (!exception && received[body] != question.function) return wrong("a reply to another function");
  const std::size_t length = exception ? 2 : right;
  if (!question.serial && word(received, 4) != length + 1) return wrong("a reply of the wrong length");
  if (!exception && reads && size > body + 1 && received[body + 1] != 2 * question.read_count)
    return wrong("a reply of the wrong length");
  const std::size_t end = body + length + checksum;
  if (size < end) return {};
  if (size > end) return wrong("bytes behind the reply");
  if (question.serial) {
    const std::uint16_t crc = modbus_crc(received.first(end - 2));
    if (received[end - 2] != (crc & 0xFF) || received[end - 1] != crc >> 8)
      return wrong("a reply with a wrong checksum");
  }
  if (exception) return {ReplyKind::exception, "", received[body + 1]};
  if (!reads && (word(received, body + 1) != question.write_address ||
                 word(received, body + 3) != question.write_count)) {
    return wrong("a reply about other registers");
  }
  return {ReplyKind::right, "", 0, body + 2};
}

}  // namespace lumbrical
