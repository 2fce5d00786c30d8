// See lumbrical/datagram_wire.h.
#include "lumbrical/datagram_wire.h"

#include <errno.h>
#include <netdb.h>
#include <poll.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "base/steady_clock.h"
#include "loop/datagram_message.h"
#include "loop/private_network.h"

namespace lumbrical {
namespace {

constexpr const char* kOutside =
    "is not this machine, and whoever is on the way could command the device; write network=any";
// So many cycles an address that has never answered is asked where there is another one.
constexpr int kSilentCycles = 20;

// A socket that hears of that address only; -1: errno says why.
int connect_socket(const addrinfo& address) {
  const int file = socket(address.ai_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (file < 0 || connect(file, address.ai_addr, address.ai_addrlen) == 0) return file;
  const int error = errno;
  ::close(file);
  errno = error;
  return -1;
}

class DatagramWire final : public DeviceWire {
 public:
  explicit DatagramWire(const DeviceProfile& profile)
      : transport_(profile.transport), actuator_count_(profile.actuators.size()) {}
  ~DatagramWire() override { close_socket(); }

  Status open() override;
  WireResult exchange(const WireCommand& command, WireAnswer& answer) override;
  void close() override { close_socket(); }

 private:
  void close_socket() {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
  }
  WireResult broken(int error) const {
    return {WireOutcome::broken,
            error == ECONNREFUSED ? "nothing listens at " + place() : place() + ": " + std::strerror(error)};
  }
  [[nodiscard]] std::string place() const {
    const std::string named = transport_.host + ":" + std::to_string(transport_.port);
    return address_.empty() || address_ == transport_.host ? named : named + " (" + address_ + ")";
  }
  WireResult unanswered(const std::string& what);
  Status connect_next();
  bool await_datagram(std::int64_t begun) const;

  Transport transport_;
  std::size_t actuator_count_;
  int file_ = -1;
  std::size_t opened_ = 0, addresses_ = 0;  // of the host: tried so far, and how many there are
  int silent_ = 0;       // cycles since it was opened in which nothing was heard; -1: something was
  std::string address_;  // in numbers, the one that was tried last
  std::uint64_t session_ = 0, boot_ = 0;  // the device's; 0: not known
  std::vector<std::byte> sent_;
};

Status DatagramWire::open() {
  close_socket();
  silent_ = 0;
  boot_ = 0;
  if (Status status = connect_next(); !status.ok()) return status;
  // Who does not see the datagrams can't guess it.
  if (getrandom(&session_, sizeof session_, 0) != sizeof session_)
    return Status::error(place() + ": no random number for the session");
  return {};
}

// An address that says nothing at all may be another program's, or nobody's.
WireResult DatagramWire::unanswered(const std::string& what) {
  if (silent_ < 0 || addresses_ < 2 || ++silent_ < kSilentCycles) return {WireOutcome::missed, what};
  return {WireOutcome::broken, what + "; the host's next address is tried"};
}

// A socket of datagrams connects to whatever there is, and only an answer tells where the device is: so each
// time it is the next of the host's addresses.
Status DatagramWire::connect_next() {
  std::vector<std::string> addresses;
  address_.clear();
  if (Status status = find_host(transport_.host, transport_.anywhere, addresses); !status.ok()) return status;
  addresses_ = addresses.size();
  const std::string port = std::to_string(transport_.port);
  Addresses found{nullptr, nullptr};
  int error = 0;  // of the last that was tried
  for (std::size_t i = 0; i < addresses.size() && file_ < 0; ++i) {
    const std::string& address = addresses[opened_++ % addresses.size()];
    if (resolve(address, port.c_str(), AI_NUMERICHOST | AI_NUMERICSERV, found) != 0 ||
        !(transport_.anywhere || is_loopback(*found->ai_addr)))
      continue;
    address_ = address;
    file_ = connect_socket(*found);
    error = errno;
  }
  if (file_ >= 0) return {};
  return Status::error(place() + ": " + (error != 0 ? std::strerror(error) : kOutside));
}

// False: it is too late for one.
bool DatagramWire::await_datagram(std::int64_t begun) const {
  for (;;) {
    const double left = patience.limit() - in_seconds(steady_ns() - begun);
    if (left <= 0) return false;
    pollfd waiting{file_, POLLIN, 0};
    const timespec glance{0, static_cast<long>(1e9 * std::min(left, 0.001))};
    if (ppoll(&waiting, 1, &glance, nullptr) > 0) return true;
  }
}

WireResult DatagramWire::exchange(const WireCommand& command, WireAnswer& answer) {
  write_command(session_, command, actuator_count_, sent_);
  const std::int64_t begun = answer.asked = steady_ns();
  if (send(file_, sent_.data(), sent_.size(), MSG_NOSIGNAL) < 0 && errno != EAGAIN) return broken(errno);
  std::array<std::byte, kMostDatagram + 1> received;
  for (int i = 0; i < kMostDatagramsPerCycle; ++i) {
    if (!await_datagram(begun)) return unanswered("no answer from " + place());
    const ssize_t size = recv(file_, received.data(), received.size(), 0);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (size < 0) return broken(errno);
    std::uint64_t cycle = 0;
    WireAnswer news;
    const std::span whole(received.data(), static_cast<std::size_t>(size));
    if (!read_feedback(whole, session_, cycle, news) || cycle != command.cycle) continue;
    silent_ = -1;
    // It has let go of what it held, and knows nothing of what was there before.
    if (const std::uint64_t before = std::exchange(boot_, news.status.boot);
        before != 0 && before != news.status.boot)
      return {WireOutcome::broken, "the device at " + place() + " has begun anew"};
    news.asked = answer.asked;
    answer = news;
    return {};
  }
  return unanswered("no answer among too many datagrams from " + place());
}

}  // namespace

Status make_datagram_wire(const DeviceProfile& profile, std::unique_ptr<DeviceWire>& wire) {
  if (has_registers(profile.transport.kind) || profile.actuators.size() > kMaxActuators)
    return Status::error(profile.name + ": is no device of datagrams by its transport");
  const Transport& transport = profile.transport;
  // Of a host that is a number: a name is asked for when the wire is opened.
  Addresses list(nullptr, nullptr);
  if (!transport.anywhere && resolve(transport.host, nullptr, AI_NUMERICHOST, list) == 0 &&
      !is_loopback(*list->ai_addr))
    return Status::error(transport.host + ": " + kOutside);
  wire = std::make_unique<DatagramWire>(profile);
  return {};
}

}  // namespace lumbrical
