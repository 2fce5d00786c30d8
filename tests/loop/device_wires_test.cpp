// Datagrams and shared memory: a device at the other end of each, and what must not be taken for one.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "device_fixture.h"
#include "eventually.h"
#include "loop/datagram_message.h"
#include "lumbrical/datagram_wire.h"
#include "lumbrical/device_sink.h"
#include "lumbrical/shared_memory_wire.h"
#include "random.h"
#include "shared_memory_device.h"

namespace lumbrical {
namespace {

using test::SharedDevice;

constexpr std::size_t kIndex = SharedDevice::kIndex;  // the actuator that is looked at

DeviceProfile device_of(TransportKind kind) {
  DeviceProfile profile = test::shipped_profile("exoskeleton");
  profile.transport.kind = kind;
  profile.rate = 500;
  profile.response_timeout = 0.4;
  profile.first_retry = 0.02;
  profile.last_retry = 0.1;
  profile.safety.soft_start = 0.02;
  profile.safety.tick_hold = 0.5;
  profile.safety.tick_timeout = 2;
  profile.safety.answer_timeout = 1;
  return profile;
}

// A loopback socket; its port.
int bound_socket(std::uint16_t& port) {
  const int file = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(bind(file, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  socklen_t size = sizeof address;
  getsockname(file, reinterpret_cast<sockaddr*>(&address), &size);
  port = ntohs(address.sin_port);
  const timeval patience{0, 20000};
  setsockopt(file, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  return file;
}

// Answers each command; before it sends `noise`.
class DatagramDevice {
 public:
  using Datagrams = std::vector<std::vector<std::byte>>;
  explicit DatagramDevice(const DeviceProfile& profile, Datagrams noise = {})
      : noise_(std::move(noise)), count_(profile.actuators.size()) {
    file_ = bound_socket(port_);
    thread_ = std::thread([this] { serve(); });
  }
  ~DatagramDevice() {
    ending_ = true;
    thread_.join();
    close(file_);
  }
  std::uint16_t port_ = 0;
  std::atomic<double> value{0};
  std::atomic<bool> active{false}, silent{false};
  std::atomic<int> commands{0};
  std::atomic<std::uint64_t> boot{0};
  std::atomic<int> switched_off{0};  // commands that were not active

 private:
  void serve() {
    std::array<std::byte, 4096> received;
    std::array<float, kAngleCount> angle{};
    std::vector<std::byte> reply;
    while (!ending_) {
      sockaddr_in from{};
      socklen_t size = sizeof from;
      const auto to = reinterpret_cast<sockaddr*>(&from);
      const ssize_t bytes = recvfrom(file_, received.data(), received.size(), 0, to, &size);
      CommandDatagram command;
      if (bytes <= 0 ||
          !read_command(std::span(received.data(), static_cast<std::size_t>(bytes)), count_, command))
        continue;
      ++commands;
      value = command.value[kIndex];
      active = command.active;
      if (!active) ++switched_off;
      for (const std::vector<std::byte>& one : noise_) sendto(file_, one.data(), one.size(), 0, to, size);
      CommandDatagram another = command;
      another.session ^= 1;
      DeviceStatus stopped;
      stopped.stop = true;
      write_feedback(another, stopped, angle, 0, reply);
      sendto(file_, reply.data(), reply.size(), 0, to, size);
      if (silent) continue;
      angle[5] = 0.3f;
      DeviceStatus status;
      status.boot = boot;
      write_feedback(command, status, angle, 1u << 5, reply);
      sendto(file_, reply.data(), reply.size(), 0, to, size);
    }
  }
  const Datagrams noise_;
  std::size_t count_;
  int file_ = -1;
  std::thread thread_;
  std::atomic<bool> ending_{false};
};

// Publishes until it holds.
bool acts(DeviceSink& sink, const std::function<bool()>& holds, DeviceFeedback* heard = nullptr) {
  DeviceCommand command;
  command.wanted.fill(0.1);
  return test::eventually([&] {
    ++command.tick;
    DeviceFeedback feedback;
    while (sink.feedback(feedback))
      if (heard != nullptr) *heard = feedback;
    sink.publish(command);
    return holds();
  });
}

// With a thread of its own.
Status open_sink(const DeviceProfile& profile, std::unique_ptr<DeviceWire> wire, DeviceSink& sink) {
  SinkOptions options;
  options.thread = true;
  return sink.open(profile, std::move(wire), options);
}

Status open_sink(DeviceProfile& profile, const DatagramDevice& device, DeviceSink& sink) {
  profile.transport.port = device.port_;
  std::unique_ptr<DeviceWire> wire;
  if (Status status = make_datagram_wire(profile, wire); !status.ok()) return status;
  return open_sink(profile, std::move(wire), sink);
}

// On the region of shared memory.
Status open_sink(const DeviceProfile& profile, DeviceSink& sink) {
  std::unique_ptr<DeviceWire> wire;
  if (Status status = make_shared_memory_wire(profile, wire); !status.ok()) return status;
  return open_sink(profile, std::move(wire), sink);
}

TEST(DatagramWire, CarriesCommandsThereAndAnglesBackAndOnlyTheSessionsOwn) {
  DeviceProfile profile = device_of(TransportKind::udp);
  DatagramDevice::Datagrams noise;
  test::Random random(7);
  for (int i = 0; i < 20; ++i) {
    std::vector<std::byte>& bytes = noise.emplace_back(random.below(3000));
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.bits());
  }
  DatagramDevice device(profile, std::move(noise));
  DeviceSink sink;
  ASSERT_TRUE(open_sink(profile, device, sink).ok());
  DeviceFeedback heard;
  ASSERT_TRUE(acts(
      sink, [&] { return std::fabs(device.value - 0.1) < 1e-9; }, &heard))
      << sink.report().trouble;
  EXPECT_TRUE(acts(
      sink, [&] { return heard.valid == 1u << 5; }, &heard));
  EXPECT_EQ(heard.angle[5], 0.3f);
  EXPECT_EQ(sink.report().faults, 0u) << "an emergency stop of another session is none";
  EXPECT_TRUE(sink.close());
  EXPECT_EQ(device.value, 0);
  EXPECT_FALSE(device.active);
}

// Under force, and comes back: from nothing, or there would be a kick.
template <class Device>
void expect_silence_noticed(Device& device, DeviceSink& sink) {
  ASSERT_TRUE(acts(sink, [&] { return std::fabs(device.value - 0.1) < 1e-9; })) << sink.report().trouble;
  device.silent = true;
  EXPECT_TRUE(acts(sink, [&] { return sink.state() == SafetyState::disconnected; }));
  EXPECT_EQ(sink.report().losses, 1u);
  device.value = 0;
  device.silent = false;
  EXPECT_TRUE(acts(sink, [&] { return sink.state() != SafetyState::disconnected; }));
  EXPECT_LT(device.value, 0.05);
}

TEST(DatagramWire, ADeviceThatFallsSilentUnderForceIsDisconnected) {
  DeviceProfile profile = device_of(TransportKind::udp);
  profile.response_timeout = 0.01;
  profile.safety.answer_timeout = 0.1;
  DatagramDevice device(profile);
  DeviceSink sink;
  ASSERT_TRUE(open_sink(profile, device, sink).ok());
  expect_silence_noticed(device, sink);
}

// However soon it answers again: what it held it has let go of.
TEST(DatagramWire, ADeviceThatHasBegunAnewIsArmedAgainSoftly) {
  DeviceProfile profile = device_of(TransportKind::udp);
  profile.safety.soft_start = 5;
  DatagramDevice device(profile);
  device.boot = 7;
  DeviceSink sink;
  ASSERT_TRUE(open_sink(profile, device, sink).ok());
  ASSERT_TRUE(acts(sink, [&] { return device.value > 0.001; }));
  const int before = device.switched_off;
  device.boot = 8;
  EXPECT_TRUE(acts(sink, [&] { return device.switched_off > before; })) << "and told no force";
  EXPECT_TRUE(acts(sink, [&] { return device.value > 0.001; }));
  EXPECT_GE(sink.report().losses, 1u);
  std::string log;
  for (const SinkEvent& event : sink.events()) log += event.text + "\n";
  EXPECT_NE(log.find("has begun anew"), std::string::npos) << log;
}

TEST(DatagramWire, ADeviceThatFloodsDoesNotHoldUpTheSink) {
  DeviceProfile profile = device_of(TransportKind::udp);
  profile.response_timeout = 0.01;
  profile.safety.answer_timeout = 0.1;
  DatagramDevice device(profile, DatagramDevice::Datagrams(500, std::vector<std::byte>(30)));
  DeviceSink sink;
  ASSERT_TRUE(open_sink(profile, device, sink).ok());
  EXPECT_TRUE(acts(sink, [&] { return device.commands > 5; }));
  EXPECT_EQ(device.value, 0) << "never acknowledged, so never armed";
  EXPECT_EQ(sink.state(), SafetyState::disconnected);
  EXPECT_GT(sink.report().broken, 0u);
}

TEST(DatagramWire, TalksToThisMachineOnlyUnlessTold) {
  DeviceProfile profile = device_of(TransportKind::udp);
  std::unique_ptr<DeviceWire> wire;
  for (const char* const host : {"192.168.0.1", "203.0.113.7"}) {
    profile.transport.host = host;
    const Status refused = make_datagram_wire(profile, wire);
    EXPECT_FALSE(refused.ok()) << host;
    EXPECT_NE(refused.message().find("network=any"), std::string::npos) << refused.message();
  }
  profile.transport.host = "127.0.0.1";
  ASSERT_TRUE(make_datagram_wire(profile, wire).ok());
  EXPECT_TRUE(wire->open().ok());
}

TEST(DatagramWire, WhatTheSystemRefusesNeedsNoLeaveOfOurs) {
  DeviceProfile profile = device_of(TransportKind::udp);
  profile.transport.host = "255.255.255.255";
  profile.transport.anywhere = true;
  std::unique_ptr<DeviceWire> wire;
  ASSERT_TRUE(make_datagram_wire(profile, wire).ok());
  const Status refused = wire->open();
  EXPECT_FALSE(refused.ok());
  EXPECT_EQ(refused.message().find("network=any"), std::string::npos) << refused.message();
}

TEST(Datagrams, AreReadAsTheyWereWrittenAndNeverBeyondTheirEnd) {
  SafetyOutput output;
  output.device_on = true;
  output.command.fill(0.25);
  DeviceCommand made_of;
  made_of.wanted = output.command;
  made_of.wanted[1] = 1;  // cut by the envelope
  made_of.stiffness.fill(2);
  std::vector<std::byte> datagram;
  write_command(9, {4, output, made_of}, 3, datagram);
  ASSERT_LE(datagram.size(), kMostDatagram);
  CommandDatagram command;
  ASSERT_TRUE(read_command(datagram, 3, command));
  EXPECT_EQ(command.session, 9u);
  EXPECT_EQ(command.cycle, 4u);
  EXPECT_TRUE(command.active);
  EXPECT_EQ(command.value[2], 0.25);
  EXPECT_EQ(command.local[0].stiffness, 2);
  EXPECT_EQ(command.local[1].stiffness, 0) << "what the envelope cut does not come back through it";
  EXPECT_FALSE(read_command(datagram, 4, command)) << "of another number of actuators";
  std::uint64_t cycle = 0;
  WireAnswer answer;
  EXPECT_FALSE(read_feedback(datagram, 9, cycle, answer)) << "a command is no answer";
  made_of.wanted = output.command;
  output.command[2] = std::nan("");
  write_command(9, {4, output, made_of}, 3, datagram);
  EXPECT_FALSE(read_command(datagram, 3, command)) << "a number that is none";

  std::array<float, kAngleCount> angle{};
  angle[19] = 0.5f;
  DeviceStatus status;
  status.has_dead_man = true;
  status.dead_man = false;
  write_feedback(command, status, angle, 1u << 19, datagram);
  ASSERT_TRUE(read_feedback(datagram, 9, cycle, answer));
  EXPECT_EQ(cycle, 4u);
  EXPECT_EQ(answer.angle[19], 0.5f);
  EXPECT_TRUE(answer.status.has_dead_man && !answer.status.dead_man);
  EXPECT_FALSE(read_feedback({}, 9, cycle, answer)) << "of nothing at all";
  for (std::size_t size = 0; size < datagram.size(); ++size)
    EXPECT_FALSE(read_feedback(std::span(datagram).first(size), 9, cycle, answer)) << size;
  test::Random random(3);
  for (int i = 0; i < 20000; ++i) {
    std::vector<std::byte> damaged = datagram;
    for (int k = 0; k < 3; ++k)
      damaged[random.below(damaged.size())] ^= static_cast<std::byte>(1u << random.below(8));
    static_cast<void>(read_feedback(damaged, 9, cycle, answer));
  }
}

TEST(SharedMemoryWire, CarriesCommandsThereAndAnglesBackAndTakesOverWhatWasLeft) {
  DeviceProfile profile = device_of(TransportKind::memory);
  profile.transport.region = test::own_region("device");
  std::unique_ptr<DeviceWire> wire;
  ASSERT_TRUE(make_shared_memory_wire(profile, wire).ok());
  EXPECT_FALSE(wire->open().ok()) << "there is no region yet";
  SharedDevice device(profile.transport.region);
  auto sink = std::make_unique<DeviceSink>();
  SinkOptions options;
  options.thread = true;
  ASSERT_TRUE(sink->open(profile, std::move(wire), options).ok());
  DeviceFeedback heard;
  ASSERT_TRUE(acts(
      *sink, [&] { return std::fabs(device.value - 0.1) < 1e-9; }, &heard))
      << sink->report().trouble;
  EXPECT_TRUE(acts(
      *sink, [&] { return heard.valid == 1u << 5; }, &heard));
  EXPECT_TRUE(sink->close());
  EXPECT_EQ(device.value, 0);

  // As after a kill: a force stands there, and a guard lets go of it.
  ASSERT_TRUE(make_shared_memory_wire(profile, wire).ok());
  ASSERT_TRUE(wire->open().ok());
  SafetyOutput force;
  force.device_on = true;
  force.command[kIndex] = 0.1;
  WireAnswer answer;
  ASSERT_TRUE(wire->exchange({1, force, {}}, answer).ok());
  EXPECT_EQ(device.value, 0.1);
  wire->close();
  options.arm = false;
  options.take_over = true;
  profile.safety.fade = 0.5;
  profile.actuators[kIndex].slew = 1;
  DeviceSink guard;
  std::unique_ptr<DeviceWire> second;
  ASSERT_TRUE(make_shared_memory_wire(profile, second).ok());
  ASSERT_TRUE(guard.open(profile, std::move(second), options).ok());
  EXPECT_TRUE(test::eventually([&] { return guard.is_safe(); }));
  SentCommand first;
  ASSERT_TRUE(guard.sent(first));
  EXPECT_GT(first.value[kIndex], 0.05) << "it began where the other ended";
  EXPECT_TRUE(guard.close());
  EXPECT_EQ(device.value, 0);
}

TEST(SharedMemoryWire, ADeviceThatFallsSilentUnderForceIsDisconnected) {
  DeviceProfile profile = device_of(TransportKind::memory);
  profile.response_timeout = 0.01;
  profile.safety.answer_timeout = 0.1;
  profile.transport.region = test::own_region("silent");
  SharedDevice device(profile.transport.region);
  DeviceSink sink;
  ASSERT_TRUE(open_sink(profile, sink).ok());
  expect_silence_noticed(device, sink);
}

TEST(SharedMemoryWire, FindsADeviceThatWasStartedAgain) {
  DeviceProfile profile = device_of(TransportKind::memory);
  profile.response_timeout = 0.01;
  profile.transport.region = test::own_region("again");
  auto device = std::make_unique<SharedDevice>(profile.transport.region);
  DeviceSink sink;
  ASSERT_TRUE(open_sink(profile, sink).ok());
  const auto feels = [&] { return std::fabs(device->value - 0.1) < 1e-9; };
  ASSERT_TRUE(acts(sink, feels)) << sink.report().trouble;
  device.reset();
  EXPECT_TRUE(acts(sink, [&] { return sink.state() == SafetyState::disconnected; }));
  device = std::make_unique<SharedDevice>(profile.transport.region);
  EXPECT_TRUE(acts(sink, feels)) << sink.report().trouble;
}

TEST(SharedMemoryWire, TellsARegionThatWasMadeAnewFromADeviceThatIsSilent) {
  DeviceProfile profile = device_of(TransportKind::memory);
  profile.transport.region = test::own_region("anew");
  std::unique_ptr<DeviceWire> wire;
  ASSERT_TRUE(make_shared_memory_wire(profile, wire).ok());
  auto device = std::make_unique<SharedDevice>(profile.transport.region);
  ASSERT_TRUE(wire->open().ok());
  WireAnswer answer;
  ASSERT_TRUE(wire->exchange({1, {}, {}}, answer).ok());
  device->silent = true;
  EXPECT_EQ(wire->exchange({2, {}, {}}, answer).outcome, WireOutcome::missed);
  device.reset();
  EXPECT_EQ(wire->exchange({3, {}, {}}, answer).outcome, WireOutcome::broken) << "removed";
  const SharedDevice anew(profile.transport.region);
  const WireResult result = wire->exchange({4, {}, {}}, answer);
  EXPECT_EQ(result.outcome, WireOutcome::broken);
  EXPECT_NE(result.text.find("was made anew, or removed"), std::string::npos) << result.text;
}

// A device that was started again beside one that lives on: forces would go to the old one.
TEST(SharedMemoryWire, NoticesARegionThatWasMadeAnewThoughTheOldOneIsStillAnswered) {
  DeviceProfile profile = device_of(TransportKind::memory);
  profile.transport.region = test::own_region("beside");
  std::unique_ptr<DeviceWire> wire;
  ASSERT_TRUE(make_shared_memory_wire(profile, wire).ok());
  const SharedDevice old(profile.transport.region);
  ASSERT_TRUE(wire->open().ok());
  WireAnswer answer;
  ASSERT_TRUE(wire->exchange({1, {}, {}}, answer).ok());
  const SharedDevice anew(profile.transport.region);
  SafetyOutput force;
  force.command[kIndex] = 0.1;
  const WireResult result = wire->exchange({2, force, {}}, answer);
  EXPECT_EQ(result.outcome, WireOutcome::broken);
  EXPECT_NE(result.text.find("was made anew, or removed"), std::string::npos) << result.text;
  EXPECT_EQ(old.value, 0);
  ASSERT_TRUE(wire->open().ok());
  EXPECT_TRUE(wire->exchange({3, force, {}}, answer).ok());
  EXPECT_EQ(anew.value, 0.1);
}

TEST(SharedMemoryWire, IsOfOneSessionAtATime) {
  DeviceProfile profile = device_of(TransportKind::memory);
  profile.transport.region = test::own_region("one");
  const SharedDevice device(profile.transport.region);
  std::unique_ptr<DeviceWire> first, second;
  ASSERT_TRUE(make_shared_memory_wire(profile, first).ok());
  ASSERT_TRUE(make_shared_memory_wire(profile, second).ok());
  ASSERT_TRUE(first->open().ok());
  const Status refused = second->open();
  EXPECT_NE(refused.message().find("another session drives it; end that one first"), std::string::npos)
      << refused.message();
  WireAnswer answer;
  EXPECT_TRUE(first->exchange({1, {}, {}}, answer).ok());
  EXPECT_TRUE(first->open().ok()) << "its own lock is not in its way";
  first->close();
  EXPECT_TRUE(second->open().ok());
}

// In doubt a switch is released, and an angle was not measured.
TEST(SharedMemoryWire, ASwitchThatSaysNothingKnownIsReleasedAndAnAngleThatNoFloatCanHoldIsNone) {
  DeviceProfile profile = device_of(TransportKind::memory);
  profile.transport.region = test::own_region("doubt");
  SharedDevice device(profile.transport.region);
  std::unique_ptr<DeviceWire> wire;
  ASSERT_TRUE(make_shared_memory_wire(profile, wire).ok());
  ASSERT_TRUE(wire->open().ok());
  WireCommand command{0, {}, {}};
  WireAnswer answer;
  for (const std::uint64_t word : {0, 1, 2, 3, -1}) {
    device.dead_man = word;
    ++command.cycle;
    ASSERT_TRUE(wire->exchange(command, answer).ok());
    EXPECT_EQ(answer.status.has_dead_man, word != 0);
    EXPECT_EQ(answer.status.dead_man, word == 0 || word == 2) << word;
  }
  for (const double angle : {1e300, -1e300, HUGE_VAL, std::nan("")}) {
    device.angle = angle;
    ++command.cycle;
    ASSERT_TRUE(wire->exchange(command, answer).ok());
    EXPECT_EQ(answer.valid, 0u) << angle;
    EXPECT_EQ(answer.angle[SharedDevice::kAngle], 0) << angle;
  }
  device.angle = 0.3;
  ++command.cycle;
  ASSERT_TRUE(wire->exchange(command, answer).ok());
  EXPECT_EQ(answer.valid, 1u << SharedDevice::kAngle);
  EXPECT_EQ(answer.angle[SharedDevice::kAngle], 0.3f);
}

TEST(SharedMemoryWire, RefusesARegionThatOthersMayWriteToAndOneThatIsTooSmall) {
  DeviceProfile profile = device_of(TransportKind::memory);
  std::unique_ptr<DeviceWire> wire;
  profile.transport.region = test::own_region("open");
  ASSERT_TRUE(make_shared_memory_wire(profile, wire).ok());
  const SharedDevice writable(profile.transport.region, 0666);
  EXPECT_NE(wire->open().message().find("written by others"), std::string::npos);
  profile.transport.region = test::own_region("small");
  ASSERT_TRUE(make_shared_memory_wire(profile, wire).ok());
  const SharedDevice small(profile.transport.region, 0600, 100);
  EXPECT_NE(wire->open().message().find("too small"), std::string::npos);
  for (const char* const name : {"", "/", "name", "/a/b"}) {
    profile.transport.region = name;
    EXPECT_FALSE(make_shared_memory_wire(profile, wire).ok()) << name;
  }
}

}  // namespace
}  // namespace lumbrical
