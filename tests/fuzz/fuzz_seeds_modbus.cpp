// Seeds of Modbus: replies with the questions they answer, and streams of requests.
#include "fuzz_seeds.h"
#include "modbus/modbus_frame.h"

namespace {

using namespace lumbrical;

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace

void write_modbus(const std::filesystem::path& folder) {
  constexpr std::uint8_t kUnit = 1;
  RegisterAccess access;
  access.has_unit = [](std::uint8_t) { return true; };
  access.read = [](std::uint8_t, std::uint16_t, std::span<std::uint16_t> words) {
    for (std::uint16_t& word : words) word = 0x1234;
    return 0;
  };
  access.write = [](std::uint8_t, std::uint16_t, std::span<const std::uint16_t>) { return 0; };
  const std::uint16_t written[] = {7, 8, 9};
  for (const bool serial : {false, true}) {
    Bytes stream;
    for (std::uint8_t kind = 0; kind < 4; ++kind) {
      constexpr std::uint8_t kFunctions[] = {3, 4, 16, 23};
      ModbusQuestion question;
      question.serial = serial;
      question.transaction = 0x0102;
      question.unit = kUnit;
      question.function = kFunctions[kind];
      const bool writes = kind >= 2, reads = kind != 2;
      question.write_address = writes ? 2 : 0;
      question.write_count = writes ? 3 : 0;
      question.read_address = reads ? 4 : 0;
      question.read_count = reads ? 2 : 0;
      Bytes frame;
      frame_question(question, written, frame);
      stream = stream + frame;
      ModbusRequest request;
      Bytes received = frame;
      if ((serial ? cut_rtu(received, request) : cut_tcp(received, request)) != Cut::request) continue;
      const Bytes answer = answer_request(access, kUnit, request.body);
      const Bytes head = {0,
                          static_cast<std::uint8_t>(kind << 1 | (serial ? 1 : 0)),
                          kUnit,
                          1,
                          2,
                          0,
                          static_cast<std::uint8_t>(question.write_address),
                          0,
                          static_cast<std::uint8_t>(question.write_count),
                          0,
                          static_cast<std::uint8_t>(question.read_address),
                          0,
                          static_cast<std::uint8_t>(question.read_count)};
      const std::string name = std::string(serial ? "rtu_" : "tcp_") + std::to_string(question.function);
      lumbrical::test::write(folder / ("reply_" + name),
                             head + (serial ? frame_rtu(request, answer) : frame_tcp(request, answer)));
    }
    lumbrical::test::write(folder / (serial ? "stream_rtu" : "stream_tcp"),
                           Bytes{static_cast<std::uint8_t>(serial ? 3 : 2)} + stream);
  }
}
