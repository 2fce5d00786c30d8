// Device profiles from JSON files, read through schemas/device.fbs.
#include <optional>
#include <string>
#include <utility>

#include "base/floating_point.h"
#include "base/named.h"
#include "device/profile_check.h"
#include "device_bfbs_generated.h"
#include "device_generated.h"
#include "files/json_file.h"
#include "lumbrical/device_profile.h"

namespace lumbrical {
namespace {

using flatbuffers::uoffset_t;

// What an actuator may rise in where the file does not say: its whole range in this time [s].
constexpr double kDefaultRise = 0.02;
constexpr double kLargest = 1e9;

class ProfileReader {
 public:
  ProfileReader(const JsonFile& file, DeviceProfile& profile) : read_(file), profile_(profile) {}

  Status read(const device_format::Device& table);

 private:
  template <class T, std::size_t N>
  T named(const flatbuffers::String* text, const std::string& path, const Named<T> (&all)[N]);
  int joint(const flatbuffers::String* text, const std::string& path);
  template <class Integer>
  void word(flatbuffers::Optional<std::uint32_t> value, const std::string& path, Integer& target,
            bool needed = false, std::uint32_t most = 65535);
  template <class Table, class Target>
  void place(const Table& table, const std::string& path, Target& target);
  void field(const device_format::Field* table, const std::string& path, RegisterField& target);
  void transport(const device_format::Transport* table);
  void actuator(const device_format::Actuator& table, const std::string& path, Actuator& target);
  void delay(flatbuffers::Optional<double> value, const std::string& path, std::optional<double>& target);
  void arms(const device_format::Actuator& table, const std::string& path, Actuator& target);
  void sensor(const device_format::Sensor& table, const std::string& path, Sensor& target);
  void handshake(const device_format::Device& table);
  void words(const device_format::Device& table);
  void safety(const device_format::Safety* table);
  void dynamics(const device_format::Dynamics& table, const std::string& path, JointDynamics& target);
  void all_dynamics(const device_format::Device& table);
  void coarsen_steps();
  void timing(const device_format::Device& table);

