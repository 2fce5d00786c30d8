// A serial line whose other end is the test's own.
#include "modbus/modbus_link.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>
#include <utility>

#include "base/steady_clock.h"
#include "terminals.h"

namespace lumbrical {
namespace {

class ModbusLinkTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::have_terminals()) GTEST_SKIP() << test::kNoTerminals;
    end_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
    std::array<char, 128> name{};
    ASSERT_TRUE(end_ >= 0 && grantpt(end_) == 0 && unlockpt(end_) == 0 &&
                ptsname_r(end_, name.data(), name.size()) == 0);
    termios settings{};
    ASSERT_EQ(tcgetattr(end_, &settings), 0);
    cfmakeraw(&settings);
    ASSERT_EQ(tcsetattr(end_, TCSANOW, &settings), 0);
    transport.kind = TransportKind::rtu;
    transport.line = name.data();
  }
  ~ModbusLinkTest() override {
    link.close();
    if (end_ >= 0) close(end_);
  }
  bool hears() const {
    std::array<std::uint8_t, 512> bytes{};
    return read(end_, bytes.data(), bytes.size()) > 0;
  }
  // What a register of unit 1 holds.
  void answer(std::uint8_t value) const {
    const Bytes reply = frame_rtu({0, 1, {}}, {3, 2, 0, value});
    EXPECT_EQ(write(end_, reply.data(), reply.size()), static_cast<ssize_t>(reply.size()));
  }
  // From now on bytes are preceded by a 0, and a change of the line's settings is told by a byte.
  void watch_settings() const {
    termios settings{};
    const int on = 1;
    ASSERT_EQ(tcgetattr(end_, &settings), 0);
    settings.c_lflag |= EXTPROC;
    ASSERT_EQ(tcsetattr(end_, TCSANOW, &settings), 0);
    ASSERT_EQ(ioctl(end_, TIOCPKT, &on), 0);
  }
  Transport transport;
  ModbusLink link;
  const RegisterBlock block{1, 100, 1};
  std::uint16_t word = 0;

 private:
  int end_ = -1;
};

// Both are of the same function and length, and nothing else says which request they belong to.
TEST_F(ModbusLinkTest, AReplyThatIsLateOnALineIsNotTakenForOneToTheNextRequest) {
  link.patience.usual = 0.02;
  ASSERT_TRUE(link.open(transport, 0.02).ok());
  EXPECT_EQ(link.read(3, block, &word).outcome, LinkOutcome::broken);
  EXPECT_TRUE(hears());
  bool late = false;
  link.patience.usual = 10;
  link.patience.hurry = [&] {  // asked again and again while something is waited for
    if (!std::exchange(late, true)) {
      answer(1);
    } else if (hears()) {
      answer(2);
    }
    return false;
  };
  ASSERT_TRUE(link.open(transport, 0.3).ok());
  EXPECT_TRUE(link.read(3, block, &word).ok());
  EXPECT_EQ(word, 2);
}

TEST_F(ModbusLinkTest, AnEmergencyStopDoesNotWaitForLateReplies) {
  link.patience.hurried = 0.002;
  link.patience.hurry = [] { return true; };
  const std::int64_t before = steady_ns();
  ASSERT_TRUE(link.open(transport, 60).ok());
  EXPECT_LT(in_seconds(steady_ns() - before), 30);
}

TEST_F(ModbusLinkTest, ASecondSessionOnALineIsRefusedBeforeItSetsTheLine) {
  const int first = open(transport.line.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_EQ(flock(first, LOCK_EX), 0);
  watch_settings();
  EXPECT_NE(link.open(transport, 0.001).message().find("is in use by another session"), std::string::npos);
  EXPECT_FALSE(hears());
  close(first);
  EXPECT_TRUE(link.open(transport, 0.001).ok());
  EXPECT_TRUE(hears()) << "a line that is set says so here";
}

// Linux drops requests to connect to a server whose queue is full.
TEST(ModbusLink, AHostThatDoesNotAnswerIsToldWithWhatToCheck) {
  std::array<int, 4> files{};
  for (int& file : files) file = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  auto* const address = reinterpret_cast<sockaddr*>(&place);
  socklen_t size = sizeof place;
  ASSERT_EQ(bind(files[0], address, size), 0);
  ASSERT_EQ(listen(files[0], 0), 0);
  ASSERT_EQ(getsockname(files[0], address, &size), 0);
  for (std::size_t i = 1; i < files.size(); ++i) connect(files[i], address, size);
  Transport transport;
  transport.host = "127.0.0.1";
  transport.port = ntohs(place.sin_port);
  ModbusLink link;
  const Status status = link.open(transport, 0.05);
  EXPECT_NE(status.message().find("timed out: the host does not answer"), std::string::npos)
      << status.message();
  for (const int file : files) close(file);
}

}  // namespace
}  // namespace lumbrical
