// Which hosts a sink talks to, and on which a simulated device listens.
#include "loop/private_network.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>

#include <string>
#include <vector>

#include "modbus/simulated_wire.h"

namespace lumbrical {
namespace {

sockaddr_storage address_of(const std::string& text) {
  sockaddr_storage address{};
  auto& v4 = reinterpret_cast<sockaddr_in&>(address);
  auto& v6 = reinterpret_cast<sockaddr_in6&>(address);
  if (inet_pton(AF_INET, text.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
  } else {
    EXPECT_EQ(inet_pton(AF_INET6, text.c_str(), &v6.sin6_addr), 1) << text;
    v6.sin6_family = AF_INET6;
  }
  return address;
}

bool is_private(const std::string& text) {
  const sockaddr_storage address = address_of(text);
  return lumbrical::is_private(reinterpret_cast<const sockaddr&>(address));
}

TEST(ModbusNetwork, KnowsPrivateRangesOfBothKindsFromTheirFirstToTheirLastAddress) {
  for (const char* const text :
       {"127.0.0.1", "127.255.255.255", "10.0.0.0", "10.255.255.255", "172.16.0.0", "172.31.255.255",
        "192.168.0.0", "192.168.255.255", "169.254.1.1", "0.0.0.0", "::1", "::", "fc00::", "fdff:ffff::1",
        "fe80::1", "febf::1", "::ffff:192.168.1.1"}) {
    EXPECT_TRUE(is_private(text)) << text;
  }
  for (const char* const text :
       {"126.255.255.255", "128.0.0.0",       "9.255.255.255", "11.0.0.0",        "172.15.255.255",
        "172.32.0.0",      "192.167.255.255", "192.169.0.0",   "169.253.255.255", "169.255.0.0",
        "8.8.8.8",         "100.64.0.1",      "224.0.0.1",     "255.255.255.255", "::2",
        "fbff::1",         "fe00::1",         "fec0::1",       "2001:db8::1",     "::ffff:8.8.8.8",
        "64:ff9b::a00:1",  "ff02::1"}) {
    EXPECT_FALSE(is_private(text)) << text;
  }
}

TEST(ModbusNetwork, ASinkDoesNotEvenBeginToTalkToAPublicAddressUnlessTold) {
  DeviceProfile profile = test::patient_profile();
  for (const char* const host : {"203.0.113.7", "2001:db8::7"}) {
    profile.transport.host = host;
    DeviceSink sink;
    const Status status = test::open_modbus(profile, {}, sink);
    EXPECT_NE(status.message().find("lies outside loopback and private networks"), std::string::npos)
        << status.message();
    EXPECT_TRUE(check_host(host, true).ok());
    std::vector<std::string> addresses;
    EXPECT_FALSE(find_host(host, false, addresses).ok()) << "nor where a name stands for it";
    EXPECT_TRUE(find_host(host, true, addresses).ok());
  }
}

TEST(ModbusNetwork, ANameThatNoOneKnowsIsToldInWords) {
  DeviceProfile profile = test::patient_profile();
  profile.transport.host = "no such host";
  test::TickingSink sink;
  sink.open(profile);
  EXPECT_TRUE(sink.told("not connected: no such host: host not found")) << sink.log();
  EXPECT_NE(sink.sink.report().trouble.find("host not found"), std::string::npos);
}

TEST(ModbusNetwork, ADeviceListensOnLoopbackOfEitherKindAndSaysWhereItIsOpenToOthers) {
  ModbusServer server;
  ASSERT_TRUE(server.listen("127.0.0.1", 0).ok());
  EXPECT_FALSE(server.is_open_to_others());
  server.close();
  ASSERT_TRUE(server.listen("0.0.0.0", 0).ok());
  EXPECT_TRUE(server.is_open_to_others());
  server.close();
  EXPECT_FALSE(server.listen("localhost", 0).ok()) << "a name may mean anything";
}

TEST(ModbusNetwork, TheLoopRunsOverIpVersionSix) {
  ModbusServer probe;
  if (!probe.listen("::1", 0).ok()) GTEST_SKIP() << "this machine has no IPv6";
  probe.close();
  DeviceProfile profile = test::patient_profile();
  test::ServedDevice device(profile);
  device.listen(0, "::1");
  EXPECT_EQ(device.name().substr(0, 6), "[::1]:");
  profile.transport.host = "::1";
  profile.transport.port = device.port();
  test::TickingSink sink;
  sink.open(profile);
  EXPECT_TRUE(test::eventually([&] { return device.torque() > 0.099; })) << sink.log();
}

}  // namespace
}  // namespace lumbrical
