// What the viewer's server answers: only to this machine's own name, only what was named, and any range of
// it.
#include "page_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <new>
#include <string>
#include <thread>

#include "eventually.h"
#include "files.h"
#include "http_request.h"

namespace lumbrical::tool {
namespace {

constexpr const char* kPage =
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'\"><title>Lumbrical</title>";

bool connect_to(std::uint16_t port, int line) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return connect(line, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
}

/// Sends a request and answers all that comes back until the server closes.
std::string ask(std::uint16_t port, const std::string& request) {
  const int line = socket(AF_INET, SOCK_STREAM, 0);
  std::string answer;
  if (connect_to(port, line)) {
    send(line, request.data(), request.size(), MSG_NOSIGNAL);
    char piece[4096];
    for (ssize_t count = 0; (count = recv(line, piece, sizeof piece, 0)) > 0;)
      answer.append(piece, static_cast<std::size_t>(count));
  }
  close(line);
  return answer;
}

std::string get(std::uint16_t port, const std::string& path, const std::string& fields = "") {
  return ask(port, "GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\n" + fields +
                       "Connection: close\r\n\r\n");
}

std::string status_of(const std::string& answer) { return answer.substr(0, answer.find("\r\n")); }
std::string body_of(const std::string& answer) { return answer.substr(answer.find("\r\n\r\n") + 4); }

class PageServerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path folder = test::fresh_folder();
    const std::string file = folder / "rec.mcap";
    std::ofstream(file, std::ios::binary) << "0123456789";
    std::ofstream(folder / "other.mcap") << "secret";
    ASSERT_TRUE(server_.start({kPage, {{"/a/my rec.mcap", file}}, {}}, 0).ok());
  }
  PageServer server_;
};

TEST_F(PageServerTest, SendsThePageWithItsPolicyAsAHeader) {
  const std::string answer = get(server_.port(), "/?x=1");
  EXPECT_EQ(status_of(answer), "HTTP/1.1 200 OK");
  EXPECT_EQ(body_of(answer), kPage);
  EXPECT_NE(answer.find("Content-Security-Policy: default-src 'none'; frame-ancestors 'none'\r\n"),
            std::string::npos);
}

TEST(PageServer, GoesOnWhenOneConnectionRunsOutOfMemory) {
  const auto no_memory = [](const auto&) { throw std::bad_alloc(); };
  PageServer server;
  ASSERT_TRUE(server.start({kPage, {}, no_memory}, 0).ok());
  for (int i = 0; i < 40; ++i) {  // more than are served at a time: none is counted for ever
    EXPECT_EQ(body_of(get(server.port(), "/live")), "");
    EXPECT_EQ(status_of(get(server.port(), "/")), "HTTP/1.1 200 OK");
  }
}

TEST_F(PageServerTest, ComputesNothingWhileNoDescriptorIsFree) {
  const int line = socket(AF_INET, SOCK_STREAM, 0);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit full{static_cast<rlim_t>(line) + 1, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &full), 0);
  EXPECT_TRUE(connect_to(server_.port(), line));
  const std::clock_t start = std::clock();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_LT(std::clock() - start, CLOCKS_PER_SEC / 10);
  setrlimit(RLIMIT_NOFILE, &before);
  close(line);
  EXPECT_EQ(status_of(get(server_.port(), "/")), "HTTP/1.1 200 OK");
}

TEST_F(PageServerTest, SendsAnyRangeOfAFile) {
  const auto range = [this](const std::string& field) {
    return get(server_.port(), "/a/my%20rec.mcap", "Range: " + field + "\r\n");
  };
  EXPECT_EQ(body_of(get(server_.port(), "/a/my%20rec.mcap")), "0123456789");
  EXPECT_EQ(body_of(range("bytes=2-4")), "234");
  EXPECT_EQ(body_of(range("bytes=7-")), "789");
  EXPECT_EQ(body_of(range("bytes=-2")), "89");
  EXPECT_EQ(body_of(range("bytes=8-100")), "89");
  EXPECT_NE(range("bytes=2-4").find("Content-Range: bytes 2-4/10\r\n"), std::string::npos);
  for (const char* const field :
       {"bytes=10-", "bytes=5-4", "bytes=x-", "bytes=-0", "lines=1-2", "bytes=0-18446744073709551616"})
    EXPECT_EQ(status_of(range(field)), "HTTP/1.1 416 Range Not Satisfiable") << field;
}

TEST_F(PageServerTest, KnowsNothingButWhatWasNamed) {
  for (const char* const path : {"/a/other.mcap", "/a/../other.mcap", "/a/%2e%2e/other.mcap", "/a/",
                                 "/etc/passwd", "//etc/passwd", "/live", "/a/my rec.mcap%00"})
    EXPECT_NE(status_of(get(server_.port(), path)), "HTTP/1.1 200 OK") << path;
}

TEST_F(PageServerTest, RefusesNamesThatOthersGaveThisMachine) {
  const std::string port = std::to_string(server_.port());
  for (const std::string& host :
       {std::string("evil.example"), "evil.example:" + port, std::string("127.0.0.1:1"), std::string()})
    EXPECT_EQ(
        status_of(ask(server_.port(), "GET / HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n")),
        "HTTP/1.1 403 Forbidden")
        << host;
}

