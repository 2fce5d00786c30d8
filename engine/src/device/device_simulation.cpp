// See lumbrical/device_simulation.h.
#include "lumbrical/device_simulation.h"

#include <algorithm>
#include <cmath>

#include "device/registers.h"
#include "lumbrical/local_model.h"
#include "lumbrical/math.h"

namespace lumbrical {
namespace {

constexpr double kJump = 1, kNoAngle = 3;  // [rad] of broken sensors
constexpr double kSlowGrasp = 4;           // [s] to close and open the hand

// 0 .. 1 .. 0 with a continuous speed.
double there_and_back(double phase) {
  const double x = phase - std::floor(phase);
  const double up = x < 0.5 ? 2 * x : 2 - 2 * x;
  return up * up * (3 - 2 * up);
}

void slow_grasp(double time, JointArray& target) {
  target.fill(0.1 + 0.9 * there_and_back(time / kSlowGrasp));
}

void turn(double time, double angle, WornDevice::Turns& turns) {
  if (turns.sense * (angle - turns.extreme) >= 0) {
    turns.extreme = angle;
    turns.reached = time;
  } else if (turns.sense * (turns.extreme - angle) > kShake) {
    turns.shakes += turns.turned >= 0 && turns.reached - turns.turned < kShakeTime ? 1 : 0;
    turns.turned = turns.reached;
    turns.extreme = angle;
    turns.reached = time;
    turns.sense = -turns.sense;
  }
}

using Registers = std::map<std::pair<std::uint8_t, std::uint16_t>, std::uint16_t>;

bool holds_unit(const Registers& registers, std::uint8_t unit) {
  const auto first = registers.lower_bound({unit, 0});
  return first != registers.end() && first->first.first == unit;
}

int read_words(const Registers& registers, std::uint8_t unit, std::uint16_t address,
               std::span<std::uint16_t> words) {
  for (std::size_t k = 0; k < words.size(); ++k) {
    const auto found = address + k > 65535 ? registers.end()
                                           : registers.find({unit, static_cast<std::uint16_t>(address + k)});
    if (found == registers.end()) return 2;
    words[k] = found->second;
  }
  return 0;
}

}  // namespace

double step_joint(const JointDynamics& dynamics, const HumanJoint& human, double target, double torque,
                  double dt, JointState& joint) {
  const double damping = dynamics.damping + human.damping;
  const double mass = dynamics.inertia + dt * damping + dt * dt * human.stiffness;
  const double push = human.stiffness * (target - joint.angle) - torque;
  const double free = (dynamics.inertia * joint.speed + dt * push) / mass;
  const double friction = dt * dynamics.friction / mass;
  joint.speed = free > friction ? free - friction : free < -friction ? free + friction : 0;
  joint.angle += dt * joint.speed;
  return mass * (free - joint.speed) / dt;
}

double read_encoder(const JointDynamics& dynamics, double angle) {
  if (!(dynamics.encoder_step > 0)) return angle;
  return dynamics.encoder_step * std::floor(angle / dynamics.encoder_step + 0.5);
}

std::uint64_t shakes_of(const WornDevice& worn) {
  std::uint64_t count = 0;
  for (const WornDevice::Turns& turns : worn.turns) count += turns.shakes;
  return count;
}

void look(const SimulatedDevice& device, WornDevice& worn) {
  const double passed = device.time() - std::exchange(worn.time, device.time());
  std::array<bool, kFingerCount> touching{};
  for (std::size_t j = 0; j < kPhalanxCount; ++j) {
    const double torque = device.torque()[j], at = device.joints()[j].angle;
    const double mean = 0.5 * (torque + worn.torque[j]), moved = at - worn.angle[j];
    turn(worn.time, at, worn.turns[j]);
    worn.peak[j] = max(worn.peak[j], std::fabs(torque));
    if (worn.started && passed > 0) {
      const JointDynamics& joint = device.profile().dynamics[j];
      worn.largest_change = max(worn.largest_change, std::fabs(torque - worn.torque[j]));
      worn.taken += mean * moved;
      worn.balance[j / 3] +=
          mean * moved + joint.damping * moved * moved / passed + joint.friction * std::fabs(moved);
    }
    touching[j / 3] = touching[j / 3] || mean != 0;
    worn.torque[j] = torque;
    worn.angle[j] = at;
  }
  double given = 0;
  for (std::size_t f = 0; f < kFingerCount; ++f) {
    if (!touching[f]) worn.balance[f] = min(0, worn.balance[f]);
    given -= min(0, worn.balance[f]);
  }
  worn.given = max(worn.given, given);
  worn.started = true;
}

SimulatedDevice::SimulatedDevice(const DeviceProfile& profile, SimulationOptions options)
    : profile_(profile), options_(std::move(options)) {
  if (!options_.intention) options_.intention = slow_grasp;
  const ExchangePlan plan = plan_exchange(profile_);
  for (const auto& [blocks, registers] :
       {std::pair(&plan.writes, &registers_), std::pair(&plan.reads, &feedback())}) {
    for (const RegisterBlock& block : *blocks) {
      for (int k = 0; k < block.count; ++k)
        (*registers)[{block.unit, static_cast<std::uint16_t>(block.address + k)}] = 0;
    }
  }
  for (const RegisterWrite& write : profile_.handshake) registers_[{write.unit, write.address}] = 0;
  for (const RegisterCheck& check : profile_.expected) feedback()[{check.unit, check.address}] |= check.value;
  for (JointDynamics& joint : profile_.dynamics) joint.inertia = std::max(joint.inertia, 1e-6);
  for (std::size_t i = 0; i < profile_.actuators.size(); ++i) command_[i] = profile_.actuators[i].safe;
  lowest_.fill(-1e9);
  highest_.fill(1e9);
  for (const Sensor& sensor : profile_.sensors) {
    if (!is_flexion(sensor)) continue;
    const std::size_t j = sensed_joint(sensor);
    const double rounded = 0.5 * profile_.dynamics[j].encoder_step;
    lowest_[j] = sensor.lower + rounded;
    highest_[j] = sensor.upper - rounded;
  }
  JointArray start{};
  options_.intention(0, start);
  for (std::size_t j = 0; j < kPhalanxCount; ++j) joints_[j].angle = start[j];
  write_feedback();
}

bool SimulatedDevice::has_unit(std::uint8_t unit) const {
  return holds_unit(registers_, unit) || holds_unit(inputs_, unit);
}

bool SimulatedDevice::is_command(std::uint8_t unit, std::uint16_t address) const {
  return find_register(plan_exchange(profile_).writes, unit, address) >= 0;
}

bool SimulatedDevice::switched_on() const {
  if (!profile_.control.present) return true;
  return registers_.at({profile_.control.unit, profile_.control.address}) == profile_.control.active;
}

double SimulatedDevice::field(const RegisterField& place) const {
  std::array<std::uint16_t, 2> words{};
  for (int k = 0; k < register_count(place.type); ++k) {
    words[static_cast<std::size_t>(k)] =
        registers_.at({place.unit, static_cast<std::uint16_t>(place.address + k)});
  }
  return decode_field(place, words);
}

void SimulatedDevice::put(const RegisterField& place, double value) {
  std::array<std::uint16_t, 2> words{};
  const auto at = [&](int k) -> std::uint16_t& {
    return feedback()[{place.unit, static_cast<std::uint16_t>(place.address + k)}];
  };
  const int count = register_count(place.type);
  for (int k = 0; k < count; ++k) words[static_cast<std::size_t>(k)] = at(k);
  if (!encode_field(place, value, words)) return;
  for (int k = 0; k < count; ++k) at(k) = words[static_cast<std::size_t>(k)];
}

int SimulatedDevice::write(std::uint8_t unit, std::uint16_t address, std::span<const std::uint16_t> words) {
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (address + k > 65535 || !registers_.contains({unit, static_cast<std::uint16_t>(address + k)}))
      return 2;
  }
  for (std::size_t k = 0; k < words.size(); ++k) {
    registers_[{unit, static_cast<std::uint16_t>(address + k)}] = words[k];
  }
  const Heartbeat& heartbeat = profile_.heartbeat;
  if (hung_) return 0;
  if (!heartbeat.present) {
    silence_ = 0;
  } else if (const std::uint16_t now = registers_[{heartbeat.unit, heartbeat.address}];
             now != last_heartbeat_) {
    last_heartbeat_ = now;
    silence_ = 0;
  }
  write_feedback();
  return 0;
}

