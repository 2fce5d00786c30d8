// See profile_check.h.
#include "device/profile_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "device/registers.h"

namespace lumbrical {
namespace {

ProfileFault field_fault(const RegisterField& field, const std::string& path) {
  if (!(field.scale != 0) || !std::isfinite(field.scale) || !std::isfinite(field.offset)) {
    return {path + ".scale", "must be finite and not 0"};
  }
  if (field.address + register_count(field.type) > 65536) {
    return {path + ".address", "leaves no room for the field's registers below 65536"};
  }
  return {};
}

ProfileFault range_fault(const RegisterField& field, double low, double high, const std::string& path,
                         const std::string& limits = "the limits") {
  if (ProfileFault fault = field_fault(field, path); !fault.what.empty()) return fault;
  if (can_hold(field, low) && can_hold(field, high)) return {};
  const FieldRange range = field_range(field);
  return {path, "holds " + text_of(range.low) + " .. " + text_of(range.high) + ", too little for " + limits +
                    "; change type, scale or limits"};
}

// Commands are told in counts: the one next to a command must not have to lie beyond a limit.
ProfileFault counts_fault(const Actuator& actuator, const std::string& path) {
  constexpr double kRounding = 1e-6;  // [counts]
  const RegisterField& field = actuator.field;
  if (field.type == RegisterType::f32) return {};
  const double a = (actuator.lower - field.offset) / field.scale,
               b = (actuator.upper - field.offset) / field.scale;
  if (std::ceil(std::min(a, b) - kRounding) <= std::floor(std::max(a, b) + kRounding)) return {};
  return {path + ".scale",
          "is " + text_of(field.scale) + ", and no count of it lies within lower .. upper; make it finer"};
}

ProfileFault limits_fault(const Actuator& actuator, const std::string& path) {
  const double numbers[] = {actuator.lower, actuator.upper, actuator.safe, actuator.preload, actuator.slew};
  for (const double number : numbers) {
    if (!std::isfinite(number)) return {path, "has a limit that is not finite"};
  }
  if (!(actuator.lower < actuator.upper)) return {path + ".upper", "must be above lower"};
  if (actuator.safe < actuator.lower || actuator.safe > actuator.upper) {
    return {path + ".safe", "lies outside lower .. upper"};
  }
  if (actuator.drive != Drive::motor && actuator.lower < 0) {
    return {path + ".lower", "must not be negative: a wire only pulls and a brake only resists"};
  }
  const bool wire = actuator.drive == Drive::wire;
  if (wire ? actuator.preload < actuator.lower || actuator.preload > actuator.upper : actuator.preload != 0) {
    return {path + ".preload", wire ? "lies outside lower .. upper" : "is for wires only"};
  }
  if (!(actuator.slew > 0)) return {path + ".slew", "must be above 0"};
  if (!range::own_delay.holds(actuator.delay.value_or(0)))
    return {path + ".delay", "must be " + text_of(range::own_delay)};
  return {};
}

ProfileFault actuator_fault(const Actuator& actuator, const std::string& path) {
  if (ProfileFault fault = limits_fault(actuator, path); !fault.what.empty()) return fault;
  int joint_count = 0;
  for (const double ratio : actuator.arm) {
    if (!std::isfinite(ratio)) return {path + ".joints", "has a ratio that is not finite"};
    joint_count += ratio != 0 ? 1 : 0;
  }
  if (joint_count == 0) return {path + ".joints", "ties the actuator to no joint"};
  if (!actuator.local.present) return {};
  if (actuator.drive != Drive::motor || joint_count != 1) {
    return {path + ".local", "needs a motor tied to a single joint"};
  }
  return {};
}

// All that is believed of the driven joint. Where no sensor says that, what a finger does; the rest gets no
// model.
ProfileFault local_angle_fault(const DeviceProfile& profile, const Actuator& actuator,
                               const std::string& path) {
  for (const Sensor& sensor : profile.sensors) {
    if (static_cast<std::size_t>(sensor.angle) != flexion_angle(driven_joint(actuator))) continue;
    return range_fault(
        actuator.local.angle, sensor.lower, sensor.upper, path,
        "lower .. upper of the joint's sensor, " + text_of(sensor.lower) + " .. " + text_of(sensor.upper));
  }
  return range_fault(actuator.local.angle, -0.5, 2.0, path);
}

ProfileFault fields_fault(const DeviceProfile& profile, const Actuator& actuator, const std::string& path) {
  if (ProfileFault fault = range_fault(actuator.field, actuator.lower, actuator.upper, path + ".at");
      !fault.what.empty()) {
    return fault;
  }
  if (ProfileFault fault = counts_fault(actuator, path + ".at"); !fault.what.empty()) return fault;
  if (!actuator.local.present) return {};
  const LocalFields& local = actuator.local;
  if (ProfileFault fault = local_angle_fault(profile, actuator, path + ".local.angle"); !fault.what.empty())
    return fault;
  if (ProfileFault fault = range_fault(local.stiffness, 0, 0, path + ".local.stiffness");
      !fault.what.empty()) {
    return fault;
  }
  return range_fault(local.radius, 0, 0.1, path + ".local.radius");
}

// Two fields that write the same byte would fight; two halves of a register get along.
ProfileFault overlap_fault(const std::vector<NamedField>& fields) {
  std::map<std::tuple<int, int, bool>, std::string> owner;  // unit, address, upper byte
  for (const NamedField& named : fields) {
    for (int k = 0; k < register_count(named.field.type); ++k) {
      for (const bool upper : {false, true}) {
        if (named.field.type == (upper ? RegisterType::u8_low : RegisterType::u8_high)) continue;
        const auto [place, first] =
            owner.try_emplace({named.field.unit, named.field.address + k, upper}, named.path);
        if (!first) return {named.path, "overlaps " + place->second};
      }
    }
  }
  return {};
}

struct BoundedNumber {
  const char* path;
  double value;
  Range range;
};

ProfileFault bounds_fault(std::span<const BoundedNumber> numbers, const std::string& of = "") {
  for (const auto& [path, value, range] : numbers)
    if (!range.holds(value)) return {path + of, "must be " + text_of(range)};
  return {};
}

ProfileFault times_fault(const DeviceProfile& profile) {
  const SafetyTimes& safety = profile.safety;
  const BoundedNumber numbers[] = {{"rate", profile.rate, range::exchange_rate},
                                   {"response_timeout", profile.response_timeout, range::response_timeout},
                                   {"first_retry", profile.first_retry, range::first_retry},
                                   {"last_retry", profile.last_retry, range::last_retry},
                                   {"safety.fade", safety.fade, range::device_fade},
                                   {"safety.soft_start", safety.soft_start, range::soft_start},
                                   {"safety.tick_hold", safety.tick_hold, range::tick_hold},
                                   {"safety.tick_timeout", safety.tick_timeout, range::tick_timeout},
                                   {"safety.answer_timeout", safety.answer_timeout, range::answer_timeout}};
  if (ProfileFault fault = bounds_fault(numbers); !fault.what.empty()) return fault;
  if (profile.read_back != 0 && !range::read_back.holds(profile.read_back))
    return {"read_back", "must be 0, or " + text_of(range::read_back)};
  if (profile.first_retry > profile.last_retry) return {"first_retry", "must not exceed last_retry"};
  if (!(profile.rate * safety.answer_timeout > 1)) {
    return {"rate",
            "leaves no time below safety.answer_timeout between two exchanges, so that the device would "
            "count as lost; raise one of them"};
  }
  if (safety.tick_hold > safety.tick_timeout) return {"safety.tick_hold", "must not exceed tick_timeout"};
  if (profile.response_timeout > safety.answer_timeout)
    return {"response_timeout",
            "must not exceed safety.answer_timeout: the device would have let go long ago"};
  return {};
}

// A register may hold less than a joint does, but something of it.
ProfileFault sensed_fault(const Sensor& sensor, const std::string& path) {
  if (ProfileFault fault = field_fault(sensor.field, path); !fault.what.empty()) return fault;
  const FieldRange range = field_range(sensor.field);
  if (range.low <= sensor.upper && range.high >= sensor.lower) return {};
  return {path, "holds " + text_of(range.low) + " .. " + text_of(range.high) +
                    ", nothing of which lies within lower .. upper; change type, scale, offset or limits"};
}

ProfileFault sensors_fault(const DeviceProfile& profile) {
  std::array<bool, kAngleCount> measured{};
  for (std::size_t i = 0; i < profile.sensors.size(); ++i) {
    const Sensor& sensor = profile.sensors[i];
    const std::string path = "sensors[" + std::to_string(i) + "]";
    if (sensor.angle < 0 || sensor.angle >= kAngleCount) return {path + ".joint", "is no angle of a hand"};
    if (std::exchange(measured[static_cast<std::size_t>(sensor.angle)], true))
      return {path + ".joint", "is measured twice"};
    const BoundedNumber numbers[] = {{".lower", sensor.lower, range::sensed_angle},
                                     {".upper", sensor.upper, range::sensed_angle},
                                     {".delay", sensor.delay.value_or(0), range::own_delay}};
    if (ProfileFault fault = bounds_fault(numbers); !fault.what.empty())
      return {path + fault.path, fault.what};
    if (!(sensor.lower < sensor.upper)) return {path + ".upper", "must be above lower"};
    if (!has_registers(profile.transport.kind)) continue;
    if (ProfileFault fault = sensed_fault(sensor, path + ".at"); !fault.what.empty()) return fault;
  }
  return {};
}

ProfileFault dynamics_fault(const DeviceProfile& profile) {
  for (std::size_t j = 0; j < kPhalanxCount; ++j) {
    const JointDynamics& joint = profile.dynamics[j];
    const BoundedNumber numbers[] = {{"dynamics.inertia", joint.inertia, range::joint_inertia},
                                     {"dynamics.damping", joint.damping, range::joint_damping},
                                     {"dynamics.friction", joint.friction, range::joint_friction},
                                     {"dynamics.encoder_step", joint.encoder_step, range::encoder_step}};
    ProfileFault fault = bounds_fault(numbers, " of " + std::string(segment_name(static_cast<int>(j))));
    if (!fault.what.empty()) return fault;
  }
  return {};
}

// What is rendered to a coarser angle than is thought would shake.
ProfileFault steps_fault(const DeviceProfile& profile) {
  for (const Sensor& sensor : profile.sensors) {
    if (!is_finer_than_told(profile, sensor)) continue;
    return {"dynamics.encoder_step of " + std::string(segment_name(static_cast<int>(sensed_joint(sensor)))),
            "is finer than a count of the sensor's register; make it " +
                text_of(angle_step(profile, sensor)) + " rad or more"};
  }
  return {};
}

ProfileFault words_fault(const DeviceProfile& profile) {
  if (profile.handshake.size() > 64) return {"handshake", "may hold at most 64 writes"};
  if (profile.expected.size() > 16) return {"expected", "may hold at most 16 checks"};
  for (std::size_t i = 0; i < profile.expected.size(); ++i) {
    const RegisterCheck& check = profile.expected[i];
    if ((check.value & ~check.mask) != 0)
      return {"expected[" + std::to_string(i) + "].value", "has bits outside the mask"};
  }
  if (profile.read_function != 3 && profile.read_function != 4)
    return {"feedback", "must be \"FC3\" or \"FC4\""};
  if (profile.read_write && profile.read_function != 3)
    return {"feedback", "must be \"FC3\" where the command is \"FC23\", which reads holding registers"};
  const Transport& transport = profile.transport;
  const BoundedNumber numbers[] = {
      {"transport.baud", static_cast<double>(transport.baud), range::baud},
      {"transport.stop_bits", static_cast<double>(transport.stop_bits), range::stop_bits}};
  return bounds_fault(numbers);
}

}  // namespace

bool is_finer_than_told(const DeviceProfile& profile, const Sensor& sensor) {
  const double step = profile.dynamics[sensed_joint(sensor)].encoder_step;
  return is_flexion(sensor) && step > 0 && step < angle_step(profile, sensor);
}

ProfileFault find_fault(const DeviceProfile& profile) {
  const bool registers = has_registers(profile.transport.kind);
  if (profile.actuators.empty() || profile.actuators.size() > kMaxActuators) {
    return {"actuators", "must be 1 to " + std::to_string(kMaxActuators)};
  }
  for (std::size_t i = 0; i < profile.actuators.size(); ++i) {
    const std::string path = "actuators[" + std::to_string(i) + "]";
    if (ProfileFault fault = actuator_fault(profile.actuators[i], path); !fault.what.empty()) return fault;
    if (!registers) continue;
    if (ProfileFault fault = fields_fault(profile, profile.actuators[i], path); !fault.what.empty())
      return fault;
  }
  if (ProfileFault fault = sensors_fault(profile); !fault.what.empty()) return fault;
  if (ProfileFault fault = dynamics_fault(profile); !fault.what.empty()) return fault;
  if (ProfileFault fault = steps_fault(profile); !fault.what.empty()) return fault;
  if (ProfileFault fault = words_fault(profile); !fault.what.empty()) return fault;
  if (!registers) return times_fault(profile);
  if (ProfileFault fault = overlap_fault(written_fields(profile)); !fault.what.empty()) return fault;
  if (profile.status.dead_man != 0 && !profile.status.present) return {"status", "has no address"};
  return times_fault(profile);
}

}  // namespace lumbrical
