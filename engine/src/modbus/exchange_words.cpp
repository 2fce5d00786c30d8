// See exchange_words.h.
#include "modbus/exchange_words.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "device/registers.h"
#include "lumbrical/math.h"

namespace lumbrical {
namespace {

std::uint16_t* place(const std::vector<RegisterBlock>& blocks, std::vector<std::uint16_t>& words,
                     std::uint8_t unit, std::uint16_t address) {
  const int at = find_register(blocks, unit, address);
  return at < 0 ? nullptr : words.data() + at;
}

// Anything that can't be encoded leaves the register as it is, and that only happens to what is no number.
void put(ExchangeWords& exchange, const RegisterField& field, double value) {
  std::uint16_t* const at = place(exchange.plan.writes, exchange.written, field.unit, field.address);
  if (at == nullptr) return;
  encode_field(field, value, std::span(at, static_cast<std::size_t>(register_count(field.type))));
}

double command_in(const ExchangeWords& exchange, const RegisterField& field) {
  const int at = find_register(exchange.plan.writes, field.unit, field.address);
  return decode_field(
      field, std::span(exchange.written.data() + at, static_cast<std::size_t>(register_count(field.type))));
}

// Rounded to a count that its actuator may be told: where the nearest one lies beyond a limit, one less.
void put_command(ExchangeWords& exchange, const Actuator& actuator, double value) {
  constexpr double kRounding = 1e-6;  // [counts] of decoding
  const RegisterField& field = actuator.field;
  put(exchange, field, value);
  if (field.type == RegisterType::f32) return;
  const double count = std::fabs(field.scale), told = command_in(exchange, field);
  if (told > actuator.upper + kRounding * count) put(exchange, field, told - count);
  if (told < actuator.lower - kRounding * count) put(exchange, field, told + count);
}

// Round the nearest angle that its register can tell, the device would make of the model what no one meant.
LocalModel tellable(const LocalFields& fields, LocalModel local) {
  if (!can_hold(fields.angle, local.angle)) local.stiffness = local.radius = 0;
  return local;
}

}  // namespace

ExchangeWords::ExchangeWords(const DeviceProfile& profile) : plan(plan_exchange(profile)) {
  written.assign(static_cast<std::size_t>(total_count(plan.writes)), 0);
  claimed.assign(written.size(), 0xFFFF);
  for (const bool claims : {false, true}) {  // the other byte of a register may be the device's own
    for (const Actuator& actuator : profile.actuators) {
      const RegisterType type = actuator.field.type;
      if (type != RegisterType::u8_high && type != RegisterType::u8_low) continue;
      std::uint16_t& mask = *place(plan.writes, claimed, actuator.field.unit, actuator.field.address);
      const unsigned byte = type == RegisterType::u8_high ? 0xFF00 : 0x00FF;
      mask = static_cast<std::uint16_t>(claims ? mask | byte : 0);
    }
  }
  read.assign(static_cast<std::size_t>(total_count(plan.reads)), 0);
  for (const RegisterWrite& write : profile.handshake) {
    if (std::uint16_t* const at = place(plan.writes, written, write.unit, write.address)) *at = write.value;
  }
}

void ExchangeWords::write(const DeviceProfile& profile, const WireCommand& command) {
  const SafetyOutput& output = command.output;
  for (std::size_t i = 0; i < profile.actuators.size(); ++i) {
    const Actuator& actuator = profile.actuators[i];
    put_command(*this, actuator, output.command[i]);
    if (!actuator.local.present) continue;
    const LocalModel local = tellable(actuator.local, local_model_of(command, i));
    put(*this, actuator.local.angle, local.angle);
    put(*this, actuator.local.stiffness, local.stiffness);
    put(*this, actuator.local.radius, local.radius);
  }
  if (profile.control.present) {
    *place(plan.writes, written, profile.control.unit, profile.control.address) =
        output.device_on ? profile.control.active : profile.control.idle;
  }
  if (std::uint16_t* const beat = heartbeat(profile)) *beat = static_cast<std::uint16_t>(command.cycle);
}

std::uint16_t* ExchangeWords::heartbeat(const DeviceProfile& profile) {
  const Heartbeat& beat = profile.heartbeat;
  return beat.present ? place(plan.writes, written, beat.unit, beat.address) : nullptr;
}

void ExchangeWords::commands(const DeviceProfile& profile, ActuatorArray& command) const {
  for (std::size_t i = 0; i < profile.actuators.size(); ++i) {
    const Actuator& actuator = profile.actuators[i];
    const double value = command_in(*this, actuator.field);
    command[i] = std::isfinite(value) ? clamp(value, actuator.lower, actuator.upper) : actuator.safe;
  }
}

std::pair<RegisterBlock, std::size_t> ExchangeWords::part(std::size_t index) const {
  const auto parts_of = [](const RegisterBlock& block) { return (block.count + kLookBack - 1) / kLookBack; };
  std::size_t count = 0, at = 0;
  for (const RegisterBlock& block : plan.writes) count += parts_of(block);
  index %= count;
  for (const RegisterBlock& block : plan.writes) {
    if (index < parts_of(block)) {
      const std::size_t first = index * kLookBack, size = std::min(kLookBack, block.count - first);
      return {
          {block.unit, static_cast<std::uint16_t>(block.address + first), static_cast<std::uint16_t>(size)},
          at + first};
    }
    index -= parts_of(block);
    at += block.count;
  }
  return {};
}

bool ExchangeWords::holds(const RegisterBlock& block, std::size_t at) const {
  for (std::size_t i = 0; i < block.count; ++i) {
    if (((read_back[i] ^ written[at + i]) & claimed[at + i]) != 0) return false;
  }
  return true;
}

DeviceStatus ExchangeWords::status(const DeviceProfile& profile) const {
  DeviceStatus status;
  status.has_dead_man = profile.status.dead_man != 0;
  status.echoes = profile.heartbeat.echoed;
  if (profile.heartbeat.echoed) {
    const int at = find_register(plan.reads, profile.heartbeat.unit, profile.heartbeat.echo_address);
    status.echo = read[static_cast<std::size_t>(at)];
  }
  if (!profile.status.present) return status;
  const std::uint16_t bits =
      read[static_cast<std::size_t>(find_register(plan.reads, profile.status.unit, profile.status.address))];
  status.ready = (bits & profile.status.ready) == profile.status.ready;
  status.fault = (bits & profile.status.fault) != 0;
  status.stop = (bits & profile.status.stop) != 0;
  status.dead_man = profile.status.dead_man == 0 || (bits & profile.status.dead_man) != 0;
  return status;
}

void ExchangeWords::angles(const DeviceProfile& profile, std::array<float, kAngleCount>& angle,
                           std::uint32_t& valid) const {
  valid = 0;
  for (const Sensor& sensor : profile.sensors) {
    const int at = find_register(plan.reads, sensor.field.unit, sensor.field.address);
    const std::span words(read.data() + at, static_cast<std::size_t>(register_count(sensor.field.type)));
    const double value = decode_field(sensor.field, words);
    if (!(value >= sensor.lower && value <= sensor.upper)) continue;  // false for NaN
    angle[static_cast<std::size_t>(sensor.angle)] = static_cast<float>(value);
    valid |= 1u << sensor.angle;
  }
}

}  // namespace lumbrical
