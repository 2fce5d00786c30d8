// Device profiles: which fields they have, and which Modbus requests make a cycle of them.
#include "lumbrical/device_profile.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "device/profile_check.h"
#include "device/registers.h"
#include "lumbrical/math.h"

namespace lumbrical {
namespace {

// Reading a few registers more costs less than one more request.
constexpr int kWidestReadGap = 16;

RegisterField word_field(std::uint8_t unit, std::uint16_t address) {
  RegisterField field;
  field.unit = unit;
  field.address = address;
  field.type = RegisterType::u16;
  return field;
}

std::vector<NamedField> read_fields(const DeviceProfile& profile) {
  std::vector<NamedField> fields;
  for (std::size_t i = 0; i < profile.sensors.size(); ++i) {
    fields.push_back({profile.sensors[i].field, "sensors[" + std::to_string(i) + "].at"});
  }
  if (profile.heartbeat.echoed) {
    fields.push_back({word_field(profile.heartbeat.unit, profile.heartbeat.echo_address), "heartbeat.echo"});
  }
  if (profile.status.present) {
    fields.push_back({word_field(profile.status.unit, profile.status.address), "status"});
  }
  return fields;
}

// Registers that go together in one request: a field's two words from two requests may be of two numbers.
struct Span {
  int unit, first, last;
};

std::vector<Span> spans_of(const std::vector<NamedField>& fields) {
  std::vector<Span> spans;
  for (const NamedField& named : fields) {
    const RegisterField& field = named.field;
    spans.push_back({field.unit, field.address, field.address + register_count(field.type) - 1});
  }
  std::sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) {
    return std::tuple(a.unit, a.first, a.last) < std::tuple(b.unit, b.first, b.last);
  });
  std::vector<Span> apart;
  for (const Span& span : spans) {
    if (!apart.empty() && apart.back().unit == span.unit && span.first <= apart.back().last) {
      apart.back().last = std::max(apart.back().last, span.last);
    } else {
      apart.push_back(span);
    }
  }
  return apart;
}

bool holds(const RegisterBlock& block, std::uint8_t unit, int address) {
  return unit == block.unit && address >= block.address && address < block.address + block.count;
}

std::vector<RegisterBlock> blocks_of(const std::vector<NamedField>& fields, int widest_gap, int most) {
  std::vector<RegisterBlock> blocks;
  for (const Span& span : spans_of(fields)) {
    RegisterBlock* const last = blocks.empty() ? nullptr : &blocks.back();
    if (last != nullptr && last->unit == span.unit &&
        span.first - (last->address + last->count) <= widest_gap && span.last - last->address < most) {
      last->count = static_cast<std::uint16_t>(span.last - last->address + 1);
    } else {
      blocks.push_back({static_cast<std::uint8_t>(span.unit), static_cast<std::uint16_t>(span.first),
                        static_cast<std::uint16_t>(span.last - span.first + 1)});
    }
  }
  return blocks;
}

}  // namespace

std::vector<NamedField> written_fields(const DeviceProfile& profile) {
  std::vector<NamedField> fields;
  for (std::size_t i = 0; i < profile.actuators.size(); ++i) {
    const Actuator& actuator = profile.actuators[i];
    const std::string path = "actuators[" + std::to_string(i) + "].";
    fields.push_back({actuator.field, path + "at"});
    if (!actuator.local.present) continue;
    fields.push_back({actuator.local.angle, path + "local.angle"});
    fields.push_back({actuator.local.stiffness, path + "local.stiffness"});
    fields.push_back({actuator.local.radius, path + "local.radius"});
  }
  if (profile.control.present) {
    fields.push_back({word_field(profile.control.unit, profile.control.address), "control"});
  }
  if (profile.heartbeat.present) {
    fields.push_back({word_field(profile.heartbeat.unit, profile.heartbeat.address), "heartbeat"});
  }
  return fields;
}

Status check_profile(const DeviceProfile& profile) {
  const ProfileFault fault = find_fault(profile);
  if (fault.what.empty()) return {};
  return Status::error(profile.name + ": " + fault.path + " " + fault.what);
}

Status check_attended(const DeviceProfile& profile) {
  const bool numbered = !has_registers(profile.transport.kind);  // every command has its cycle with it
  if (numbered || profile.heartbeat.present || profile.unattended) return {};
  return Status::error(
      profile.name +
      ": has no heartbeat, so nothing lets go of a force once this program, its "
      "machine or the cable is gone; with a device that needs none, or at your own risk, write "
      "\"unattended\": \"accepted\" in the profile or unattended=accepted in the address");
}

