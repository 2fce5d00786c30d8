// See lumbrical/modbus_server.h.
#include "lumbrical/modbus_server.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

#include "loop/private_network.h"
#include "modbus/line_rates.h"
#include "modbus/modbus_frame.h"

namespace lumbrical {
namespace {

using Clock = std::chrono::steady_clock;

// What a client may have sent and not been answered yet; no more is read before.
constexpr std::size_t kMostBuffered = 4096;
constexpr std::size_t kMostPeers = 16;
// Answered to one client before the others, and the device's own clock, have their turn.
constexpr int kMostAtOnce = 8;
constexpr std::chrono::seconds kAtWork{1};  // after a request a client keeps its place for so long

Status system_error(const std::string& what) { return Status::error(what + ": " + std::strerror(errno)); }

Status make_raw(int line, const std::string& name, speed_t speed) {
  termios settings{};
  if (tcgetattr(line, &settings) != 0) return system_error(name);
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  if (speed != 0) cfsetspeed(&settings, speed);
  if (tcsetattr(line, TCSANOW, &settings) != 0) return system_error(name);
  return {};
}

void spoil(WrongReply wrong, ModbusRequest& request, Bytes& answer) {
  if (wrong == WrongReply::transaction) --request.transaction;
  if (wrong == WrongReply::unit) ++request.unit;
  if (wrong == WrongReply::registers && answer[0] == 16) ++answer[2];
  if (wrong == WrongReply::function) ++answer[0];
}

void spoil(WrongReply wrong, bool serial, Bytes& frame) {
  if (wrong == WrongReply::protocol && !serial) frame[3] = 1;
  if (wrong == WrongReply::length) ++frame[serial ? 2 : 5];
  if (wrong == WrongReply::behind) frame.push_back(0);
}

/// Where a symbolic link points; empty where there is none.
std::string target_of(const std::string& link) {
  std::array<char, 128> target{};
  const ssize_t size = readlink(link.c_str(), target.data(), target.size());
  return size > 0 ? std::string(target.data(), static_cast<std::size_t>(size)) : std::string();
}

// Nothing that is there is taken away but what a killed simulator has left: a link to a terminal that is
// gone, or that is this one's by now.
Status put_link(const std::string& terminal, const std::string& link) {
  const std::string old = target_of(link);
  const bool left_over = old.starts_with("/dev/pts/") && (old == terminal || access(old.c_str(), F_OK) != 0);
  if (left_over) unlink(link.c_str());
  if (symlink(terminal.c_str(), link.c_str()) == 0) return {};
  if (errno != EEXIST) return system_error(link);
  return Status::error(link + ": is there already, and nothing is taken away; name another link");
}

}  // namespace

struct ModbusServer::Peer {
  int file = -1;
  bool serial = false;
  Bytes received{};
  Clock::time_point last{};  // when it asked something
  bool more = false;         // requests wait in `received`
};

// One call of serve().
struct ModbusServer::Session {
  SimulatedDevice& device;
  ServerFaults& faults;
  RegisterAccess access;
  std::vector<Peer> peers;
  std::uint32_t random = 1;
  Clock::time_point now = Clock::now();
  const std::function<void(SimulatedDevice&)>& observe;

  Session(SimulatedDevice& simulated, ServerFaults& wanted,
          const std::function<void(SimulatedDevice&)>& watch)
      : device(simulated), faults(wanted), observe(watch) {
    access.has_unit = [this](std::uint8_t unit) { return device.has_unit(unit); };
    access.read = [this](auto unit, auto address, auto words) {
      if (const int code = faults.hide_commands; code != 0 && device.is_command(unit, address)) return code;
      return device.read(unit, address, words);
    };
    access.write = [this](auto unit, auto address, auto words) { return device.write(unit, address, words); };
    access.read_inputs = [this](auto unit, auto address, auto words) {
      return device.read_inputs(unit, address, words);
    };
  }

