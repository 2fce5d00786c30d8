// Modbus frames: those printed in the makers' and the protocol's documents, and streams in any pieces, with
// garbage between.
#include "modbus/modbus_frame.h"

#include <gtest/gtest.h>

#include <map>

#include "random.h"

namespace lumbrical {
namespace {

struct Registers {
  std::map<std::uint16_t, std::uint16_t> words;
  RegisterAccess access{[](std::uint8_t) { return true; },
                        [this](std::uint8_t, std::uint16_t address, std::span<std::uint16_t> values) {
                          for (std::size_t i = 0; i < values.size(); ++i) {
                            const auto found = words.find(static_cast<std::uint16_t>(address + i));
                            if (found == words.end()) return 2;
                            values[i] = found->second;
                          }
                          return 0;
                        },
                        [this](std::uint8_t, std::uint16_t address, std::span<const std::uint16_t> values) {
                          for (std::size_t i = 0; i < values.size(); ++i) {
                            words[static_cast<std::uint16_t>(address + i)] = values[i];
                          }
                          return 0;
                        }};
};

TEST(ModbusFrame, ReadsInputRegistersWhereThereAreAny) {
  Registers registers;
  registers.words[5] = 7;
  const Bytes holding = {3, 0, 5, 0, 1}, inputs = {4, 0, 5, 0, 1};
  EXPECT_EQ(answer_request(registers.access, 1, inputs), (Bytes{4, 2, 0, 7})) << "the same, if not";
  registers.access.read_inputs = [](std::uint8_t, std::uint16_t, std::span<std::uint16_t> values) {
    values[0] = 9;
    return 0;
  };
  EXPECT_EQ(answer_request(registers.access, 1, inputs), (Bytes{4, 2, 0, 9}));
  EXPECT_EQ(answer_request(registers.access, 1, holding), (Bytes{3, 2, 0, 7}));
}

TEST(ModbusFrame, AnswersTheFramePrintedInRobotiqsManual) {
  Bytes received = {0x09, 0x10, 0x03, 0xE8, 0x00, 0x03, 0x06, 0x09, 0x00, 0x00, 0x00, 0xFF, 0xFF, 0x72, 0x19};
  ModbusRequest request;
  ASSERT_EQ(cut_rtu(received, request), Cut::request);
  EXPECT_EQ(request.unit, 9);
  EXPECT_TRUE(received.empty());
  Registers registers;
  const Bytes answer = frame_rtu(request, answer_request(registers.access, 9, request.body));
  EXPECT_EQ(answer, (Bytes{0x09, 0x10, 0x03, 0xE8, 0x00, 0x03, 0x01, 0x30}));
  EXPECT_EQ(registers.words.at(0x3E8), 0x0900);
  EXPECT_EQ(registers.words.at(0x3EA), 0xFFFF);
}

TEST(ModbusFrame, AnswersTheExamplesOfTheProtocol) {
  Registers registers;
  registers.words = {{0x6B, 0x022B}, {0x6C, 0}, {0x6D, 0x64}};
  EXPECT_EQ(answer_request(registers.access, 1, Bytes{3, 0, 0x6B, 0, 3}),
            (Bytes{3, 6, 2, 0x2B, 0, 0, 0, 0x64}));
  EXPECT_EQ(answer_request(registers.access, 1, Bytes{6, 0, 1, 0, 3}), (Bytes{6, 0, 1, 0, 3}));
  registers.words = {{3, 0xFE}, {4, 0x0ACD}, {5, 1}, {6, 3}, {7, 0x0D}, {8, 0xFF}};
  const Bytes both = {0x17, 0, 3, 0, 6, 0, 0x0E, 0, 3, 6, 0, 0xFF, 0, 0xFF, 0, 0xFF};
  EXPECT_EQ(answer_request(registers.access, 1, both),
            (Bytes{0x17, 0x0C, 0, 0xFE, 0x0A, 0xCD, 0, 1, 0, 3, 0, 0x0D, 0, 0xFF}));
  EXPECT_EQ(registers.words.at(0x10), 0xFF);
}

TEST(ModbusFrame, RefusesWhatItCannotDo) {
  Registers registers;
  EXPECT_EQ(answer_request(registers.access, 1, Bytes{1, 0, 0, 0, 1}), (Bytes{0x81, 1}));
  EXPECT_EQ(answer_request(registers.access, 1, Bytes{3, 0, 0, 0, 1}), (Bytes{0x83, 2}));
  EXPECT_EQ(answer_request(registers.access, 1, Bytes{3, 0, 0, 0, 126}), (Bytes{0x83, 3}));
  EXPECT_EQ(answer_request(registers.access, 1, Bytes{3, 0, 0, 0, 0}), (Bytes{0x83, 3}));
  EXPECT_EQ(answer_request(registers.access, 1, Bytes{16, 0, 0, 0, 1, 4, 0, 0}), (Bytes{0x90, 3}));
  EXPECT_TRUE(registers.words.empty());
}

// A question and the bytes of the right reply, both as they are on the wire.
struct Exchange {
  ModbusQuestion question;
  Bytes reply;
};

Exchange make_exchange(bool serial, int function) {
  ModbusQuestion question{serial, 77, 9, static_cast<std::uint8_t>(function)};
  if (function != 16) question.read_address = 100, question.read_count = 3;
  if (function == 16 || function == 23) question.write_address = 4, question.write_count = 2;
  const std::uint16_t words[] = {500, 65535};
  Bytes frame;
  frame_question(question, words, frame);
  ModbusRequest request;
  EXPECT_EQ(serial ? cut_rtu(frame, request) : cut_tcp(frame, request), Cut::request);
  EXPECT_TRUE(frame.empty());
  Registers registers;
  registers.words = {{100, 1}, {101, 2}, {102, 3}};
  const Bytes answer = answer_request(registers.access, request.unit, request.body);
  if (function == 16 || function == 23) {
    EXPECT_EQ(registers.words.at(4), 500);
    EXPECT_EQ(registers.words.at(5), 65535);
  }
  return {question, serial ? frame_rtu(request, answer) : frame_tcp(request, answer)};
}

TEST(ModbusFrame, OurOwnServersReplyIsRightAndEveryBeginningOfItIncomplete) {
  for (const bool serial : {false, true}) {
    for (const int function : {3, 4, 16, 23}) {
      const auto [question, reply] = make_exchange(serial, function);
      for (std::size_t size = 0; size < reply.size(); ++size) {
        EXPECT_EQ(check_reply(question, std::span(reply).first(size)).kind, ReplyKind::incomplete);
      }
      const ReplyCheck check = check_reply(question, reply);
      ASSERT_EQ(check.kind, ReplyKind::right) << check.why;
      if (function != 16) {
        EXPECT_EQ(reply[check.words + 3], 2) << "the second register";
      }
    }
  }
}

TEST(ModbusFrame, NoReplyWithOneBitChangedIsBelievedUnlessItIsInTheData) {
  for (const bool serial : {false, true}) {
    for (const int function : {3, 4, 16, 23}) {
      const auto [question, reply] = make_exchange(serial, function);
      const std::size_t data = check_reply(question, reply).words;
      for (std::size_t bit = 0; bit < 8 * reply.size(); ++bit) {
        if (!serial && function != 16 && bit / 8 >= data) continue;  // TCP has its own checksum
        Bytes changed = reply;
        changed[bit / 8] = static_cast<std::uint8_t>(changed[bit / 8] ^ 1u << bit % 8);
        EXPECT_NE(check_reply(question, changed).kind, ReplyKind::right)
            << serial << function << " bit " << bit;
      }
      Bytes longer = reply;
      longer.push_back(0);
      EXPECT_EQ(check_reply(question, longer).kind, ReplyKind::wrong);
    }
  }
}

TEST(ModbusFrame, AnExceptionIsAnAnswerOnlyToWhatWasAsked) {
  const auto [question, reply] = make_exchange(false, 16);
  const Bytes refusal = {0, 77, 0, 0, 0, 3, 9, 0x90, 2};
  EXPECT_EQ(check_reply(question, refusal).kind, ReplyKind::exception);
  EXPECT_EQ(check_reply(question, refusal).exception, 2);
  EXPECT_EQ(check_reply(question, Bytes{0, 77, 0, 0, 0, 3, 9, 0x83, 2}).kind, ReplyKind::wrong);
  EXPECT_EQ(check_reply(question, Bytes{0, 77, 0, 0, 0, 3, 9, 0x10, 2}).kind, ReplyKind::wrong);
}

TEST(ModbusFrame, EveryBodyOfRandomBytesIsAnsweredWithoutHarm) {
  test::Random random(21);
  Registers registers;
  for (int i = 0; i < 20000; ++i) {
    Bytes body(random.bits() % 24);
    for (std::uint8_t& byte : body) byte = static_cast<std::uint8_t>(random.bits());
    if (!body.empty()) body[0] = static_cast<std::uint8_t>(random.bits() % 24);
    const Bytes answer = answer_request(registers.access, 1, body);
    ASSERT_GE(answer.size(), 2u);
    ASSERT_LE(answer.size(), 253u);
  }
}

TEST(ModbusFrame, FindsEveryRtuFrameBetweenGarbageInAnyPieces) {
  test::Random random(22);
  const Bytes frame = {0x09, 0x10, 0x03, 0xE8, 0x00, 0x03, 0x06, 0x09,
                       0x00, 0x00, 0x00, 0xFF, 0xFF, 0x72, 0x19};
  int found = 0, sent = 0;
  Bytes received;
  for (int i = 0; i < 2000; ++i) {
    const std::uint64_t noise = random.bits() % 4 == 0 ? random.bits() % 7 : 0;
    for (std::uint64_t k = 0; k < noise; ++k)
      received.push_back(static_cast<std::uint8_t>(0x80 | random.bits()));
    ++sent;
    for (const std::uint8_t byte : frame) {
      received.push_back(byte);
      ModbusRequest request;
      if (cut_rtu(received, request) == Cut::request) {
        ++found;
        EXPECT_EQ(request.body.size(), frame.size() - 3);
      }
    }
  }
  EXPECT_EQ(found, sent);
}

TEST(ModbusFrame, TcpFramesComeInAnyPiecesAndAWrongHeaderEndsIt) {
  Bytes received;
  ModbusRequest request;
  const Bytes frame = {0, 7, 0, 0, 0, 6, 1, 3, 0, 0x6B, 0, 3};
  for (std::size_t i = 0; i < frame.size(); ++i) {
    EXPECT_EQ(cut_tcp(received, request), Cut::incomplete);
    received.push_back(frame[i]);
  }
  ASSERT_EQ(cut_tcp(received, request), Cut::request);
  EXPECT_EQ(request.transaction, 7);
  EXPECT_EQ(request.body, (Bytes{3, 0, 0x6B, 0, 3}));
  EXPECT_EQ(frame_tcp(request, {3, 2, 0, 5}), (Bytes{0, 7, 0, 0, 0, 5, 1, 3, 2, 0, 5}));
  received = {0, 7, 0, 1, 0, 6, 1};
  EXPECT_EQ(cut_tcp(received, request), Cut::broken);
  received = {0, 7, 0, 0, 0xFF, 6, 1};
  EXPECT_EQ(cut_tcp(received, request), Cut::broken);
}

}  // namespace
}  // namespace lumbrical