TEST(OwnHost, HasNoPortWhereBrowsersLeaveItOut) {
  for (const char* const name : {"127.0.0.1", "localhost"}) {
    EXPECT_TRUE(is_own_host(name, 80));
    EXPECT_TRUE(is_own_host(std::string(name) + ":80", 80));
    EXPECT_FALSE(is_own_host(name, 8080));
    EXPECT_FALSE(is_own_host(std::string(name) + ":8080", 80));
  }
  EXPECT_FALSE(is_own_host("evil.example", 80));
}

TEST_F(PageServerTest, TakesNothingAndAnswersRubbishWithARefusal) {
  const std::string host = "Host: 127.0.0.1:" + std::to_string(server_.port()) + "\r\n";
  EXPECT_EQ(status_of(ask(server_.port(), "POST / HTTP/1.1\r\n" + host + "Connection: close\r\n\r\n")),
            "HTTP/1.1 405 Method Not Allowed");
  EXPECT_EQ(status_of(ask(server_.port(), "PUT / HTTP/1.1\r\n" + host + "Content-Length: 5\r\n\r\nhello")),
            "HTTP/1.1 400 Bad Request");
  EXPECT_EQ(status_of(ask(server_.port(), "rubbish\r\n\r\n")), "HTTP/1.1 400 Bad Request");
  EXPECT_EQ(ask(server_.port(), std::string(100000, 'x')), "");
  EXPECT_EQ(status_of(get(server_.port(), "/")), "HTTP/1.1 200 OK");
}

TEST_F(PageServerTest, RefusesAPortInUseAndAPageWithoutAPolicy) {
  PageServer second;
  EXPECT_FALSE(second.start({kPage, {}, {}}, server_.port()).ok());
  EXPECT_FALSE(second.start({"<title>no policy</title>", {}, {}}, 0).ok());
}

TEST(PageServer, AnswersALiveSessionUntilItEnds) {
  PageServer server;
  const auto live = [](const auto& send) {
    const std::uint8_t bytes[] = {'a', 'b'};
    for (int i = 0; i < 3; ++i) send(bytes);
  };
  ASSERT_TRUE(server.start({kPage, {}, live}, 0).ok());
  EXPECT_EQ(body_of(get(server.port(), "/live")), "2\r\nab\r\n2\r\nab\r\n2\r\nab\r\n0\r\n\r\n");
}

TEST(PageServer, EndsALiveSessionWhereItStops) {
  auto server = std::make_unique<PageServer>();
  std::promise<void> sent;
  const auto live = [&, server = server.get()](const auto& send) {
    const std::uint8_t bytes[] = {'a', 'b'};
    send(bytes);
    sent.set_value();
    while (server->running() && send(bytes)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  ASSERT_TRUE(server->start({kPage, {}, live}, 0).ok());
  auto answer = std::async(std::launch::async, [port = server->port()] { return get(port, "/live"); });
  sent.get_future().wait();
  server.reset();
  const std::string body = body_of(answer.get());
  EXPECT_EQ(body.substr(body.size() - std::min<std::size_t>(body.size(), 12)), "2\r\nab\r\n0\r\n\r\n");
}

// A script that reads the program's output to its end would wait for the browser, and what ends the program
// would end that too.
TEST(Browser, IsOpenedWithNothingOfTheProgramThatOpensIt) {
  const std::filesystem::path folder = test::fresh_folder();
  test::write_file(
      "xdg-open",
      "#!/bin/bash\n"
      "cd \"${0%/*}\" && readlink /proc/$$/fd/{0,1,2} >files && ls /proc/$$/fd >numbers\n"
      "grep -E 'SigBlk' /proc/$$/status >blocked\n"
      "cut -d' ' -f6 /proc/$$/stat >session && echo \"$1\" >address.part && mv address.part address\n");
  std::filesystem::permissions(folder / "xdg-open", std::filesystem::perms::owner_all);
  const std::string path = std::getenv("PATH");
  setenv("PATH", (folder.string() + ":" + path).c_str(), 1);
  setenv("DISPLAY", ":0", 1);
  const int inherited = open("/dev/zero", O_RDONLY);
  sigset_t blocked, before;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &blocked, &before);
  open_browser("http://127.0.0.1/");
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  close(inherited);
  setenv("PATH", path.c_str(), 1);
  ASSERT_TRUE(test::eventually([&] { return std::filesystem::exists(folder / "address"); }));
  EXPECT_EQ(test::read_file(folder / "address"), "http://127.0.0.1/\n");
  EXPECT_EQ(test::read_file(folder / "files"), "/dev/null\n/dev/null\n/dev/null\n");
  EXPECT_EQ(test::read_file(folder / "numbers").find(std::to_string(inherited) + "\n"), std::string::npos);
  const std::uint64_t still_blocked = std::stoull(test::read_file(folder / "blocked").substr(8), nullptr, 16);
  EXPECT_EQ(still_blocked >> (SIGTERM - 1) & 1u, 0u);
  EXPECT_NE(test::read_file(folder / "session"), std::to_string(getsid(0)) + "\n");
}

}  // namespace
}  // namespace lumbrical::tool
