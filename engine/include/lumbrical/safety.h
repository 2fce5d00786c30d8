// The safety envelope between forces and a device: a visible state machine and limits that hold whatever
// comes in. A pure function of its inputs: no clock, no input or output, no allocation.
//
// Software limits do not replace hardware safety.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "lumbrical/actuator_model.h"
#include "lumbrical/device_profile.h"

namespace lumbrical {

enum class SafetyState : std::uint8_t {
  disconnected,  ///< no device that answers
  idle,          ///< connected, switched off
  armed,         ///< switched on, output safe: waiting for the dead-man switch and fresh ticks
  active,        ///< forces reach the device
  fault,         ///< output safe until the cause is gone and someone says so
};
std::string_view safety_state_name(SafetyState state);

/// Why the output is, or was, not what the ticks want. Those of kLatchedFaults lead to SafetyState::fault.
enum SafetyFlag : std::uint32_t {
  kStopPressed = 1u << 0,  ///< emergency stop, from either side. Release it, then reset and arm again
  kDeviceFault = 1u << 1,  ///< the device's own fault bits. See its manual
  kTickStopped =
      1u << 2,  ///< no new tick for SafetyTimes::tick_timeout. The loop has died or is far too slow
  kCommandNotFinite = 1u << 3,  ///< NaN or infinity among the commands. A bug in whatever makes them
  kHeartbeatLost = 1u << 4,  ///< the device answers but no longer repeats the heartbeat. Its program has hung
  kAnswerLost = 1u << 5,     ///< nothing acknowledged for SafetyTimes::answer_timeout. Check cable and power
  kTickLate = 1u << 6,       ///< no new tick for SafetyTimes::tick_hold: output fades until one comes
  kDeadManReleased = 1u << 7,  ///< hold the dead-man switch
  kClamped = 1u << 8,          ///< a command lay outside an actuator's limits
  kSlewLimited = 1u << 9,      ///< a command rose faster than the actuator's slew limit
  kSoftStart = 1u << 10,       ///< the output is still growing after arming
  kOtherMaster = 1u << 11,     ///< the device's commands are not those written: someone else drives it, or it
                               ///< has forgotten them. Find out who
  kNotReady = 1u << 12,        ///< the device does not say that it is ready: it takes no forces, or no longer
};
/// "stop pressed", ...; those that are set, separated by ", "
std::string safety_flag_names(std::uint32_t flags);
inline constexpr std::uint32_t kLatchedFaults =
    kStopPressed | kDeviceFault | kTickStopped | kCommandNotFinite | kHeartbeatLost | kOtherMaster;

/// What the outside says in one step. Requests are edges: true once.
struct SafetyInputs {
  double dt = 0.001;         ///< [s] since the last step; anything but 0 .. 1 counts as 0 or 1
  bool connected = false;    ///< handshake done, and the last command was acknowledged in time
  bool device_ready = true;  ///< its status bits allow forces; without it there are none
  bool device_fault = false;
  bool stop = false;     ///< an emergency stop is pressed
  bool dead_man = true;  ///< held, or there is none
  bool heartbeat_lost = false;
  bool other_master = false;  ///< commands read back are not those written
  bool arm = false, disarm = false, reset = false;
  bool continue_after_loss = false;  ///< arm by itself when the link is back, or the device ready again, if
                                     ///< it was armed when that ended
  double tick_age = 0;               ///< [s] since the last new command from the tick thread
  double gap = 0;                    ///< [s] in which nothing could be sent since the last step, beyond dt
  ActuatorArray wanted{};            ///< commands the ticks want
};

/// What survives from one step to the next. Starts disconnected with nothing but safe values (start_safety).
struct SafetyMemory {
  SafetyState state = SafetyState::disconnected;
  std::uint32_t causes = 0;  ///< latched faults that no one has reset yet
  bool arm_again = false;    ///< was armed when the link broke, or the device let go
  double gain = 0;           ///< share of the wanted command, 0 .. 1 (soft start)
  double owed = 0;           ///< by how much the gain has still to fall for a gap
  double settling = 0;       ///< [s] until it may grow again
  double slower = 1;         ///< times the profile's soft start that it takes to grow: see kSlowest
  double off = 0;            ///< [s] since it was active with fresh ticks last
  /// [s] since forces began to be let go of gently, of SafetyTimes::fade; infinite: they are not.
  double letting_go = std::numeric_limits<double>::infinity();
  ActuatorArray output{};  ///< last commands
};

struct SafetyOutput {
  ActuatorArray command{};  ///< what the device may be told now
  bool device_on =
      false;  ///< the control word says active: while armed, active, and until the output is safe
  bool at_safe_values = false;  ///< every command is exactly its safe value
  std::uint32_t flags = 0;      ///< SafetyFlag bits of this step, with the latched ones
};

/// [s] a released hand takes to settle: forces that came back sooner would shake it.
inline constexpr double kSettling = 0.1;
/// Times the soft start that forces take at most to go and to come back where gaps follow each other.
inline constexpr double kSlowest = 8;

SafetyMemory start_safety(const DeviceProfile& profile);
/// From here on what `memory` has as its output is let go of gently, though nothing was active: to fade what
/// another left.
void begin_letting_go(SafetyMemory& memory);

/// One step. Whatever the inputs:
/// - every command is finite and within its actuator's lower .. upper;
/// - away from the safe value none moves faster than the actuator's slew; towards it none faster than slew or
///   the whole range per SafetyTimes::fade, whichever is faster; while ticks are late, by the latter, since
///   most late ticks do come and a force let go for them would be felt as a kick;
/// - unless the state is active, and while ticks are late, all commands move to their safe values and reach
///   them within SafetyTimes::fade: evenly, from what they were, once the dead-man switch is let go of or the
///   device disarmed; for all else as fast as they may, since who lets go then is in doubt or in danger;
/// - what faded while ticks were late, or would have faded in a gap longer than SafetyTimes::tick_hold, comes
///   back by soft start only, kSettling after it is gone, and where the one before was not yet back at half
///   its pace (kSlowest at most); what a gap would have taken goes at the pace at which it comes back;
/// - a device that is not ready is neither armed nor active: it has let go, and what acted would come again
///   in one step;
/// - a latched fault is left only by `reset` with its cause gone, and then only to idle.
SafetyOutput step_safety(const DeviceProfile& profile, const SafetyInputs& inputs, SafetyMemory& memory);

}  // namespace lumbrical