int SimulatedDevice::read(std::uint8_t unit, std::uint16_t address, std::span<std::uint16_t> words) const {
  return read_words(registers_, unit, address, words);
}

int SimulatedDevice::read_inputs(std::uint8_t unit, std::uint16_t address,
                                 std::span<std::uint16_t> words) const {
  return read_words(profile_.read_function == 4 ? inputs_ : registers_, unit, address, words);
}

// What acts now: the newest command while someone sends them, fading when no one does. Brakes are friction.
void SimulatedDevice::read_commands() {
  const bool off = !switched_on() || stop_ || broken_;
  torque_ = braked_ = {};
  for (std::size_t i = 0; i < profile_.actuators.size(); ++i) {
    const Actuator& actuator = profile_.actuators[i];
    double wanted = off ? actuator.safe : clamp(field(actuator.field), actuator.lower, actuator.upper);
    const double range = actuator.upper - actuator.lower;
    if (actuator.local.present && !off) {
      const std::size_t joint = driven_joint(actuator);
      const double arm = actuator.arm[joint];
      const lumbrical_local_model model = {wanted * arm, field(actuator.local.angle),
                                           field(actuator.local.stiffness), field(actuator.local.radius)};
      const lumbrical_local_limits limits = {
          max(std::fabs(actuator.lower), std::fabs(actuator.upper)) * std::fabs(arm),
          2 * profile_.dynamics[joint].damping / options_.step, options_.watchdog, options_.fade};
      const double angle = read_encoder(profile_.dynamics[joint], joints_[joint].angle);
      wanted = lumbrical_local_torque(&model, &limits, angle, silence_) / arm;
    }
    if (!(silence_ <= options_.watchdog)) wanted = actuator.safe;
    const double most = off || silence_ > options_.watchdog ? range / options_.fade * options_.step : range;
    command_[i] += clamp(wanted - command_[i], -most, most);
    for (std::size_t j = 0; j < kPhalanxCount; ++j) {
      if (actuator.drive == Drive::brake) {
        braked_[j] += std::fabs(actuator.arm[j] * command_[i]);
      } else {
        torque_[j] += actuator.arm[j] * command_[i];
      }
    }
  }
}

