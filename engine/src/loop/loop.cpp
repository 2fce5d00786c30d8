// See lumbrical/loop.h.
#include "lumbrical/loop.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/steady_clock.h"
#include "lumbrical/math.h"
#include "lumbrical/real_time.h"
#include "lumbrical/ways_out.h"
#include "model/ranges.h"

namespace lumbrical {
namespace {

// What is computed before a device is armed [s]: the first ticks meet cold caches and unmapped pages.
constexpr double kWarmUp = 0.05;

// Ticks that a command should be held for: of fewer, each that is a little late lets forces fade.
constexpr double kTicksHeld = 3;

// Cycles after which a device counts as lost: of fewer, each that is a little late, or whose answer is lost,
// lets go of everything.
constexpr double kCyclesAnswered = 3;

// Without a thread cycles come with the ticks.
double cycle_rate(const Model& model, const DeviceProfile& profile, const LoopSettings& settings) {
  return settings.sink.thread ? profile.rate : min(profile.rate, model.settings.rate);
}

// Without a thread a tick is told as it comes, however late.
double ticks_held(const Model& model, const DeviceProfile& profile, const LoopSettings& settings) {
  return settings.sink.thread ? model.settings.rate * profile.safety.tick_hold : kTicksHeld;
}

std::string hold_remedy(const Model& model) {
  return "; raise safety.tick_hold to " + text_of(kTicksHeld / model.settings.rate) + " s, or tick faster";
}

std::string answer_remedy(double rate, const DeviceProfile& profile) {
  return "; raise safety.answer_timeout to " + text_of(kCyclesAnswered / rate) +
         " s, where the device's own watchdog is no shorter, or " +
         (rate < profile.rate ? "tick faster" : "the profile's rate");
}

// No delay will ever be measured, so that the limiter lets nothing through.
bool is_never_measured(const HapticLoop& control, const DeviceFrame& frame) {
  const auto& known = control.certificate.known;
  const bool limits = control.options.limiter && frame.kind == InputKind::joint_angles &&
                      std::find(known.begin(), known.end(), true) != known.end();
  return limits && control.profile.sensors.empty() && !control.local_loop;
}

}  // namespace

Status DeviceLoop::open(const Model& model, const DeviceProfile& profile, std::unique_ptr<DeviceWire> wire,
                        const LoopSettings& settings) {
  if (const Side side = model.hand.side; profile.side.value_or(side) != side)
    return Status::error(profile.name + " drives a " + std::string(side_name(*profile.side)) +
                         " hand, and the session is of the other one");
  const double held = ticks_held(model, profile, settings);
  if (held < 1)
    return Status::error(profile.name +
                         ": a command is held for less than a tick, so that no force would ever come" +
                         hold_remedy(model));
  LoopSettings wanted = settings;
  wanted.sink.arm = false;
  wanted.sink.continue_after_loss = !settings.stop_on_loss;
  if (Status status = sink.open(profile, std::move(wire), wanted.sink); !status.ok()) return status;
  if (held < kTicksHeld)
    sink.tell("a command is held for little more than a tick: forces fade whenever one is late" +
              hold_remedy(model));
  if (const double rate = cycle_rate(model, profile, settings);
      rate * profile.safety.answer_timeout < kCyclesAnswered)
    sink.tell("the device counts as lost after less than three cycles: forces end whenever one is late" +
              answer_remedy(rate, profile));
  settings_ = wanted;
  control = start_loop(profile, settings.control);
  figures = {};
  started_ = false;
  open_ = true;
  return {};
}

bool DeviceLoop::step_unarmed(const Model& model, Scratch& scratch, const DeviceFrame& frame,
                              double duration) {
  State state = make_state(model);
  const auto ticks = static_cast<std::uint64_t>(std::ceil(duration * model.settings.rate));
  const Pace pace = start_pace(model.settings.rate);
  for (std::uint64_t i = 0; i < ticks && !stop_requested(); ++i) {
    sleep_until_ns(moment_of(pace, i));
    LoopStep next;
    next.frame = frame;
    step(model, state, scratch, next);
  }
  return !stop_requested();
}

bool DeviceLoop::measure(const Model& model, Scratch& scratch, const DeviceFrame& frame, double duration) {
  assert(open_ && figures.armed_at == 0);
  const bool whole = step_unarmed(model, scratch, frame, duration);
  certify_loop(control);
  return whole;
}

bool DeviceLoop::start(const Model& model, Scratch& scratch, const DeviceFrame& frame) {
  assert(open_ && control.certified);
  figures.never_measured = is_never_measured(control, frame);
  if (figures.never_measured)
    sink.tell(
        control.profile.name +
        " has no sensors, so its delay can't be measured: joint angles give no forces with the limiter on");
  forget_timing(sink.now(), control);
  step_unarmed(model, scratch, frame, kWarmUp);
  figures.armed_at = clock_ns();
  started_ = true;
  sink.arm_when_ready();
  return !stop_requested();
}

bool DeviceLoop::step(const Model& model, State& state, Scratch& scratch, LoopStep& next) {
  const auto feel = [&](LoopStep& now) {
    now.output = tick(model, state, scratch, now.frame);
    return true;
  };
  return step(model, scratch, feel, next);
}

bool DeviceLoop::look_after(const LoopStep& step) {
  if (!settings_.sink.thread) sink.cycle();
  if (step.blind && figures.armed_at != 0) {
    ++figures.blind_steps;
    if (control.feedback.flags != 0) ++figures.doubted_steps;
    figures.doubts |= control.feedback.flags;
  }
  for (std::uint32_t i = 0; i < step.sent_count; ++i) {
    if (step.sent[i].acknowledged != 0) figures.last_acknowledged = step.sent[i].acknowledged;
    figures.other_master = figures.other_master || (step.sent[i].flags & kOtherMaster) != 0;
  }
  if (step.news) ++figures.renewals;
  const SafetyState state = sink.state();
  figures.was_active = figures.was_active || state == SafetyState::active;
  if (control.certified && figures.last_acknowledged != 0 && figures.was_active)
    figures.oldest = max(figures.oldest, in_seconds(clock_ns() - figures.last_acknowledged));
  return !figures.other_master && !(settings_.stop_on_loss && lost(state));
}

// A device that was never there has as long as it takes to notice one that falls silent.
bool DeviceLoop::lost(SafetyState now) const {
  if (now == SafetyState::fault || (figures.was_active && now == SafetyState::idle)) return true;
  if (now != SafetyState::disconnected || figures.armed_at == 0) return false;
  const double patience = control.profile.safety.answer_timeout + control.profile.response_timeout;
  return figures.was_active || in_seconds(clock_ns() - figures.armed_at) > patience;
}

bool DeviceLoop::close() {
  if (!std::exchange(open_, false)) return figures.safe_at_end;
  figures.last = sink.report();
  figures.safe_at_end = sink.close();
  return figures.safe_at_end;
}

}  // namespace lumbrical
