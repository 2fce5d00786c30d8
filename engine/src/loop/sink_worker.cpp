// See sink_worker.h.
#include "loop/sink_worker.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include "base/set_bits.h"
#include "base/thread_signals.h"
#include "loop/scheduling.h"
#include "lumbrical/real_time.h"
#include "model/ranges.h"

namespace lumbrical {
namespace {

constexpr std::size_t kMostEvents = 1000;
constexpr double kTellingPause = 1;  // [s] between two words about the same trouble that comes and goes
constexpr double kStands = 1;        // [s] a connection that lasted for so long is one that works

}  // namespace

void DeviceSink::Worker::tell(std::string text) {
  const std::lock_guard lock(mutex);
  if (events.size() < kMostEvents) events.push_back({in_seconds(steady_ns() - opened), std::move(text)});
}

// The same trouble is told once, until something works again, and then no more often than anyone can read.
void DeviceSink::Worker::problem(std::string text) {
  const bool same = last_problem == text;
  if (same && !std::exchange(has_worked, false)) return;
  has_worked = false;
  const std::int64_t now = steady_ns();
  times_untold = same ? times_untold + 1 : 0;
  if (same && in_seconds(now - problem_told) < kTellingPause) return;
  problem_told = now;
  last_problem = text;
  if (times_untold > 1)
    text +=
        ", " + std::to_string(times_untold) +
        " times since that was told: what is sent or answered is lost on the way, or response_timeout is too "
        "short for it";
  times_untold = 0;
  if (safety.state != SafetyState::fault) {  // what has ended the forces is told in the end
    const std::lock_guard lock(mutex);
    report.trouble = text;
  }
  tell(std::move(text));
}

void DeviceSink::Worker::set_up_thread() {
  leave_signals_to_others();
  if (options.priority > 0 && take_priority(options.priority) != 0)
    tell("no real-time priority for the sink's thread: not permitted");
  if (options.cpu >= 0 && !stay_on({&options.cpu, 1})) tell("the sink's thread could not be pinned");
}

double DeviceSink::Worker::longer_retry() const {
  return retry == 0 ? profile.first_retry : std::min(2 * retry, profile.last_retry);
}

void DeviceSink::Worker::connect() {
  const std::int64_t now = steady_ns();
  if (now < next_try) return;
  // A host may take its time to be found: what was lost is known before.
  if (safety.state != SafetyState::disconnected) remember_change(decide(now).flags);
  const Status status = wire->open();
  if (status.ok()) {
    {
      const std::lock_guard lock(mutex);
      ++report.connections;
    }
    tell("connected");
    connected_at = steady_ns();
    connected = looks_back = true;
    handshaken = false;
    not_noticed.clear();
    return;
  }
  problem("not connected: " + status.message());
  retry = longer_retry();
  next_try = steady_ns() + in_ns(retry);
}

// What has to come before commands; or, to fade what another left, what that was.
bool DeviceSink::Worker::greet() {
  if (!options.take_over) return answered(wire->greet());
  return answered(wire->read_commands(safety.output)) || connected;
}

bool DeviceSink::Worker::answered(WireResult result) {
  if (result.ok()) return true;
  const bool refused = result.outcome == WireOutcome::refused;
  if (result.outcome != WireOutcome::waiting) {
    const std::lock_guard lock(mutex);
    ++(refused ? report.refused : report.broken);
  }
  if (result.outcome == WireOutcome::broken) {
    lose(std::move(result.text));
  } else {
    problem(std::move(result.text));
  }
  return false;
}

void DeviceSink::Worker::disconnect() {
  wire->close();
  connected = handshaken = standing = has_answered = false;
}

void DeviceSink::Worker::lose(std::string why) {
  disconnect();
  problem(std::move(why));
  // The first try follows at once, the others ever later.
  next_try = retry == 0 ? 0 : steady_ns() + in_ns(retry);
  retry = longer_retry();
}

void DeviceSink::Worker::take_command() {
  PublishedCommand fresh;
  if (!commands.take(fresh)) return;
  newest = fresh;
  age.begin(running);
}

// Looks for the command again and again rather than being woken: the thread that ticks makes no system call.
void DeviceSink::Worker::await_tick() {
  constexpr std::chrono::microseconds kLook{50};
  const std::int64_t begun = steady_ns();
  for (;;) {
    take_command();
    const std::int64_t now = steady_ns();
    const bool ticking = in_seconds(now - newest.time) <= profile.safety.tick_hold;
    const double wait = wait_for_tick(newest.command, asked_at, exchange, profile.safety);
    if (!options.thread || !standing || !ticking || stop || closing || in_seconds(now - begun) >= wait)
      return;
    std::this_thread::sleep_for(kLook);
  }
}

// For so long that a device has let go by itself: its watchdog counts from its last command, not from the
// answer to that.
bool DeviceSink::Worker::silent(std::int64_t now) const {
  return told_at == 0 || in_seconds(now - told_at) > profile.safety.answer_timeout;
}

SafetyOutput DeviceSink::Worker::decide(std::int64_t now) {
  const double elapsed = in_seconds(now - last_step);
  last_step = now;
  const unsigned asked = requests.exchange(0);
  const DeviceStatus& device = answer.status;
  SafetyInputs inputs;
  inputs.connected = has_answered && !silent(now);
  inputs.dt = running.advance(elapsed);
  inputs.gap = elapsed - inputs.dt;
  // A device that is silent for so long, or has said nothing yet on this connection, has let go: what acted
  // then must not come again.
  if (!inputs.connected) inputs.dt += running.lost - std::exchange(lost_answered, running.lost);
  take_command();
  inputs.device_ready = device.ready;
  inputs.device_fault = device.fault;
  inputs.stop = stop || device.stop;
  inputs.dead_man = device.has_dead_man ? device.dead_man : dead_man.load();
  inputs.heartbeat_lost =
      device.echoes && has_answered && in_seconds(now - last_echo_change) > profile.safety.answer_timeout;
  inputs.other_master = std::exchange(other_master, false);
  inputs.disarm = (asked & kDisarm) != 0 || closing;
  inputs.reset = (asked & kReset) != 0;
  inputs.continue_after_loss = options.continue_after_loss && !closing;
  inputs.tick_age = newest.time == 0 ? std::numeric_limits<double>::infinity()
                                     : age.of(in_seconds(now - newest.time), running);
  inputs.wanted = newest.command.wanted;
  arms_when_ready = arms_when_ready || (asked & kArmWhenReady) != 0;
  const bool ready =
      safety.state == SafetyState::idle && inputs.device_ready && inputs.tick_age <= profile.safety.tick_hold;
  inputs.arm = (asked & kArm) != 0 || (arms_when_ready && ready);
  const SafetyState before = safety.state;
  const std::uint32_t causes = safety.causes;
  const SafetyOutput output = step_safety(profile, inputs, safety);
  // It waits for a device and ticks only: whoever disarms, and whatever is a fault, has the last word.
  const bool waits = safety.state == SafetyState::disconnected || safety.state == SafetyState::idle;
  arms_when_ready = arms_when_ready && waits && !inputs.disarm;
  state = safety.state;
  if (safety.state != before || safety.causes != causes) tell_transition(before, output.flags);
  return output;
}

void DeviceSink::Worker::tell_transition(SafetyState before, std::uint32_t flags) {
  constexpr std::pair<SafetyFlag, const char*> kCauses[] = {
      {kStopPressed, "emergency stop"},
      {kDeviceFault, "the device reports a fault"},
      {kTickStopped, "no new tick"},
      {kCommandNotFinite, "a command that is no number"},
      {kHeartbeatLost, "heartbeat not echoed"},
      {kOtherMaster, "another master writes to the device, or it has lost what was written"},
      {kAnswerLost, "no answer"},
      {kNotReady, "the device is not ready"},
      {kDeadManReleased, "dead-man switch released"}};
  std::string causes;
  for (const auto& [flag, name] : kCauses) {
    if ((flags & flag) != 0) causes += std::string(": ") + name;
  }
  tell(std::string(safety_state_name(before)) + " -> " + std::string(safety_state_name(safety.state)) +
       causes);
  const std::lock_guard lock(mutex);
  const bool was_on = before == SafetyState::armed || before == SafetyState::active;
  if (safety.state == SafetyState::fault) {
    ++report.faults;
    report.trouble = "fault" + causes;
  }
  if (safety.state == SafetyState::disconnected && was_on) ++report.losses;
  if (safety.state == SafetyState::idle && was_on && (flags & kNotReady) != 0) ++report.lapses;
}

// Are the device's commands still those that were sent in the cycle before?
void DeviceSink::Worker::look_back() {
  if (!connected || !standing || !looks_back || stop || closing || options.take_over) return;
  WireResult result = wire->look_back(other_master);
  looks_back = result.outcome != WireOutcome::refused;
  if (looks_back && result.outcome != WireOutcome::waiting) {
    answered(std::move(result));
  } else if (result.text != not_noticed) {
    not_noticed = result.text;
    tell("another master would not be noticed" + std::string(looks_back ? " for now: " : ": ") + result.text);
  }
}

bool DeviceSink::Worker::exchange_with(const SafetyOutput& output) {
  answer.asked = steady_ns();
  const bool done = answered(wire->exchange({cycle_count, output, newest.command}, answer));
  asked_at = answer.asked;
  return done;
}

// Each kind when it begins, with the first joint that it is about.
void DeviceSink::Worker::tell_doubts(const DeviceFeedback& feedback) {
  const std::uint32_t news = feedback.flags & ~std::exchange(doubts, feedback.flags);
  for (const auto& [flag, what] :
       {std::pair<std::uint32_t, const char*>(kAngleOutOfRange, " out of its range"),
        {kAngleJumped, " jumps farther than a finger can move"},
        {kAngleStuck,
         " is not moved by torques that must move it; if it stands at its stop, bend it once by half a "
         "radian, or let its sensor's lower .. upper in the profile end at the stops"}}) {
    if ((news & flag) == 0) continue;
    const auto sensor = std::find_if(
        profile.sensors.begin(), profile.sensors.end(), [this, reason = flag](const Sensor& one) {
          return feedback_memory[static_cast<std::size_t>(one.angle)].doubt == reason;
        });
    if (sensor == profile.sensors.end()) continue;  // two of one angle
    const std::string_view joint = segment_name(static_cast<int>(sensed_joint(*sensor)));
    tell("not believed, forces fade: angle of " + std::string(joint) + what);
  }
}

// Those that the profile knows, within their sensors' ranges.
void DeviceSink::Worker::take_angles(DeviceFeedback& feedback) const {
  for (const Sensor& sensor : profile.sensors) {
    const auto a = static_cast<std::size_t>(sensor.angle);
    const float angle = answer.angle[a];
    const bool possible =
        angle >= static_cast<float>(sensor.lower) && angle <= static_cast<float>(sensor.upper);
    if (!has_bit(answer.valid, a) || !possible) continue;
    feedback.angle[a] = angle;
    feedback.valid |= 1u << a;
  }
}

// Once for each joint: what is slower than the bus can't be known by measuring the bus.
void DeviceSink::Worker::note_pace(const DeviceFeedback& feedback) {
  for (const Sensor& sensor : profile.sensors) {
    const auto a = static_cast<std::size_t>(sensor.angle);
    if (!has_bit(feedback.valid, a) || has_bit(slow_told, a)) continue;
    const std::size_t joint = sensed_joint(sensor);
    note_angle(feedback.angle[a], feedback.asked, profile.dynamics[joint].encoder_step, pace[a]);
    const double slow = slow_pace(pace[a]);
    if (!(slow > 0 && slow > 1.2 * sensor.delay.value_or(0))) continue;
    slow_told |= 1u << a;
    const double milliseconds = std::round(1e3 * slow);
    tell("angle of " + std::string(segment_name(static_cast<int>(joint))) + " changes once in " +
         text_of(milliseconds) +
         " ms only while the joint moves, more seldom than the device answers: what is stiff may shake; let "
         "the profile say so, \"delay\": " +
         text_of(1e-3 * milliseconds) + " of its sensor");
  }
}

void DeviceSink::Worker::take_feedback(std::int64_t sent, std::int64_t now) {
  const bool was_silent = !has_answered || silent(sent);
  const std::uint16_t echo = answer.status.echo;
  if (was_silent || echo != last_echo) last_echo_change = now;
  last_echo = echo;
  // One that is not ready, or was not when it answered last, makes no torque of what it is told.
  const bool was_ready = std::exchange(last_ready, answer.status.ready);
  if (was_silent || !was_ready || !last_ready) {
    held_since = now;
    acting = start_safety(profile).output;
  }
  if (profile.sensors.empty()) return;
  DeviceFeedback feedback;
  feedback.asked = asked_at;
  feedback.time = now;
  feedback.held_since = held_since;
  feedback.acted = std::exchange(acting, commanded);
  take_angles(feedback);
  check_feedback(profile, feedback, feedback_memory);
  tell_doubts(feedback);
  note_pace(feedback);
  hand_over(feedback);
}

void DeviceSink::Worker::hand_over(const DeviceFeedback& feedback) {
  DeviceFeedback* const slot = feedbacks.claim();
  if (slot == nullptr) return newest_feedback.put(feedback);
  *slot = feedback;
  feedbacks.publish();
}

// Every one, so that all energy is booked. When ticks have stood still for longer than the ring has room for,
// forces have long faded: then the newest is enough, and what the ring has from before it too old.
bool DeviceSink::Worker::next_feedback(DeviceFeedback& feedback) {
  DeviceFeedback next;
  const auto is_newer = [&] { return next.time > taken_feedback; };
  while (const DeviceFeedback* const front = feedbacks.front()) {
    next = *front;
    feedbacks.pop();
    if (is_newer()) break;
  }
  if (!is_newer() && !(newest_feedback.take(next) && is_newer())) return false;
  taken_feedback = next.time;
  feedback = next;
  return true;
}

// Null: no one listens.
SentCommand* DeviceSink::Worker::claim_slot(std::uint32_t flags) {
  SentCommand* const slot = history.claim();
  if (slot == nullptr) return nullptr;
  *slot = {};
  slot->cycle = cycle_count;
  slot->tick = newest.command.tick;
  slot->state = remembered_state = safety.state;
  slot->flags = remembered_flags = flags;
  return slot;
}

void DeviceSink::Worker::remember(const SafetyOutput& output, std::int64_t sent, std::int64_t acknowledged) {
  SentCommand* const slot = claim_slot(output.flags);
  if (slot == nullptr) return;
  slot->sent = sent;
  slot->acknowledged = acknowledged;
  const std::int64_t read = newest.command.feedback_time;
  slot->loop_delay = read != 0 && acknowledged != 0 ? acknowledged - read : 0;
  slot->actuator_count = static_cast<std::uint32_t>(profile.actuators.size());
  slot->value = output.command;
  history.publish();
}

// In a cycle that sends nothing: else a lost device would count as armed until a command reaches it again.
void DeviceSink::Worker::remember_change(std::uint32_t flags) {
  if (safety.state == remembered_state && flags == remembered_flags) return;
  if (claim_slot(flags) != nullptr) history.publish();
}

void DeviceSink::Worker::count(bool acknowledged, std::int64_t now) {
  if (now - rate_start[1] > in_ns(1)) {
    rate_start = {rate_start[1], now};
    rate_count = {rate_count[1], report.acknowledged};
  }
  const std::lock_guard lock(mutex);
  report.cycles = cycle_count;
  report.acknowledged += acknowledged ? 1 : 0;
  report.state = safety.state;
  report.age = told_at != 0 ? in_seconds(now - told_at) : std::numeric_limits<double>::infinity();
  const std::int64_t span = now - rate_start[0];
  if (span > 0) report.rate = static_cast<double>(report.acknowledged - rate_count[0]) / in_seconds(span);
}

// True: the device has acknowledged it.
bool DeviceSink::Worker::exchange_and_note(const SafetyOutput& output) {
  const std::int64_t sent = steady_ns();
  commanded = output.command;
  ++cycle_count;
  if (!output.at_safe_values && !options.dry_run) safe = false;  // it may arrive even if its reply does not
  const bool acknowledged = exchange_with(output);
  standing = acknowledged;
  const std::int64_t now = steady_ns();
  if (acknowledged) {
    exchange = in_seconds(now - sent);
    take_feedback(sent, now);
    told_at = sent;
    lost_answered = running.lost;
    has_answered = true;
    if (in_seconds(now - connected_at) > kStands) retry = 0;
    has_worked = true;
  }
  remember(output, sent, acknowledged ? now : 0);
  return acknowledged;
}

// One cycle. True: the device has acknowledged safe values with its control word off.
bool DeviceSink::Worker::cycle() {
  // While forces act, an emergency stop is answered soon or the link is closed: the device's watchdog acts
  // then.
  wire->patience.hurried = 2 * std::max(running.usual, 1 / profile.rate);
  if (!connected) connect();
  bool taken_over = false;
  if (connected && !handshaken) {
    handshaken = greet();
    if (handshaken) last_echo_change = steady_ns();
    taken_over = handshaken && options.take_over;
  }
  look_back();
  await_tick();
  const std::int64_t begun = steady_ns();
  // Letting go begins here, however long the way to the device took: else the first command would be a step.
  if (taken_over) {
    last_step = begun - in_ns(1 / profile.rate);
    begin_letting_go(safety);
  }
  SafetyOutput output = decide(begun);
  if (options.dry_run) {
    for (std::size_t i = 0; i < profile.actuators.size(); ++i) output.command[i] = profile.actuators[i].safe;
    output.device_on = false;
  }
  bool acknowledged = false;
  if (connected && handshaken) {
    acknowledged = exchange_and_note(output);
  } else {
    remember_change(output.flags);
  }
  count(acknowledged, steady_ns());
  {
    const std::lock_guard lock(mutex);
    report.flags = output.flags;
  }
  if (acknowledged) safe = output.at_safe_values || options.dry_run;
  return acknowledged && safe && !output.device_on;
}

// A cycle that does not throw, and when the next one is due: a late one is not made up for.
bool DeviceSink::Worker::step() {
  bool off = false;
  try {
    off = cycle();
  } catch (const std::bad_alloc&) {  // for a message; the next cycle is told what this one was not
    disconnect();
  }
  next_cycle = std::max(next_cycle + in_ns(1 / profile.rate), steady_ns());
  return off;
}

void DeviceSink::Worker::let_go() {
  const std::int64_t give_up = steady_ns() + in_ns(profile.safety.fade + profile.safety.answer_timeout +
                                                   2 * profile.response_timeout + 0.1);
  while (!step()) {
    if (steady_ns() > give_up) return tell("closed: the device could not be told; its own watchdog must act");
    await_cycle();
  }
  tell("closed: the device has acknowledged safe values");
}

void DeviceSink::Worker::await_cycle() const { sleep_until_ns(next_cycle); }

void DeviceSink::Worker::run() {
  set_up_thread();
  while (!closing) {
    step();
    await_cycle();
  }
  let_go();
}

}  // namespace lumbrical
