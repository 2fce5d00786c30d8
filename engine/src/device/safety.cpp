// See lumbrical/safety.h.
#include "lumbrical/safety.h"

#include <cmath>
#include <iterator>
#include <limits>
#include <string>

#include "base/set_bits.h"
#include "lumbrical/math.h"

namespace lumbrical {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

bool is_on(SafetyState state) { return state == SafetyState::armed || state == SafetyState::active; }

std::uint32_t causes_now(const DeviceProfile& profile, const SafetyInputs& inputs,
                         const SafetyMemory& memory) {
  std::uint32_t causes = 0;
  if (inputs.stop) causes |= kStopPressed;
  // A device that does not answer says nothing about itself.
  if (inputs.connected && inputs.device_fault) causes |= kDeviceFault;
  if (inputs.connected && inputs.heartbeat_lost) causes |= kHeartbeatLost;
  if (inputs.connected && inputs.other_master) causes |= kOtherMaster;
  if (is_on(memory.state) && !(inputs.tick_age <= profile.safety.tick_timeout)) causes |= kTickStopped;
  for (std::size_t i = 0; i < profile.actuators.size(); ++i) {
    if (!is_finite(inputs.wanted[i])) causes |= kCommandNotFinite;
  }
  return causes;
}

bool ticks_fresh(const DeviceProfile& profile, const SafetyInputs& inputs) {
  return inputs.tick_age <= profile.safety.tick_hold;  // false for NaN
}

SafetyState next_state(const DeviceProfile& profile, const SafetyInputs& inputs, std::uint32_t causes,
                       SafetyMemory& memory) {
  if (memory.causes != 0) {
    const bool gone = (causes & kLatchedFaults) == 0;
    if (!(inputs.reset && gone)) return SafetyState::fault;
    memory.causes = 0;
    memory.arm_again = false;
    return inputs.connected ? SafetyState::idle : SafetyState::disconnected;
  }
  if (!inputs.connected) {
    memory.arm_again =
        inputs.continue_after_loss && !inputs.disarm && (memory.arm_again || is_on(memory.state));
    return SafetyState::disconnected;
  }
  if (inputs.disarm) {
    memory.arm_again = false;
    return SafetyState::idle;
  }
  if (is_on(memory.state) && !inputs.device_ready) {
    memory.arm_again = inputs.continue_after_loss;
    return SafetyState::idle;
  }
  switch (memory.state) {
    case SafetyState::disconnected:
    case SafetyState::fault:
      return SafetyState::idle;
    case SafetyState::idle: {
      const bool wanted = inputs.arm || memory.arm_again;
      if (!wanted || !inputs.device_ready) return SafetyState::idle;
      memory.arm_again = false;
      return SafetyState::armed;
    }
    case SafetyState::armed:
      return inputs.dead_man && ticks_fresh(profile, inputs) ? SafetyState::active : SafetyState::armed;
    case SafetyState::active:
      return inputs.dead_man ? SafetyState::active : SafetyState::armed;
  }
  return SafetyState::fault;
}

// Towards the safe value the output may move fast, away from it only as fast as the actuator's slew; a step
// across the safe value is both, one after the other. `gently`: towards it only as fast as `fade` asks for.
double limit_slew(const Actuator& actuator, double fade, bool gently, double dt, double now, double target) {
  const double rise = actuator.slew * dt, least = (actuator.upper - actuator.lower) / fade;
  const double fall = (gently ? least : max(actuator.slew, least)) * dt;
  const double from = now - actuator.safe, to = target - actuator.safe;
  const bool same_side = from * to > 0;
  if (same_side && std::fabs(to) <= std::fabs(from)) {
    return std::fabs(from - to) <= fall ? target : actuator.safe + (from > 0 ? from - fall : from + fall);
  }
  if (!same_side && std::fabs(from) > 0) {  // first back to safe; what is left of the step rises from there
    if (std::fabs(from) >= fall) return actuator.safe + (from > 0 ? from - fall : from + fall);
    const double left = rise * (1 - std::fabs(from) / fall);
    return actuator.safe + clamp(to, -left, left);
  }
  return actuator.safe + clamp(to, from - rise, from + rise);
}

// What fades while nothing comes, or would have faded while nothing could be sent, comes back by soft start
// only. What a gap would have taken is taken after it and as softly: a force let go of quickly, or given back
// before the hand has settled, is a kick. Where gaps come again before all is back, each takes twice as long
// as the one before, to go and to come back: a force that comes and goes with the bus is a shake, however
// soft.
void step_gain(const SafetyTimes& times, bool late, double gap, double dt, SafetyMemory& memory) {
  const bool silent = gap > times.tick_hold;
  const bool begins = (silent || late) && memory.settling == 0;
  if (begins) memory.slower = memory.gain < 1 ? min(2 * memory.slower, kSlowest) : 1;
  if (silent) memory.owed = min(memory.gain, memory.owed + gap / times.fade);
  const double soft = (times.soft_start > 0 ? dt / times.soft_start : 1) / memory.slower;
  const double fall = late ? dt / times.fade : min(memory.owed, soft);
  memory.owed = max(0, memory.owed - fall);
  memory.settling = silent || fall > 0 ? kSettling : max(0, memory.settling - dt);
  memory.gain = clamp(memory.gain - fall + (memory.settling > 0 ? 0 : soft), 0, 1);
}

// Whoever lets go of the switch, disarms or closes is in no danger, and a force that is gone in 3 ms is a
// kick. A link that was lost has others at its end than before, perhaps, and drives that are not ready have
// let go.
void note_letting_go(SafetyState before, const SafetyInputs& inputs, SafetyMemory& memory) {
  const bool was_on = is_on(before), disarmed = memory.state == SafetyState::idle && inputs.disarm;
  const bool released = memory.state == SafetyState::armed || (disarmed && inputs.device_ready);
  if (before == SafetyState::active && released) {
    memory.letting_go = memory.off;  // for late ticks forces have begun to fade before
  } else if (memory.state == SafetyState::fault || (was_on && !is_on(memory.state) && !released)) {
    memory.letting_go = kNever;
  }
}

// `target`, but on the way to the safe value, and across it, no further than letting go evenly asks for.
double let_go_gently(double safe, double now, double target, double share) {
  const double from = now - safe, to = target - safe;
  const bool farther = from * to >= 0 && std::fabs(to) >= share * std::fabs(from);
  return farther ? target : safe + share * from;
}

}  // namespace