double own_delay(const DeviceProfile& profile, std::size_t joint) {
  double sensed = 0, driven = 0;
  for (const Sensor& sensor : profile.sensors)
    if (is_flexion(sensor) && sensed_joint(sensor) == joint) sensed = max(sensed, sensor.delay.value_or(0));
  for (const Actuator& actuator : profile.actuators)
    if (actuator.arm[joint] != 0) driven = max(driven, actuator.delay.value_or(0));
  return sensed + driven;
}

bool knows_own_delays(const DeviceProfile& profile) {
  const auto says = [](const auto& one) { return one.delay.has_value(); };
  return std::all_of(profile.sensors.begin(), profile.sensors.end(), says) &&
         std::all_of(profile.actuators.begin(), profile.actuators.end(), says);
}

double angle_step(const DeviceProfile& profile, const Sensor& sensor) {
  const RegisterField& field = sensor.field;
  const bool is_counted = has_registers(profile.transport.kind) && field.type != RegisterType::f32;
  return is_counted ? std::fabs(field.scale) : 0;
}

void set_unit(DeviceProfile& profile, std::uint8_t unit) {
  for (Actuator& actuator : profile.actuators) {
    actuator.field.unit = actuator.local.angle.unit = unit;
    actuator.local.stiffness.unit = actuator.local.radius.unit = unit;
  }
  for (Sensor& sensor : profile.sensors) sensor.field.unit = unit;
  for (RegisterWrite& write : profile.handshake) write.unit = unit;
  for (RegisterCheck& check : profile.expected) check.unit = unit;
  profile.control.unit = profile.heartbeat.unit = profile.status.unit = unit;
}

std::string name_registers(const DeviceProfile& profile, const RegisterBlock& block) {
  std::map<int, std::string> names;  // by address
  const auto add = [&](std::uint8_t unit, int address, const std::string& name) {
    if (holds(block, unit, address)) names.try_emplace(address, name);
  };
  for (const Actuator& actuator : profile.actuators) {
    add(actuator.field.unit, actuator.field.address, actuator.name);
    if (!actuator.local.present) continue;
    add(actuator.local.angle.unit, actuator.local.angle.address, actuator.name + " angle");
    add(actuator.local.stiffness.unit, actuator.local.stiffness.address, actuator.name + " stiffness");
    add(actuator.local.radius.unit, actuator.local.radius.address, actuator.name + " radius");
  }
  for (const std::vector<NamedField>& fields : {written_fields(profile), read_fields(profile)}) {
    for (const NamedField& named : fields) add(named.field.unit, named.field.address, named.path);
  }
  for (const RegisterWrite& write : profile.handshake) add(write.unit, write.address, "handshake");
  for (const RegisterCheck& check : profile.expected) add(check.unit, check.address, "expected");
  const int last = block.address + block.count - 1;
  std::string text = block.count == 1
                         ? "register " + std::to_string(last)
                         : "registers " + std::to_string(block.address) + " to " + std::to_string(last);
  text += " of unit " + std::to_string(block.unit);
  if (names.empty()) return text;
  const std::string &from = names.begin()->second, &to = names.rbegin()->second;
  return (from == to ? from : from + " to " + to) + " (" + text + ")";
}

ExchangePlan plan_exchange(const DeviceProfile& profile) {
  ExchangePlan plan;
  const std::vector<NamedField> written = written_fields(profile);
  const std::vector<NamedField> read = read_fields(profile);
  plan.reads = blocks_of(read, kWidestReadGap, kMaxReadRegisters);
  if (profile.read_write) {
    plan.writes = blocks_of(written, 0, kMaxExchangeRegisters);
    plan.combined = plan.writes.size() == 1 && plan.reads.size() == 1 &&
                    plan.writes[0].unit == plan.reads[0].unit && profile.read_function == 3;
  }
  if (!plan.combined) plan.writes = blocks_of(written, 0, kMaxWriteRegisters);
  const Heartbeat& beat = profile.heartbeat;
  std::stable_partition(plan.writes.begin(), plan.writes.end(), [&beat](const RegisterBlock& block) {
    return !(beat.present && holds(block, beat.unit, beat.address));
  });
  return plan;
}

}  // namespace lumbrical
