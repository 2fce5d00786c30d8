// A simulated exoskeleton: joints with inertia, damping, Coulomb friction and encoders, a human hand that
// moves them, and a firmware that speaks a device profile's registers. Deterministic in simulated time.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <utility>

#include "lumbrical/actuator_model.h"
#include "lumbrical/device_profile.h"

namespace lumbrical {

/// A human's hold on one joint: a spring and damper towards an intended angle. Measured fingers: 0.2 to 2
/// N m/rad and 0.004 to 0.04 N m s/rad (Hajian and Howe, 1997).
struct HumanJoint {
  double stiffness = 0.5;  ///< [N m/rad]
  double damping = 0.01;   ///< [N m s/rad]
};

struct JointState {
  double angle = 0;  ///< [rad] closing
  double speed = 0;  ///< [rad/s]
};

/// Moves a joint by `dt` [s] under the device's opening torque [N m] and the human's hold towards `target`
/// [rad]. Implicit in springs, damping and friction: stable at any step, and friction stops the joint dead.
/// Returns the opening torque [N m] that friction made meanwhile.
double step_joint(const JointDynamics& dynamics, const HumanJoint& human, double target, double torque,
                  double dt, JointState& joint);

/// The angle as an encoder with steps reports it.
double read_encoder(const JointDynamics& dynamics, double angle);

struct SimulationOptions {
  HumanJoint human;
  double step = 1e-4;     ///< [s] of the mechanics and of the firmware's own loop
  double watchdog = 0.1;  ///< [s] without a command, or with a heartbeat that stands still: torques fade
  double fade = 0.05;     ///< [s]
  /// What the human intends: closing angles [rad] at `time` [s] since the device was first switched on.
  /// Empty: opens and closes the hand slowly.
  std::function<void(double time, JointArray& target)> intention;
};

/// What the wearer of a simulated device goes through, look by look.
struct WornDevice {
  /// Turning points of a joint: one that turns round by more than kShake sooner than kShakeTime after the
  /// last time makes no intended motion.
  struct Turns {
    double extreme = 0, reached = 0, turned = -1;
    int sense = 1;
    std::uint64_t shakes = 0;
  };
  std::array<Turns, kPhalanxCount> turns{};
  JointArray angle{}, torque{}, peak{};  ///< [rad], [N m], [N m] the last ones and the largest torque
  double time = 0;                       ///< [s] of the last look
  double largest_change = 0;             ///< [N m] of a torque between two looks, at most a few ms apart
  double taken = 0;                      ///< [J] by the actuators from the joints: negative means they gave
  /// [J] per finger: what the device has taken in this touch, its damping and friction too. What is left when
  /// the touch ends is gone; what was given too much stays.
  std::array<double, kFingerCount> balance{};
  double given = 0;  ///< [J] into the hand: the largest sum ever of what fingers were given too much
  bool started = false;
};
inline constexpr double kShake = 0.002, kShakeTime = 0.1;  ///< [rad], [s]

[[nodiscard]] std::uint64_t shakes_of(const WornDevice& worn);

/// What the sensors say in the place of the truth: always the same; at times an angle 1 rad away; one that no
/// joint has.
enum class SensorFault : std::uint8_t { none, stuck, jumping, out_of_range };

/// As of a real device, its joints have stops, which lie where the ranges of their sensors end.
class SimulatedDevice {
 public:
  SimulatedDevice(const DeviceProfile& profile, SimulationOptions options);

  /// Lets simulated time pass [s]; whole steps are made, the rest is kept.
  void advance(double seconds);

  /// Registers by unit and address. Answers 0, or Modbus' exception code 2 (illegal data address) with
  /// nothing read or written. Where the profile's feedback is FC4 it lies in input registers, which have
  /// addresses of their own; else `read` and `read_inputs` are the same.
  int write(std::uint8_t unit, std::uint16_t address, std::span<const std::uint16_t> words);
  int read(std::uint8_t unit, std::uint16_t address, std::span<std::uint16_t> words) const;
  int read_inputs(std::uint8_t unit, std::uint16_t address, std::span<std::uint16_t> words) const;
  [[nodiscard]] bool has_unit(std::uint8_t unit) const;
  [[nodiscard]] bool is_command(std::uint8_t unit, std::uint16_t address) const;  ///< written in every cycle

  void press_stop(bool pressed) { stop_ = pressed; }
  void hold_dead_man(bool held) { dead_man_ = held; }
  void break_down(bool broken) { broken_ = broken; }  ///< its fault bits
  void break_sensors(SensorFault fault) { sensor_fault_ = fault; }
  void hang(bool hung) { hung_ = hung; }  ///< answers, but its program stands still

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] const DeviceProfile& profile() const { return profile_; }
  [[nodiscard]] const std::array<JointState, kPhalanxCount>& joints() const { return joints_; }
  [[nodiscard]] const JointArray& torque() const { return torque_; }       ///< [N m] opening, acting now
  [[nodiscard]] const ActuatorArray& command() const { return command_; }  ///< acting now, in commands' units
  [[nodiscard]] bool switched_on() const;

 private:
  using Place = std::pair<std::uint8_t, std::uint16_t>;
  using Registers = std::map<Place, std::uint16_t>;
  Registers& feedback() { return profile_.read_function == 4 ? inputs_ : registers_; }
  void step(double dt);
  void stop_at_ends(std::size_t joint);
  void read_commands();
  void write_feedback();
  double field(const RegisterField& place) const;
  void put(const RegisterField& place, double value);

  DeviceProfile profile_;
  SimulationOptions options_;
  Registers registers_, inputs_;
  std::array<JointState, kPhalanxCount> joints_{};
  JointArray lowest_{}, highest_{};  // [rad] where joints meet their stops
  JointArray torque_{}, braked_{};   // braked_: what brakes take at most, whichever way
  ActuatorArray command_{};
  double time_ = 0, left_ = 0, silence_ = 1e9, on_since_ = -1;
  std::uint16_t last_heartbeat_ = 0;
  SensorFault sensor_fault_ = SensorFault::none;
  bool stop_ = false, dead_man_ = true, broken_ = false, hung_ = false;
};

void look(const SimulatedDevice& device, WornDevice& worn);

}  // namespace lumbrical