std::string safety_flag_names(std::uint32_t flags) {
  constexpr const char* kNames[] = {
      "stop pressed",    "device fault", "tick stopped", "command not finite",
      "heartbeat lost",  "answer lost",  "tick late",    "dead-man switch released",
      "command clamped", "slew limited", "soft start",   "another master",
      "not ready"};
  std::string names;
  for (std::size_t bit = 0; bit < 32; ++bit) {
    if (!has_bit(flags, bit)) continue;
    names += names.empty() ? "" : ", ";
    names += bit < std::size(kNames) ? std::string(kNames[bit]) : "flag " + std::to_string(bit);
  }
  return names;
}

std::string_view safety_state_name(SafetyState state) {
  constexpr std::array<std::string_view, 5> kNames = {"disconnected", "idle", "armed", "active", "fault"};
  return kNames[static_cast<std::size_t>(state)];
}

SafetyMemory start_safety(const DeviceProfile& profile) {
  SafetyMemory memory;
  for (std::size_t i = 0; i < profile.actuators.size(); ++i) memory.output[i] = profile.actuators[i].safe;
  return memory;
}

void begin_letting_go(SafetyMemory& memory) { memory.letting_go = memory.off = 0; }

SafetyOutput step_safety(const DeviceProfile& profile, const SafetyInputs& inputs, SafetyMemory& memory) {
  const double dt = is_finite(inputs.dt) ? clamp(inputs.dt, 0, 1) : 0;
  const std::uint32_t causes = causes_now(profile, inputs, memory);
  memory.causes |= causes & kLatchedFaults;
  const SafetyState before = memory.state;
  memory.state = next_state(profile, inputs, causes, memory);
  note_letting_go(before, inputs, memory);

  SafetyOutput output;
  output.flags = memory.causes;
  if (!inputs.connected) output.flags |= kAnswerLost;
  if (inputs.connected && !inputs.device_ready) output.flags |= kNotReady;
  const bool active = memory.state == SafetyState::active;
  const bool late = active && !ticks_fresh(profile, inputs);
  if (late) output.flags |= kTickLate;
  if (!inputs.dead_man) output.flags |= kDeadManReleased;
  const double gain = memory.gain;
  if (active) {
    step_gain(profile.safety, late, inputs.gap, dt, memory);
  } else {
    memory.gain = memory.owed = memory.settling = 0;
    memory.slower = 1;
  }
  const bool fading = late || memory.owed > 0;
  if (active && memory.gain < 1) output.flags |= kSoftStart;

  const double left = profile.safety.fade - memory.letting_go;  // of the fade
  const double share = left > dt ? 1 - dt / left : 0;
  const bool gently = memory.letting_go < kNever;
  output.at_safe_values = true;
  for (std::size_t i = 0; i < profile.actuators.size(); ++i) {
    const Actuator& actuator = profile.actuators[i];
    double target = actuator.safe;
    if (late && gain > 0) {  // all of them at one pace, and the gain with them
      target = actuator.safe + memory.gain / gain * (memory.output[i] - actuator.safe);
    } else if (active && !late) {
      const double within = clamp(inputs.wanted[i], actuator.lower, actuator.upper);
      if (within != inputs.wanted[i]) output.flags |= kClamped;
      target = actuator.safe + memory.gain * (within - actuator.safe);
    }
    if (gently && share > 0) target = let_go_gently(actuator.safe, memory.output[i], target, share);
    double next = limit_slew(actuator, profile.safety.fade, fading, dt, memory.output[i], target);
    if (gently && !active && share == 0) next = actuator.safe;  // rounding leaves nothing
    if (active && !late && next != target) output.flags |= kSlewLimited;
    memory.output[i] = clamp(next, actuator.lower, actuator.upper);
    output.command[i] = memory.output[i];
    output.at_safe_values = output.at_safe_values && memory.output[i] == actuator.safe;
  }
  memory.off = active && !late ? 0 : memory.off + dt;
  memory.letting_go = share > 0 || !active ? memory.letting_go + dt : kNever;
  output.device_on = is_on(memory.state) || !output.at_safe_values;
  return output;
}

}  // namespace lumbrical
