// The link under which a simulated device's terminal is found: nothing that is there is taken away for it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "files.h"
#include "lumbrical/modbus_server.h"
#include "terminals.h"

namespace lumbrical {
namespace {

namespace fs = std::filesystem;

class TerminalLink : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::have_terminals()) GTEST_SKIP() << test::kNoTerminals;
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_ = fs::path(::testing::TempDir()) / ("lumbrical_link_" + std::to_string(::getpid()));
  std::string link_ = (folder_ / "line").string();
  ModbusServer server_;
};

TEST_F(TerminalLink, IsTakenAwayAgainAtTheEnd) {
  ASSERT_TRUE(server_.open_terminal(link_).ok());
  EXPECT_EQ(fs::read_symlink(link_), server_.name());
  server_.close();
  EXPECT_FALSE(fs::is_symlink(link_));
}

TEST_F(TerminalLink, RefusesTheNameOfAFileAndOfALinkToOne) {
  std::ofstream(folder_ / "mine") << "text";
  std::ofstream(link_) << "text";
  for (int round = 0; round < 2; ++round) {
    EXPECT_EQ(server_.open_terminal(link_).message(),
              link_ + ": is there already, and nothing is taken away; name another link");
    EXPECT_EQ(test::read_file(link_), "text");
    fs::remove(link_);
    fs::create_symlink(folder_ / "mine", link_);
  }
}

TEST_F(TerminalLink, TakesThePlaceOfOneThatAKilledSimulatorLeft) {
  fs::create_symlink("/dev/pts/987654", link_);
  ASSERT_TRUE(server_.open_terminal(link_).ok());
  EXPECT_EQ(fs::read_symlink(link_), server_.name());
}

TEST_F(TerminalLink, OfAnotherIsLeftWhereItIs) {
  ASSERT_TRUE(server_.open_terminal(link_).ok());
  fs::remove(link_);
  std::ofstream(link_) << "text";
  server_.close();
  EXPECT_EQ(test::read_file(link_), "text");
}

std::ptrdiff_t open_files() { return std::distance(fs::directory_iterator("/proc/self/fd"), {}); }

TEST(ModbusServer, HasOnePlaceAtATimeAndNoneWhereItCannotBeOpened) {
  const std::ptrdiff_t before = open_files();
  ModbusServer server;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(server.listen("127.0.0.1", 0).ok());
    EXPECT_EQ(open_files(), before + 1);
  }
  EXPECT_FALSE(server.open_line("/dev/null", 115200).ok());
  EXPECT_EQ(open_files(), before);
}

}  // namespace
}  // namespace lumbrical