  std::uint32_t next_random() { return random = random * 1664525u + 1013904223u; }
  void advance() {
    const Clock::time_point then = std::exchange(now, Clock::now());
    device.advance(std::chrono::duration<double>(now - then).count());
    if (observe) observe(device);
  }
  void wait_as_told() {
    const double jitter = faults.jitter * static_cast<double>(next_random() >> 8) / 16777216.0;
    const double seconds = faults.delay + jitter;
    if (seconds > 0) std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  }
  // False: a client that takes no replies. No one waits for it.
  bool send(const Peer& peer, const Bytes& bytes) const {
    const double pause = faults.trickle;
    std::size_t sent = 0;
    while (sent < bytes.size()) {
      const std::size_t left = pause > 0 ? 1 : bytes.size() - sent;
      const ssize_t count = peer.serial
                                ? ::write(peer.file, bytes.data() + sent, left)
                                : ::send(peer.file, bytes.data() + sent, left, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return peer.serial;  // a line has no other end that could be closed
      sent += static_cast<std::size_t>(count);
      if (pause > 0) std::this_thread::sleep_for(std::chrono::duration<double>(pause));
    }
    return true;
  }
  bool reply(Peer& peer, ModbusRequest request);
  bool receive(Peer& peer, std::atomic<std::uint64_t>& requests);
  void welcome(int file);
};

// False: close the connection.
bool ModbusServer::Session::reply(Peer& peer, ModbusRequest request) {
  if (!access.has_unit(request.unit)) return true;  // on a bus another unit would answer
  advance();
  Bytes answer = answer_request(access, request.unit, request.body);
  if (const int code = faults.exception; code != 0) {
    answer = {static_cast<std::uint8_t>(request.body[0] | 0x80), static_cast<std::uint8_t>(code)};
  }
  wait_as_told();
  if (faults.silent) return true;
  spoil(faults.wrong, request, answer);
  Bytes frame = peer.serial ? frame_rtu(request, answer) : frame_tcp(request, answer);
  spoil(faults.wrong, peer.serial, frame);
  if (faults.garbage) {
    Bytes noise;
    for (int i = 0; i < 9; ++i) noise.push_back(static_cast<std::uint8_t>(next_random() >> 24));
    if (!peer.serial) return send(peer, noise);
    frame.insert(frame.begin(), noise.begin(), noise.end());
  }
  if (faults.cut_reply) {
    frame.resize(frame.size() / 2);
    return send(peer, frame) && peer.serial;
  }
  return send(peer, frame);
}

bool ModbusServer::Session::receive(Peer& peer, std::atomic<std::uint64_t>& requests) {
  std::array<std::uint8_t, 1024> block{};
  if (peer.received.size() < kMostBuffered) {
    errno = 0;
    const ssize_t count = peer.serial ? ::read(peer.file, block.data(), block.size())
                                      : ::recv(peer.file, block.data(), block.size(), MSG_DONTWAIT);
    // A terminal without anyone at its other end reports an input error and comes back to life later.
    const bool later = errno == EINTR || errno == EAGAIN || (peer.serial && errno == EIO);
    if (count == 0 || (count < 0 && !later)) return peer.serial;
    if (count > 0) peer.received.insert(peer.received.end(), block.begin(), block.begin() + count);
  }
  ModbusRequest request;
  for (int i = 0; i < kMostAtOnce; ++i) {
    const Cut cut = peer.serial ? cut_rtu(peer.received, request) : cut_tcp(peer.received, request);
    peer.more = cut == Cut::request;
    if (cut == Cut::broken) return false;
    if (cut == Cut::incomplete) return peer.received.size() < kMostBuffered;
    peer.last = now;
    ++requests;
    if (!reply(peer, request)) return false;
  }
  return true;
}

void ModbusServer::Session::welcome(int file) {
  if (faults.refuse) {
    ::close(file);
    return;
  }
  if (peers.size() >= kMostPeers) {  // who has asked nothing of late makes room
    const auto oldest = std::min_element(peers.begin(), peers.end(),
                                         [](const Peer& a, const Peer& b) { return a.last < b.last; });
    const bool at_work = now - oldest->last < kAtWork;
    ::close(at_work ? file : oldest->file);
    if (at_work) return;
    peers.erase(oldest);
  }
  const int yes = 1;
  setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  peers.push_back({file, false});
}

ModbusServer::ModbusServer() = default;
ModbusServer::~ModbusServer() { close(); }

Status ModbusServer::listen(const std::string& host, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICHOST | AI_PASSIVE;
  addrinfo* place = nullptr;
  if (getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &place) != 0) {
    return Status::error(host + ": is no address in numbers; use 127.0.0.1");
  }
  close();
  listener_ = socket(place->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int yes = 1;
  sockaddr_storage taken{};
  socklen_t size = sizeof taken;
  const bool listens =
      listener_ >= 0 && setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0 &&
      bind(listener_, place->ai_addr, place->ai_addrlen) == 0 && ::listen(listener_, 64) == 0 &&
      getsockname(listener_, reinterpret_cast<sockaddr*>(&taken), &size) == 0;
  const Status status = listens ? Status() : system_error(host + ":" + std::to_string(port));
  const bool v6 = place->ai_family == AF_INET6;
  open_to_others_ = !is_loopback(*place->ai_addr);
  freeaddrinfo(place);
  if (!listens) {
    close();
    return status;
  }
  port_ = ntohs(v6 ? reinterpret_cast<sockaddr_in6&>(taken).sin6_port
                   : reinterpret_cast<sockaddr_in&>(taken).sin_port);
  name_ = (v6 ? "[" + host + "]" : host) + ":" + std::to_string(port_);
  return {};
}

Status ModbusServer::open_terminal(const std::string& link) {
  close();
  line_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  std::array<char, 128> name{};
  if (line_ < 0 || grantpt(line_) != 0 || unlockpt(line_) != 0 ||
      ptsname_r(line_, name.data(), name.size()) != 0) {
    const Status status = system_error("a pseudo-terminal can't be opened");
    close();
    return status;
  }
  name_ = name.data();
  if (!link.empty()) {
    if (Status status = put_link(name_, link); !status.ok()) {
      close();
      return status;
    }
    link_ = link;
  }
  Status status = make_raw(line_, name_, 0);
  if (!status.ok()) close();
  return status;
}

Status ModbusServer::open_line(const std::string& path, std::uint32_t baud) {
  const speed_t speed = code_of(baud);
  if (speed == 0) return Status::error(path + ": " + std::to_string(baud) + " baud is not a standard rate");
  close();
  line_ = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  if (line_ < 0) return system_error(path);
  name_ = path;
  Status status = make_raw(line_, name_, speed);
  if (!status.ok()) close();
  return status;
}

void ModbusServer::close() {
  for (int* const file : {&listener_, &line_}) {
    if (*file >= 0) ::close(*file);
    *file = -1;
  }
  if (!link_.empty() && target_of(link_) == name_) unlink(link_.c_str());
  link_.clear();
}

void ModbusServer::serve(SimulatedDevice& device, ServerFaults& faults, const std::function<bool()>& stop,
                         const std::function<void(SimulatedDevice&)>& observe) {
  Session session(device, faults, observe);
  if (line_ >= 0) session.peers.push_back({line_, true});
  while (!stop()) {
    std::vector<pollfd> files;
    bool more = false;
    for (const Peer& peer : session.peers) {
      files.push_back({peer.file, POLLIN, 0});
      more = more || peer.more;
    }
    if (listener_ >= 0) files.push_back({listener_, POLLIN, 0});
    poll(files.data(), files.size(), more ? 0 : 1);
    session.advance();
    bool hung_up = false;
    for (std::size_t i = session.peers.size(); i-- > 0;) {
      Peer& peer = session.peers[i];
      if (files[i].revents == 0 && !peer.more) continue;
      if (peer.serial && (files[i].revents & POLLIN) == 0) hung_up = true;
      if (session.receive(peer, requests_)) continue;
      ::close(peer.file);
      session.peers.erase(session.peers.begin() + static_cast<std::ptrdiff_t>(i));
    }
    for (int i = 0; listener_ >= 0 && i < kMostAtOnce; ++i) {
      const int file = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
      if (file < 0) break;
      session.welcome(file);
    }
    if (hung_up) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  for (const Peer& peer : session.peers) {
    if (!peer.serial) ::close(peer.file);
  }
}

}  // namespace lumbrical