  FieldReader read_;
  DeviceProfile& profile_;
  std::uint8_t unit_ = 1;
};

// Answers the first value where the text is missing.
template <class T, std::size_t N>
T ProfileReader::named(const flatbuffers::String* text, const std::string& path, const Named<T> (&all)[N]) {
  if (text == nullptr) return all[0].value;
  if (const auto value = value_named(all, text->string_view())) return *value;
  std::string choice;
  for (const Named<T>& known : all)
    choice += (choice.empty() ? "\"" : ", \"") + std::string(known.name) + "\"";
  read_.error(path, "must be one of " + choice);
  return all[0].value;
}

int ProfileReader::joint(const flatbuffers::String* text, const std::string& path) {
  const std::optional<int> segment = parse_segment(text_of(text));
  if (segment && *segment < kPhalanxCount) return *segment;
  read_.error(path, R"(must be a finger joint such as "index proximal" or "thumb metacarpal")");
  return 0;
}

template <class Integer>
void ProfileReader::word(flatbuffers::Optional<std::uint32_t> value, const std::string& path, Integer& target,
                         bool needed, std::uint32_t most) {
  if (needed && !value.has_value()) return read_.error(path, "is missing");
  std::uint32_t number = static_cast<std::uint32_t>(target);
  read_.count(value, path, {0, static_cast<double>(most)}, number);
  target = static_cast<Integer>(number);
}

// Where a register is: at the transport's unit, unless it names its own.
template <class Table, class Target>
void ProfileReader::place(const Table& table, const std::string& path, Target& target) {
  target.unit = unit_;
  word(table.unit(), path + ".unit", target.unit, false, 247);
  word(table.address(), path + ".address", target.address, true);
}

void ProfileReader::field(const device_format::Field* table, const std::string& path, RegisterField& target) {
  target.unit = unit_;
  if (table == nullptr && !has_registers(profile_.transport.kind)) return;
  if (table == nullptr) return read_.error(path, "is missing");
  static constexpr Named<RegisterType> kTypes[] = {
      {"s16", RegisterType::s16}, {"u16", RegisterType::u16},         {"s32", RegisterType::s32},
      {"f32", RegisterType::f32}, {"u8 high", RegisterType::u8_high}, {"u8 low", RegisterType::u8_low}};
  static constexpr Named<bool> kWords[] = {{"high first", false}, {"low first", true}};
  place(*table, path, target);
  target.type = named(table->type(), path + ".type", kTypes);
  target.low_word_first = named(table->words(), path + ".words", kWords);
  read_.number(table->scale(), path + ".scale", {-kLargest, kLargest}, target.scale);
  read_.number(table->offset(), path + ".offset", {-kLargest, kLargest}, target.offset);
}

void ProfileReader::transport(const device_format::Transport* table) {
  if (table == nullptr) return;
  Transport& target = profile_.transport;
  static constexpr Named<TransportKind> kKinds[] = {{"tcp", TransportKind::tcp},
                                                    {"rtu", TransportKind::rtu},
                                                    {"udp", TransportKind::udp},
                                                    {"memory", TransportKind::memory}};
  static constexpr Named<bool> kNetworks[] = {{"private", false}, {"any", true}};
  static constexpr Named<Parity> kParities[] = {
      {"none", Parity::none}, {"even", Parity::even}, {"odd", Parity::odd}};
  target.kind = named(table->kind(), "transport.kind", kKinds);
  if (table->host() != nullptr) target.host = table->host()->str();
  if (table->region() != nullptr) target.region = table->region()->str();
  if (table->line() != nullptr) target.line = table->line()->str();
  word(table->port(), "transport.port", target.port);
  target.anywhere = named(table->network(), "transport.network", kNetworks);
  read_.count(table->baud(), "transport.baud", range::baud, target.baud);
  target.parity = named(table->parity(), "transport.parity", kParities);
  std::uint32_t stop_bits = target.stop_bits;
  read_.count(table->stop_bits(), "transport.stop_bits", range::stop_bits, stop_bits);
  target.stop_bits = static_cast<std::uint8_t>(stop_bits);
  word(table->unit(), "transport.unit", unit_, false, 247);
}

void ProfileReader::delay(flatbuffers::Optional<double> value, const std::string& path,
                          std::optional<double>& target) {
  double number = 0;
  read_.number(value, path + ".delay", range::own_delay, number);
  if (value.has_value()) target = number;
}

void ProfileReader::arms(const device_format::Actuator& table, const std::string& path, Actuator& target) {
  const auto* const joints = table.joints();
  for (uoffset_t i = 0; joints != nullptr && i < joints->size(); ++i) {
    const std::string at = path + ".joints[" + std::to_string(i) + "]";
    double& ratio = target.arm[static_cast<std::size_t>(joint(joints->Get(i)->joint(), at + ".joint"))];
    if (ratio != 0) read_.error(at + ".joint", "is named twice");
    ratio = 1;
    read_.number(joints->Get(i)->ratio(), at + ".ratio", {-kLargest, kLargest}, ratio);
    if (ratio == 0) read_.error(at + ".ratio", "must not be 0");
  }
}

void ProfileReader::actuator(const device_format::Actuator& table, const std::string& path,
                             Actuator& target) {
  static constexpr Named<Drive> kDrives[] = {
      {"motor", Drive::motor}, {"wire", Drive::wire}, {"brake", Drive::brake}};
  const Range range{-kLargest, kLargest};
  if (table.name() == nullptr || table.name()->size() == 0) read_.error(path + ".name", "is missing");
  if (table.name() != nullptr) target.name = table.name()->str();
  target.drive = named(table.drive(), path + ".drive", kDrives);
  field(table.at(), path + ".at", target.field);
  read_.number(table.lower(), path + ".lower", range, target.lower);
  if (!table.upper().has_value()) read_.error(path + ".upper", "is missing");
  read_.number(table.upper(), path + ".upper", range, target.upper);
  read_.number(table.safe(), path + ".safe", range, target.safe);
  read_.number(table.preload(), path + ".preload", range, target.preload);
  target.slew = (target.upper - target.lower) / kDefaultRise;
  read_.number(table.slew(), path + ".slew", {1e-9, kLargest}, target.slew);
  delay(table.delay(), path, target.delay);
  arms(table, path, target);
  if (table.local() == nullptr) return;
  target.local.present = true;
  field(table.local()->angle(), path + ".local.angle", target.local.angle);
  field(table.local()->stiffness(), path + ".local.stiffness", target.local.stiffness);
  field(table.local()->radius(), path + ".local.radius", target.local.radius);
}

void ProfileReader::sensor(const device_format::Sensor& table, const std::string& path, Sensor& target) {
  static constexpr Named<bool> kMotions[] = {{"flexion", true}, {"abduction", false}};
  const int segment = joint(table.joint(), path + ".joint");
  const bool flexion = named(table.motion(), path + ".motion", kMotions);
  if (!flexion && segment % 3 != 0)
    read_.error(path + ".motion", "is possible at a finger's first joint only");
  target.angle =
      flexion ? static_cast<int>(flexion_angle(static_cast<std::size_t>(segment))) : 4 * (segment / 3);
  field(table.at(), path + ".at", target.field);
  target.lower = -0.8;
  target.upper = 2.5;
  read_.number(table.lower(), path + ".lower", range::sensed_angle, target.lower);
  read_.number(table.upper(), path + ".upper", range::sensed_angle, target.upper);
  delay(table.delay(), path, target.delay);
}

void ProfileReader::handshake(const device_format::Device& table) {
  const auto* const writes = table.handshake();
  for (uoffset_t i = 0; writes != nullptr && i < writes->size(); ++i) {
    const std::string path = "handshake[" + std::to_string(i) + "]";
    RegisterWrite write;
    place(*writes->Get(i), path, write);
    word(writes->Get(i)->value(), path + ".value", write.value, true);
    profile_.handshake.push_back(write);
  }
  const auto* const checks = table.expected();
  for (uoffset_t i = 0; checks != nullptr && i < checks->size(); ++i) {
    const std::string path = "expected[" + std::to_string(i) + "]";
    RegisterCheck check;
    place(*checks->Get(i), path, check);
    word(checks->Get(i)->mask(), path + ".mask", check.mask);
    word(checks->Get(i)->value(), path + ".value", check.value, true);
    profile_.expected.push_back(check);
  }
}

void ProfileReader::words(const device_format::Device& table) {
  if (const device_format::Control* const control = table.control()) {
    ControlWord& target = profile_.control;
    target.present = true;
    place(*control, "control", target);
    word(control->idle(), "control.idle", target.idle);
    word(control->active(), "control.active", target.active);
  }
  if (const device_format::Heartbeat* const heartbeat = table.heartbeat()) {
    Heartbeat& target = profile_.heartbeat;
    target.present = true;
    target.echoed = heartbeat->echo().has_value();
    place(*heartbeat, "heartbeat", target);
    word(heartbeat->echo(), "heartbeat.echo", target.echo_address);
  }
  if (const device_format::StatusBits* const status = table.status()) {
    StatusBits& target = profile_.status;
    target.present = true;
    place(*status, "status", target);
    word(status->fault(), "status.fault", target.fault);
    word(status->stop(), "status.stop", target.stop);
    word(status->dead_man(), "status.dead_man", target.dead_man);
    word(status->ready(), "status.ready", target.ready);
  }
}

void ProfileReader::safety(const device_format::Safety* table) {
  if (table == nullptr) return;
  SafetyTimes& target = profile_.safety;
  read_.number(table->fade(), "safety.fade", range::device_fade, target.fade);
  read_.number(table->soft_start(), "safety.soft_start", range::soft_start, target.soft_start);
  read_.number(table->tick_hold(), "safety.tick_hold", range::tick_hold, target.tick_hold);
  read_.number(table->tick_timeout(), "safety.tick_timeout", range::tick_timeout, target.tick_timeout);
  read_.number(table->answer_timeout(), "safety.answer_timeout", range::answer_timeout,
               target.answer_timeout);
}

void ProfileReader::dynamics(const device_format::Dynamics& table, const std::string& path,
                             JointDynamics& target) {
  read_.number(table.inertia(), path + ".inertia", range::joint_inertia, target.inertia);
  read_.number(table.damping(), path + ".damping", range::joint_damping, target.damping);
  read_.number(table.friction(), path + ".friction", range::joint_friction, target.friction);
  read_.number(table.encoder_step(), path + ".encoder_step", range::encoder_step, target.encoder_step);
}

void ProfileReader::all_dynamics(const device_format::Device& table) {
  const auto* const all = table.dynamics();
  for (const bool named : {false, true}) {  // what names its joints goes above what doesn't
    for (uoffset_t i = 0; all != nullptr && i < all->size(); ++i) {
      const device_format::Dynamics& entry = *all->Get(i);
      const std::string path = "dynamics[" + std::to_string(i) + "]";
      if ((entry.joints() != nullptr) != named) continue;
      if (!named) {
        JointDynamics every;
        dynamics(entry, path, every);
        profile_.dynamics.fill(every);
      }
      for (uoffset_t k = 0; named && k < entry.joints()->size(); ++k) {
        const std::string at = path + ".joints[" + std::to_string(k) + "]";
        dynamics(entry, path, profile_.dynamics[static_cast<std::size_t>(joint(entry.joints()->Get(k), at))]);
      }
    }
  }
}

// An encoder may be finer than the register that tells of it.
void ProfileReader::coarsen_steps() {
  for (const Sensor& sensor : profile_.sensors) {
    if (is_finer_than_told(profile_, sensor))
      profile_.dynamics[sensed_joint(sensor)].encoder_step = angle_step(profile_, sensor);
  }
}

void ProfileReader::timing(const device_format::Device& table) {
  static constexpr Named<bool> kCommands[] = {{"FC16", false}, {"FC23", true}};
  static constexpr Named<int> kFeedbacks[] = {{"FC3", 3}, {"FC4", 4}};
  profile_.read_write = named(table.command(), "command", kCommands);
  profile_.read_function = named(table.feedback(), "feedback", kFeedbacks);
  static constexpr Named<bool> kUnattended[] = {{"refused", false}, {"accepted", true}};
  profile_.unattended = named(table.unattended(), "unattended", kUnattended);
  read_.number(table.rate(), "rate", range::exchange_rate, profile_.rate);
  read_.number(table.response_timeout(), "response_timeout", range::response_timeout,
               profile_.response_timeout);
  read_.number(table.first_retry(), "first_retry", range::first_retry, profile_.first_retry);
  read_.zero_or_number(table.read_back(), "read_back", range::read_back, profile_.read_back);
  read_.number(table.last_retry(), "last_retry", range::last_retry, profile_.last_retry);
}

Status ProfileReader::read(const device_format::Device& table) {
  if (table.name() == nullptr || table.name()->size() == 0) read_.error("name", "is missing");
  if (table.name() != nullptr) profile_.name = table.name()->str();
  if (table.source() != nullptr) profile_.source = table.source()->str();
  profile_.verified = table.verified();
  static constexpr Named<std::optional<Side>> kSides[] = {
      {"either", std::nullopt}, {"left", Side::left}, {"right", Side::right}};
  profile_.side = named(table.side(), "side", kSides);
  transport(table.transport());
  timing(table);
  for (uoffset_t i = 0; table.actuators() != nullptr && i < table.actuators()->size(); ++i) {
    Actuator target;
    actuator(*table.actuators()->Get(i), "actuators[" + std::to_string(i) + "]", target);
    profile_.actuators.push_back(std::move(target));
  }
  for (uoffset_t i = 0; table.sensors() != nullptr && i < table.sensors()->size(); ++i) {
    Sensor target;
    sensor(*table.sensors()->Get(i), "sensors[" + std::to_string(i) + "]", target);
    profile_.sensors.push_back(target);
  }
  handshake(table);
  words(table);
  safety(table.safety());
  all_dynamics(table);
  if (!read_.ok()) return read_.status();
  coarsen_steps();
  if (const ProfileFault fault = find_fault(profile_); !fault.what.empty()) {
    read_.error(fault.path, fault.what);
  }
  return read_.status();
}

}  // namespace

Status load_device_profile(const std::string& path, DeviceProfile& profile) {
  const FloatingPointGuard guard;
  JsonFile file;
  const std::span schema(device_format::DeviceBinarySchema::data(),
                         device_format::DeviceBinarySchema::size());
  Status status = read_json_file(path, {"device.fbs", schema, "lumbrical.device_format.Device"}, file);
  if (!status.ok()) return status;
  DeviceProfile result;
  status = ProfileReader(file, result).read(*device_format::GetDevice(file.buffer.data()));
  if (status.ok()) profile = std::move(result);
  return status;
}

}  // namespace lumbrical