void SimulatedDevice::write_feedback() {
  if (hung_) return;
  const bool jumps = sensor_fault_ == SensorFault::jumping && std::fmod(time_, 0.2) < 0.005;
  for (const Sensor& sensor : profile_.sensors) {
    if (sensor_fault_ == SensorFault::stuck) break;
    const std::size_t joint = sensed_joint(sensor);
    const double angle =
        is_flexion(sensor) ? read_encoder(profile_.dynamics[joint], joints_[joint].angle) : 0;
    const bool nowhere = sensor_fault_ == SensorFault::out_of_range;
    put(sensor.field, nowhere ? kNoAngle : angle + (jumps ? kJump : 0));
  }
  const Heartbeat& heartbeat = profile_.heartbeat;
  if (heartbeat.echoed) feedback()[{heartbeat.unit, heartbeat.echo_address}] = last_heartbeat_;
  const StatusBits& status = profile_.status;
  if (!status.present) return;
  unsigned bits = status.ready;
  if (broken_) bits |= status.fault;
  if (stop_) bits |= status.stop;
  if (dead_man_) bits |= status.dead_man;
  feedback()[{status.unit, status.address}] = static_cast<std::uint16_t>(bits);
}

void SimulatedDevice::stop_at_ends(std::size_t joint) {
  JointState& state = joints_[joint];
  const double inside = clamp(state.angle, lowest_[joint], highest_[joint]);
  if (inside != state.angle) state = {inside, 0};
}

void SimulatedDevice::step(double dt) {
  time_ += dt;
  silence_ += dt;
  if (on_since_ < 0 && switched_on()) on_since_ = time_;
  JointArray target{};
  options_.intention(on_since_ < 0 ? 0 : time_ - on_since_, target);
  read_commands();
  for (std::size_t j = 0; j < kPhalanxCount; ++j) {
    JointDynamics dynamics = profile_.dynamics[j];
    dynamics.friction += braked_[j];
    const double rubbed = step_joint(dynamics, options_.human, target[j], torque_[j], dt, joints_[j]);
    if (braked_[j] > 0) torque_[j] += braked_[j] / dynamics.friction * rubbed;
    stop_at_ends(j);
  }
}

void SimulatedDevice::advance(double seconds) {
  left_ += seconds;
  if (left_ < options_.step) return;
  while (left_ >= options_.step) {
    step(options_.step);
    left_ -= options_.step;
  }
  write_feedback();
}

}  // namespace lumbrical
