// Independent peers: pymodbus as the device, mbpoll as the master, a socat pair of terminals between. Skipped
// where they are not installed.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "files.h"
#include "simulated_wire.h"
#include "terminals.h"

namespace lumbrical {
namespace {

using test::eventually;

/// A child process that ends with its owner.
class Child {
 public:
  explicit Child(std::vector<std::string> words) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    id_ = fork();
    if (id_ == 0) {
      dup2(open("/dev/null", O_WRONLY), STDERR_FILENO);  // allocates nothing: another thread may be at it
      execvp(arguments[0], arguments.data());
      _exit(127);
    }
  }
  ~Child() {
    kill(id_, SIGTERM);
    waitpid(id_, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

 private:
  pid_t id_ = -1;
};

std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 256> block{};
  while (std::fgets(block.data(), block.size(), pipe) != nullptr) text += block.data();
  pclose(pipe);
  return text;
}

bool have(const std::string& test) { return std::system((test + " >/dev/null 2>&1").c_str()) == 0; }

// A device that knows registers only, written by others: it repeats the heartbeat by being the same register.
const char* const kPymodbusServer = R"(
import socket, sys
from pymodbus.datastore import ModbusSequentialDataBlock, ModbusSlaveContext, ModbusServerContext
from pymodbus.server import StartTcpServer
bind = socket.socket.bind
def bind_to_reserved(self, address):
    self.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    return bind(self, address)
socket.socket.bind = bind_to_reserved
block = ModbusSequentialDataBlock(0, [0] * 200)
context = ModbusServerContext(slaves=ModbusSlaveContext(hr=block, ir=block, zero_mode=True), single=True)
StartTcpServer(context=context, address=("127.0.0.1", int(sys.argv[1])))
)";

TEST(ModbusPeers, PymodbusTakesOurCommands) {
  const std::string python =
      have("/usr/bin/python3 -c 'import pymodbus.server'") ? "/usr/bin/python3" : "python3";
  if (!have(python + " -c 'import pymodbus.server'"))
    GTEST_SKIP() << "pymodbus is missing; install python3-pymodbus";
  const std::string script = test::fresh_folder().string() + "/server.py";
  std::ofstream(script) << kPymodbusServer;
  DeviceProfile profile = test::patient_profile();
  const test::ReservedPort port;
  profile.transport.port = port.number();
  profile.status = {};
  profile.heartbeat.echo_address = profile.heartbeat.address;
  for (const bool combined : {true, false}) {
    profile.read_write = combined;
    const Child server({python, script, std::to_string(profile.transport.port)});
    test::TickingSink sink;
    sink.open(profile);
    EXPECT_TRUE(sink.reaches(SafetyState::active)) << sink.log();
    EXPECT_TRUE(eventually([&] { return sink.acknowledged > 50; })) << sink.log();
    SinkReport report = sink.sink.report();
    EXPECT_EQ(report.refused, 0u) << sink.log();
    EXPECT_TRUE(sink.close()) << sink.log();
  }
}

TEST(ModbusPeers, MbpollReadsAndWritesOurDevice) {
  if (!have("command -v mbpoll")) GTEST_SKIP() << "mbpoll is missing; install mbpoll";
  test::ServedDevice device(test::patient_profile());
  device.listen();
  const std::string poll = "mbpoll -m tcp -p " + std::to_string(device.port()) + " -a 1 -0 -1 -o 5 ";
  const std::string read = output_of(poll + "-t 4 -r 100 -c 22 127.0.0.1");
  EXPECT_NE(read.find("[100]: \t12"), std::string::npos) << read;  // dead-man held, ready
  const std::string written = output_of(poll + "-t 4 -r 0 127.0.0.1 1 7 500 500 500 500");
  EXPECT_NE(written.find("Written 6 references"), std::string::npos) << written;
  EXPECT_TRUE(eventually([&] { return device.largest() > 0.04; })) << "500 counts of 0.1 mN m";
  const std::string outside = output_of(poll + "-t 4 -r 60 -c 2 127.0.0.1");
  EXPECT_NE(outside.find("Illegal data address"), std::string::npos) << outside;
}

TEST(ModbusPeers, AnRtuLoopRunsOverASocatPairOfTerminals) {
  if (!have("command -v socat")) GTEST_SKIP() << "socat is missing; install socat";
  if (!test::have_terminals()) GTEST_SKIP() << test::kNoTerminals;
  const std::string ours = test::fresh_folder().string() + "/ours",
                    theirs = test::fresh_folder().string() + "/theirs";
  std::filesystem::create_directories(std::filesystem::path(ours).parent_path());
  const Child socat({"socat", "pty,raw,echo=0,link=" + ours, "pty,raw,echo=0,link=" + theirs});
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(ours) && std::filesystem::exists(theirs); }));
  DeviceProfile profile = test::patient_profile();
  test::ServedDevice device(profile);
  device.open_line(theirs);
  profile.transport.kind = TransportKind::rtu;
  profile.transport.line = ours;
  test::TickingSink sink;
  sink.open(profile);
  EXPECT_TRUE(eventually([&] { return device.torque() > 0.099; })) << sink.log();
  EXPECT_TRUE(sink.close());
  EXPECT_TRUE(eventually([&] { return device.torque() == 0; }));
}

}  // namespace
}  // namespace lumbrical
