// See modbus_link.h.
#include "modbus/modbus_link.h"

#include <errno.h>
#include <modbus/modbus.h>
#include <termios.h>
#include <time.h>

#include <cmath>

namespace lumbrical {
namespace {

struct Rate {
  std::uint32_t baud;
  speed_t code;
};
constexpr Rate kRates[] = {{1200, B1200},       {2400, B2400},       {4800, B4800},       {9600, B9600},
                           {19200, B19200},     {38400, B38400},     {57600, B57600},     {115200, B115200},
                           {230400, B230400},   {460800, B460800},   {500000, B500000},   {576000, B576000},
                           {921600, B921600},   {1000000, B1000000}, {1152000, B1152000}, {1500000, B1500000},
                           {2000000, B2000000}, {2500000, B2500000}, {3000000, B3000000}, {3500000, B3500000},
                           {4000000, B4000000}};

Status check_baud(int file, const Transport& transport) {
  termios settings{};
  if (tcgetattr(file, &settings) != 0) return Status::error(transport.line + ": is no serial line");
  const speed_t speed = cfgetospeed(&settings);
  std::uint32_t taken = 0;
  for (const Rate& rate : kRates) {
    if (rate.code == speed) taken = rate.baud;
  }
  if (taken == transport.baud) return {};
  return Status::error(transport.line + ": asked for " + std::to_string(transport.baud) +
                       " baud, the line runs at " + std::to_string(taken) +
                       "; use a rate that libmodbus and the driver know");
}

constexpr LinkResult kNoSuchUnit = {LinkOutcome::broken, "a unit id that this transport can't address"};

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
  const std::string port = std::to_string(transport.port);
  const std::string name = transport.serial ? transport.line : transport.host + ":" + port;
  context_.reset(transport.serial
                     ? modbus_new_rtu(transport.line.c_str(), static_cast<int>(transport.baud),
                                      static_cast<char>(transport.parity), 8, transport.stop_bits)
                     : modbus_new_tcp_pi(transport.host.c_str(), port.c_str()));
  if (!context_) return Status::error(name + ": " + modbus_strerror(errno));
  const auto seconds = static_cast<std::uint32_t>(timeout);
  const auto microseconds = static_cast<std::uint32_t>((timeout - seconds) * 1e6);
  modbus_set_error_recovery(context_.get(), MODBUS_ERROR_RECOVERY_NONE);
  modbus_set_response_timeout(context_.get(), seconds, microseconds);
  modbus_set_byte_timeout(context_.get(), seconds, microseconds);
  modbus_set_slave(context_.get(), 1);
  if (modbus_connect(context_.get()) != 0) {
    const int error = errno;
    close();
    return Status::error(name + ": " + modbus_strerror(error));
  }
  silence_ = 0;
  if (transport.serial) {
    silence_ = 3.5 * character_bits(transport) / transport.baud;
    if (Status status = check_baud(modbus_get_socket(context_.get()), transport); !status.ok()) {
      close();
      return status;
    }
    modbus_flush(context_.get());
  }
  return {};
}

void ModbusLink::close() { context_.reset(); }

// False: a unit that no request can be sent to; the one before must not get it instead.
bool ModbusLink::address(std::uint8_t unit) {
  if (modbus_set_slave(context_.get(), unit) != 0) return false;
  keep_silence();
  return true;
}

void ModbusLink::keep_silence() const {
  if (silence_ <= 0) return;
  timespec pause{0, static_cast<long>(silence_ * 1e9)};
  nanosleep(&pause, nullptr);
}

LinkResult ModbusLink::result(int answer, int count) {
  if (answer == count) return {};
  const int error = errno;
  const char* const text = answer >= 0 ? "a reply of the wrong length" : modbus_strerror(error);
  const bool exception = answer < 0 && error > MODBUS_ENOBASE && error < EMBBADCRC;
  return {exception ? LinkOutcome::refused : LinkOutcome::broken, text};
}

LinkResult ModbusLink::write(const RegisterBlock& block, const std::uint16_t* words) {
  if (!address(block.unit)) return kNoSuchUnit;
  return result(modbus_write_registers(context_.get(), block.address, block.count, words), block.count);
}

LinkResult ModbusLink::read(int function, const RegisterBlock& block, std::uint16_t* words) {
  if (!address(block.unit)) return kNoSuchUnit;
  const int answer = function == 4
                         ? modbus_read_input_registers(context_.get(), block.address, block.count, words)
                         : modbus_read_registers(context_.get(), block.address, block.count, words);
  return result(answer, block.count);
}

LinkResult ModbusLink::exchange(const RegisterBlock& write, const std::uint16_t* sent,
                                const RegisterBlock& read, std::uint16_t* words) {
  if (!address(write.unit)) return kNoSuchUnit;
  return result(modbus_write_and_read_registers(context_.get(), write.address, write.count, sent,
                                                read.address, read.count, words),
                read.count);
}

double line_time(const DeviceProfile& profile) {
  if (!profile.transport.serial) return 0;
  const ExchangePlan plan = plan_exchange(profile);
  double characters = 0;
  if (plan.combined) {
    characters = 13 + 2 * plan.writes[0].count + 5 + 2 * plan.reads[0].count + 7;
  } else {
    for (const RegisterBlock& block : plan.writes) characters += 9 + 2 * block.count + 8 + 7;
    for (const RegisterBlock& block : plan.reads) characters += 8 + 5 + 2 * block.count + 7;
  }
  return characters * character_bits(profile.transport) / profile.transport.baud;
}

}  // namespace lumbrical
