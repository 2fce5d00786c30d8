// See modbus_link.h.
#include "modbus/modbus_link.h"

#include <errno.h>
#include <fcntl.h>
#include <modbus/modbus.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "base/steady_clock.h"
#include "loop/private_network.h"
#include "modbus/line_rates.h"

namespace lumbrical {
namespace {

Status check_baud(int file, const Transport& transport) {
  termios settings{};
  if (tcgetattr(file, &settings) != 0) return Status::error(transport.line + ": is no serial line");
  const std::uint32_t taken = baud_of(cfgetospeed(&settings));
  if (taken == transport.baud) return {};
  return Status::error(transport.line + ": asked for " + std::to_string(transport.baud) +
                       " baud, the line runs at " + std::to_string(taken) +
                       "; use a rate that libmodbus and the driver know");
}

const char* const kHungUp = "the device has hung up";
constexpr std::int64_t kGlance = 1000000;  // [ns] between two looks at whether there is a hurry

bool wait_for_input(int file, std::int64_t span) {
  pollfd poll_file{file, POLLIN, 0};
  const timespec time{static_cast<time_t>(span / 1000000000), static_cast<long>(span % 1000000000)};
  return ppoll(&poll_file, 1, &time, nullptr) > 0;
}

void sleep_for(double seconds) {
  const timespec pause{0, static_cast<long>(seconds * 1e9)};
  nanosleep(&pause, nullptr);
}

std::string in_words(int error) {
  if (error == ECONNREFUSED)
    return "connection refused: nothing listens there; is the device on, the port right?";
  if (error == ETIMEDOUT || error == EINPROGRESS)  // which is what libmodbus leaves when it gives up
    return "timed out: the host does not answer; check cable, power and address";
  return modbus_strerror(error);
}

// libmodbus refuses 0.
void set_timeout(modbus_t* context, std::int64_t span) {
  const auto microseconds = static_cast<std::uint32_t>(std::max<std::int64_t>(span / 1000, 1));
  modbus_set_response_timeout(context, microseconds / 1000000, microseconds % 1000000);
}

int character_bits(const Transport& transport) {
  return 9 + transport.stop_bits + (transport.parity == Parity::none ? 0 : 1);
}

}  // namespace

void ModbusLink::Free::operator()(_modbus* context) const {
  modbus_close(context);
  modbus_free(context);
}

Status ModbusLink::open(const Transport& transport, double timeout) {
  close();
  const Status status =
      transport.kind == TransportKind::rtu ? open_line(transport, timeout) : open_tcp(transport, timeout);
  if (!status.ok()) return close(), status;
  file_ = modbus_get_socket(context_.get());
  serial_ = transport.kind == TransportKind::rtu;
  return {};
}

// The first of the host's addresses that answers. Each gets its share of the time that is left, so that one
// that says nothing doesn't take that of the others.
Status ModbusLink::open_tcp(const Transport& transport, double timeout) {
  const std::string port = std::to_string(transport.port);
  std::vector<std::string> addresses;
  if (Status status = find_host(transport.host, transport.anywhere, addresses); !status.ok()) return status;
  int error = 0;
  const std::int64_t end = steady_ns() + in_ns(timeout);
  auto left = static_cast<std::int64_t>(addresses.size());
  for (const std::string& address : addresses) {
    context_.reset(modbus_new_tcp_pi(address.c_str(), port.c_str()));
    if (!context_) return Status::error(address + ": " + modbus_strerror(errno));
    modbus_set_error_recovery(context_.get(), MODBUS_ERROR_RECOVERY_NONE);
    set_timeout(context_.get(), (end - steady_ns()) / left--);
    if (modbus_connect(context_.get()) == 0) return {};
    error = errno;
  }
  return Status::error(transport.host + ":" + port + ": " + in_words(error));
}

// Two sessions on a line would read each other's replies; and one that is refused must not have set the other
// one's baud rate and parity, as libmodbus does when it connects.
Status ModbusLink::lock_line(const std::string& line) {
  lock_ = ::open(line.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (lock_ >= 0 && ::flock(lock_, LOCK_EX | LOCK_NB) == 0) return {};
  return Status::error(line + ": " +
                       (errno == EWOULDBLOCK ? "is in use by another session" : std::strerror(errno)));
}

Status ModbusLink::open_line(const Transport& transport, double timeout) {
  if (Status status = lock_line(transport.line); !status.ok()) return status;
  context_.reset(modbus_new_rtu(transport.line.c_str(), static_cast<int>(transport.baud),
                                static_cast<char>(transport.parity), 8, transport.stop_bits));
  if (!context_ || modbus_connect(context_.get()) != 0)
    return Status::error(transport.line + ": " + modbus_strerror(errno));
  if (Status status = check_baud(modbus_get_socket(context_.get()), transport); !status.ok()) return status;
  silence_ = 3.5 * character_bits(transport) / transport.baud;
  await_late_replies(timeout);
  modbus_flush(context_.get());
  return {};
}

// To what was asked before the line was opened, by whomever: on a line nothing says which request a reply
// belongs to. An emergency stop doesn't wait for that.
void ModbusLink::await_late_replies(double timeout) const {
  std::int64_t end = steady_ns() + in_ns(timeout);
  for (bool hurried = false; steady_ns() < end; sleep_for(in_seconds(kGlance))) end = hurry_up(hurried, end);
}

// When to give up, which is sooner once there is a hurry.
std::int64_t ModbusLink::hurry_up(bool& hurried, std::int64_t end) const {
  if (hurried || !patience.hurry || !patience.hurry()) return end;
  hurried = true;
  return std::min(end, steady_ns() + in_ns(patience.hurried));
}

void ModbusLink::close() {
  context_.reset();
  if (lock_ >= 0) ::close(lock_);
  file_ = lock_ = -1;
}

LinkResult ModbusLink::write(const RegisterBlock& block, const std::uint16_t* words) {
  return transact(
      {.unit = block.unit, .function = 16, .write_address = block.address, .write_count = block.count}, words,
      nullptr);
}

LinkResult ModbusLink::read(int function, const RegisterBlock& block, std::uint16_t* words) {
  return transact({.unit = block.unit,
                   .function = static_cast<std::uint8_t>(function),
                   .read_address = block.address,
                   .read_count = block.count},
                  nullptr, words);
}

LinkResult ModbusLink::exchange(const RegisterBlock& write, const std::uint16_t* sent,
                                const RegisterBlock& read, std::uint16_t* words) {
  return transact({.unit = write.unit,
                   .function = 23,
                   .write_address = write.address,
                   .write_count = write.count,
                   .read_address = read.address,
                   .read_count = read.count},
                  sent, words);
}

LinkResult ModbusLink::transact(ModbusQuestion question, const std::uint16_t* sent, std::uint16_t* words) {
  if (serial_) sleep_for(silence_);
  if (const char* const why = forget_input(); why != nullptr) return {LinkOutcome::broken, why};
  question.serial = serial_;
  question.transaction = ++transaction_;
  frame_question(question, sent, frame_);
  const std::int64_t end = steady_ns() + in_ns(patience.usual);
  const LinkResult result = send(end);
  return result.ok() ? receive(question, end, words) : result;
}

// What came before it was asked for. On a line that is noise; on a connection no one can know what it belongs
// to.
const char* ModbusLink::forget_input() {
  pollfd poll_file{file_, POLLIN, 0};
  if (poll(&poll_file, 1, 0) <= 0) return nullptr;
  if (serial_) return tcflush(file_, TCIFLUSH) == 0 ? nullptr : "the line is gone";
  std::uint8_t byte = 0;
  const ssize_t count = recv(file_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return count == 0 ? kHungUp : count < 0 ? std::strerror(errno) : "bytes that no request asked for";
}

LinkResult ModbusLink::send(std::int64_t end) {
  std::size_t sent = 0;
  while (sent < frame_.size()) {
    const std::size_t left = frame_.size() - sent;
    const ssize_t count = serial_ ? ::write(file_, frame_.data() + sent, left)
                                  : ::send(file_, frame_.data() + sent, left, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count > 0) {
      sent += static_cast<std::size_t>(count);
      continue;
    }
    if (count < 0 && errno != EAGAIN && errno != EINTR) return {LinkOutcome::broken, std::strerror(errno)};
    if (steady_ns() >= end) return {LinkOutcome::broken, "timed out: requests are not taken"};
    pollfd poll_file{file_, POLLOUT, 0};
    poll(&poll_file, 1, 1);
  }
  return {};
}

LinkResult ModbusLink::receive(const ModbusQuestion& question, std::int64_t end, std::uint16_t* words) {
  received_.clear();
  bool hurried = false;
  for (;;) {
    end = hurry_up(hurried, end);
    const std::int64_t now = steady_ns();
    if (now >= end) {
      return {LinkOutcome::broken, hurried ? "timed out: no reply in two cycles to an emergency stop"
                                   : received_.empty() ? "timed out: no reply"
                                                       : "timed out: a reply that does not end"};
    }
    if (!wait_for_input(file_, std::min(end - now, kGlance))) continue;
    std::array<std::uint8_t, 512> block{};
    const ssize_t count = serial_ ? ::read(file_, block.data(), block.size())
                                  : recv(file_, block.data(), block.size(), MSG_DONTWAIT);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) return {LinkOutcome::broken, count == 0 ? kHungUp : std::strerror(errno)};
    received_.insert(received_.end(), block.begin(), block.begin() + count);
    const ReplyCheck check = check_reply(question, received_);
    if (check.kind == ReplyKind::incomplete) continue;
    if (check.kind == ReplyKind::wrong) return {LinkOutcome::broken, check.why};
    if (check.kind == ReplyKind::exception)
      return {LinkOutcome::refused, modbus_strerror(MODBUS_ENOBASE + check.exception), check.exception};
    for (std::size_t i = 0; i < question.read_count; ++i) {
      words[i] = static_cast<std::uint16_t>(received_[check.words + 2 * i] << 8 |
                                            received_[check.words + 2 * i + 1]);
    }
    return {};
  }
}

}  // namespace lumbrical
