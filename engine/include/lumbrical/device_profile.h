// Device profiles: what a haptic device can do, where its registers are, and how far it may go. Read from
// JSON (schemas/device.fbs says which fields there are).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lumbrical/hand.h"
#include "lumbrical/status.h"

namespace lumbrical {

/// Most actuators of a profile: what the loop carries of them lives in arrays of that size.
inline constexpr int kMaxActuators = 32;

/// The joints a device may load: those at the base of each phalanx, in the order of the segments.
using JointArray = std::array<double, kPhalanxCount>;

enum class RegisterType : std::uint8_t {
  u16,
  s16,
  u8_high,  ///< the upper byte of a register; the lower may belong to another field
  u8_low,
  s32,  ///< two registers
  f32,  ///< two registers, IEEE 754
};

/// A number in a device's registers: value = raw * scale + offset.
struct RegisterField {
  std::uint8_t unit = 1;      ///< Modbus unit (slave) id
  std::uint16_t address = 0;  ///< 0-based, of the first register
  RegisterType type = RegisterType::s16;
  bool low_word_first = false;  ///< of the two registers of s32 and f32
  double scale = 1;             ///< units per count, not 0
  double offset = 0;            ///< units at raw 0
};

/// Registers of type u8 share one; all others have theirs alone.
int register_count(RegisterType type);

/// What an actuator can do to the joints it is tied to.
enum class Drive : std::uint8_t {
  motor,  ///< anything between lower and upper
  wire,   ///< pulls only: between its preload and upper while the device is active
  brake,  ///< resists motion only
};

/// What the device needs to close a fast loop of its own round a joint (local_model.h): three more numbers.
struct LocalFields {
  bool present = false;
  RegisterField angle;      ///< [rad] where `command` holds exactly; at least what its sensor may say
  RegisterField stiffness;  ///< [N m/rad] by which the torque grows as the joint closes
  RegisterField radius;     ///< [rad] how far from `angle` it may be trusted
};

/// One number the device is told. Its unit is the device's (N, N m, a share ...): `arm` translates.
struct Actuator {
  std::string name;
  Drive drive = Drive::motor;
  RegisterField field;
  double lower = 0, upper = 0;  ///< never exceeded
  double safe = 0;              ///< written whenever the device is not active; within lower .. upper
  double preload = 0;           ///< of a wire: least tension while active
  double slew = 0;              ///< largest rise away from `safe` [unit/s], > 0
  JointArray arm{};             ///< [N m per unit] opening torque about each joint; 0: not tied to it
  LocalFields local;
  std::optional<double> delay;  ///< [s] from the command to its torque, beyond the bus, 0 .. 1; not known
};

/// One joint angle the device reports.
struct Sensor {
  int angle = 0;  ///< in the order of hand.h
  RegisterField field;
  double lower = 0, upper = 0;  ///< [rad] anything outside is not believed
  /// [s] By how much its angles are older than the device's answer, at most, 0 .. 1; not known.
  std::optional<double> delay;
};

struct RegisterWrite {
  std::uint8_t unit = 1;
  std::uint16_t address = 0, value = 0;
};

/// A register must hold `value` in the bits of `mask` before the device counts as ready.
struct RegisterCheck {
  std::uint8_t unit = 1;
  std::uint16_t address = 0, mask = 0xFFFF, value = 0;
};

/// A register by which the device is switched on and off; written with every command.
struct ControlWord {
  bool present = false;
  std::uint8_t unit = 1;
  std::uint16_t address = 0;
  std::uint16_t idle = 0, active = 1;
};

/// A counter written with every command, and what the device echoes of it.
struct Heartbeat {
  bool present = false, echoed = false;
  std::uint8_t unit = 1;
  std::uint16_t address = 0;
  std::uint16_t echo_address = 0;  ///< in the feedback registers of the same unit
};

struct StatusBits {
  bool present = false;
  std::uint8_t unit = 1;
  std::uint16_t address = 0;
  std::uint16_t fault = 0;     ///< any of these set: fault
  std::uint16_t stop = 0;      ///< any of these set: emergency stop
  std::uint16_t dead_man = 0;  ///< set while the operator holds the dead-man switch; 0: there is none
  std::uint16_t ready = 0;     ///< all of these must be set before the device may be armed
};

enum class Parity : char { none = 'N', even = 'E', odd = 'O' };

enum class TransportKind : std::uint8_t {
  tcp,     ///< Modbus
  rtu,     ///< Modbus on a serial line
  udp,     ///< datagrams (datagram_wire.h)
  memory,  ///< shared with another process (shared_memory_wire.h)
};
/// Whether numbers cross as the registers of a profile; else as they are, in its units.
constexpr bool has_registers(TransportKind kind) {
  return kind == TransportKind::tcp || kind == TransportKind::rtu;
}

struct Transport {
  TransportKind kind = TransportKind::tcp;
  std::string host = "127.0.0.1";
  std::uint16_t port = 502;
  bool anywhere = false;  ///< may lie outside loopback and private networks, of udp outside this machine
  std::string region;     ///< of shared memory, "/name"
  std::string line;       ///< "/dev/ttyUSB0"
  std::uint32_t baud = 115200;
  Parity parity = Parity::none;
  std::uint8_t stop_bits = 1;
};

/// Times of the safety envelope [s].
struct SafetyTimes {
  double fade = 0.05;         ///< from any output to safe values, 0.001 .. 1
  double soft_start = 0.5;    ///< from zero to full output after arming, 0 .. 60
  double tick_hold = 0.005;   ///< no new tick for longer: the output fades, 0.0001 .. 1, tick_timeout at most
  double tick_timeout = 0.1;  ///< no new tick for longer: fault, 0.001 .. 10
  /// The newest command acknowledged was sent longer ago: disconnected. No longer than the device's own
  /// watchdog holds a force, 0.001 .. 10.
  double answer_timeout = 0.1;
};

/// What one joint of the device is like: decides how stiff it may be rendered.
struct JointDynamics {
  double inertia = 0;   ///< [kg m^2] about the joint, of device and finger, 0 .. 1
  double damping = 0;   ///< [N m s/rad] 0 .. 1e3
  double friction = 0;  ///< [N m] Coulomb, 0 .. 1e3
  double encoder_step =
      0;  ///< [rad] up to 1; 0: not known; else no finer than a count of the register (angle_step)
};

struct DeviceProfile {
  std::string name;
  std::string source;        ///< where the register map comes from
  bool verified = false;     ///< on hardware
  std::optional<Side> side;  ///< the hand it drives, and no other; none: either
  Transport transport;
  double rate =
      100;  ///< [Hz] largest number of exchanges per second, above 1 / answer_timeout, at most 20000
  double response_timeout = 0.05;  ///< [s] for the answer to one request, 0.001 .. answer_timeout
  /// [s] Pause before reconnecting, which doubles from one to the other, 0.001 .. 60 and .. 600.
  double first_retry = 0.1, last_retry = 2;
  double read_back = 0.1;   ///< [s] between looks at whether commands are ours, 0.01 .. 10; 0: none
  bool read_write = false;  ///< FC23 in the place of FC16 and a read, where both are one block of one unit
  int read_function = 3;    ///< 3 holding registers or 4 input registers
  std::vector<Actuator> actuators;
  std::vector<Sensor> sensors;
  /// Forces although there is no heartbeat by which the device would notice that no one drives it any more.
  bool unattended = false;
  std::vector<RegisterWrite> handshake;  ///< written once after connecting, in this order
  std::vector<RegisterCheck> expected;   ///< then read until they hold
  ControlWord control;
  Heartbeat heartbeat;
  StatusBits status;
  SafetyTimes safety;
  std::array<JointDynamics, kPhalanxCount> dynamics{};
};

/// One Modbus request of a cycle.
struct RegisterBlock {
  std::uint8_t unit = 1;
  std::uint16_t address = 0;
  std::uint16_t count = 0;
  friend bool operator==(const RegisterBlock&, const RegisterBlock&) = default;
};

inline constexpr int kMaxWriteRegisters = 123;     ///< FC16
inline constexpr int kMaxExchangeRegisters = 121;  ///< written by FC23
inline constexpr int kMaxReadRegisters = 125;      ///< FC3, FC4

/// What one cycle writes and reads. Written blocks have no gaps: a register no one named is never written.
/// That of the heartbeat is the last one: it says that all others were taken.
/// Read blocks may span up to 16 registers that no one asked for.
struct ExchangePlan {
  std::vector<RegisterBlock> writes, reads;
  bool combined = false;  ///< one write and one read in one FC23
};
ExchangePlan plan_exchange(const DeviceProfile& profile);

/// What a profile calls the registers of a block, for messages: "control to little distal (registers 0 to 16
/// of unit 1)".
std::string name_registers(const DeviceProfile& profile, const RegisterBlock& block);

/// Whether the parts of a profile agree: limits that its registers can't hold, fields that overlap, a safe
/// value outside the limits, more registers than Modbus allows. Names the field by its path in the file.
Status check_profile(const DeviceProfile& profile);

/// [s] From a joint's angle to its torque, of the device's own, beyond what the bus takes: the largest delays
/// of its sensor and of what drives it, 0 where the profile doesn't say.
double own_delay(const DeviceProfile& profile, std::size_t joint);
/// Whether it says all of them.
bool knows_own_delays(const DeviceProfile& profile);

/// Whether a device may be given forces by it: it notices the end of whoever drives it, or that was accepted.
Status check_attended(const DeviceProfile& profile);

/// [rad] By how much a sensor's angle changes at least, as its register has it; 0: of one without a register.
double angle_step(const DeviceProfile& profile, const Sensor& sensor);

/// Whether a sensor looks at a flexion; nothing drives abductions.
constexpr bool is_flexion(const Sensor& sensor) { return sensor.angle % 4 != 0; }

/// The joint a sensor looks at, in the order of DeviceProfile::dynamics.
constexpr std::size_t sensed_joint(const Sensor& sensor) {
  const auto finger = static_cast<std::size_t>(sensor.angle / 4),
             motion = static_cast<std::size_t>(sensor.angle % 4);
  return 3 * finger + (motion == 0 ? 0 : motion - 1);
}

/// Where the flexion of a joint stands among the angles of a frame (hand.h); the joint as above.
constexpr std::size_t flexion_angle(std::size_t joint) { return 4 * (joint / 3) + 1 + joint % 3; }

/// The joint that an actuator of one joint moves, of others the first one; kPhalanxCount: none.
constexpr std::size_t driven_joint(const Actuator& actuator) {
  std::size_t joint = 0;
  while (joint < actuator.arm.size() && actuator.arm[joint] == 0) ++joint;
  return joint;
}

/// Makes every register of the profile one of the given unit (slave) id.
void set_unit(DeviceProfile& profile, std::uint8_t unit);

/// Reads a profile. Messages name file, line and column; on error `profile` is unchanged.
Status load_device_profile(const std::string& path, DeviceProfile& profile);

}  // namespace lumbrical
