// See modbus_worker.h.
#include "modbus/modbus_worker.h"

#include <pthread.h>
#include <sched.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

namespace lumbrical {
namespace {

constexpr std::size_t kMostEvents = 1000;

using Clock = std::chrono::steady_clock;

std::int64_t ns(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }
double seconds(std::int64_t nanoseconds) { return static_cast<double>(nanoseconds) * 1e-9; }

}  // namespace

void ModbusSink::Worker::tell(std::string text) {
  const std::lock_guard lock(mutex);
  if (events.size() < kMostEvents) events.push_back({seconds(now_ns() - opened), std::move(text)});
}

// The same trouble is told once, until something works again.
void ModbusSink::Worker::problem(std::string text) {
  if (last_problem == text) return;
  last_problem = text;
  {
    const std::lock_guard lock(mutex);
    report.trouble = text;
  }
  tell(std::move(text));
}

void ModbusSink::Worker::set_up_thread() {
  // Signals are other threads' affair: a handler that waits for this one must not run on it.
  sigset_t signals;
  sigfillset(&signals);
  for (const int own : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS}) sigdelset(&signals, own);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  if (options.priority > 0) {
    sched_param parameter{};
    parameter.sched_priority = options.priority;
    if (pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter) != 0) {
      tell("no real-time priority for the sink's thread: not permitted");
    }
  }
  if (options.cpu >= 0) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(options.cpu), &set);
    if (pthread_setaffinity_np(pthread_self(), sizeof set, &set) != 0)
      tell("the sink's thread could not be pinned");
  }
}

void ModbusSink::Worker::connect() {
  const std::int64_t now = now_ns();
  if (now < next_try) return;
  const Status status = link.open(profile.transport, profile.response_timeout);
  if (status.ok()) {
    {
      const std::lock_guard lock(mutex);
      ++report.connections;
    }
    tell("connected");
    handshaken = false;
    return;
  }
  problem("not connected: " + status.message());
  retry = retry == 0 ? profile.first_retry : std::min(2 * retry, profile.last_retry);
  next_try = now_ns() + ns(retry);
}

// What the profile wants to be written first; then its conditions, until they hold.
bool ModbusSink::Worker::shake_hands() {
  for (const RegisterWrite& write : profile.handshake) {
    const RegisterBlock block{write.unit, write.address, 1};
    if (!answered(link.write(block, &write.value), "writing", block)) return false;
  }
  for (const RegisterCheck& check : profile.expected) {
    const RegisterBlock block{check.unit, check.address, 1};
    std::uint16_t value = 0;
    if (!answered(link.read(profile.read_function, block, &value), "reading", block)) return false;
    if ((value & check.mask) != check.value) {
      problem("the device is not ready yet: " + name_registers(profile, block) + " holds another value");
      return false;
    }
  }
  return true;
}

// The commands as they stand; those that can't be read count as safe.
bool ModbusSink::Worker::take_over() {
  words.write(profile, {.command = start_safety(profile).output}, {}, 0);
  std::size_t at = 0;
  for (const RegisterBlock& block : words.plan.writes) {
    if (!answered(link.read(3, block, words.written.data() + at), "reading", block) && !link.is_open())
      return false;
    at += block.count;
  }
  words.commands(profile, safety.output);
  return true;
}

// What is wrong is told with the names of the registers it was about.
bool ModbusSink::Worker::answered(const LinkResult& result, const char* doing, const RegisterBlock& block) {
  if (result.ok()) return true;
  {
    const std::lock_guard lock(mutex);
    ++(result.outcome == LinkOutcome::refused ? report.refused : report.broken);
  }
  std::string text = std::string(result.text) + ", " + doing + " " + name_registers(profile, block);
  if (result.outcome == LinkOutcome::broken) return lose(std::move(text)), false;
  problem(std::move(text));
  return false;
}

void ModbusSink::Worker::lose(std::string why) {
  link.close();
  handshaken = standing = false;
  problem(std::move(why));
  // The first try follows at once, the others ever later.
  next_try = retry == 0 ? 0 : now_ns() + ns(retry);
  retry = retry == 0 ? profile.first_retry : std::min(2 * retry, profile.last_retry);
}

void ModbusSink::Worker::take_command() {
  PublishedCommand fresh;
  if (!commands.take(fresh)) return;
  newest = fresh;
  lost_before = running.lost;
}

// Looks for the command again and again rather than being woken: the thread that ticks makes no system call.
void ModbusSink::Worker::await_tick() {
  constexpr std::chrono::microseconds kLook{50};
  const std::int64_t begun = now_ns();
  for (;;) {
    take_command();
    const std::int64_t now = now_ns();
    const bool ticking = seconds(now - newest.time) <= profile.safety.tick_hold;
    const double wait = wait_for_tick(newest.command, asked_at, exchange, profile.safety);
    if (!standing || !ticking || stop || closing || seconds(now - begun) >= wait) return;
    std::this_thread::sleep_for(kLook);
  }
}

SafetyOutput ModbusSink::Worker::decide(std::int64_t now) {
  const double elapsed = seconds(now - last_step);
  last_step = now;
  const unsigned asked = requests.exchange(0);
  SafetyInputs inputs;
  inputs.dt = running.advance(elapsed);
  inputs.gap = elapsed - inputs.dt;
  take_command();
  inputs.connected = link.is_open() && handshaken && any_answer &&
                     seconds(now - last_answer) <= profile.safety.answer_timeout;
  inputs.device_ready = device.ready;
  inputs.device_fault = device.fault;
  inputs.stop = stop || device.stop;
  inputs.dead_man = profile.status.dead_man != 0 ? device.dead_man : dead_man.load();
  inputs.heartbeat_lost = profile.heartbeat.echoed && any_answer &&
                          seconds(now - last_echo_change) > profile.safety.answer_timeout;
  inputs.other_master = std::exchange(other_master, false);
  inputs.arm = (asked & kArm) != 0;
  inputs.disarm = (asked & kDisarm) != 0 || closing;
  inputs.reset = (asked & kReset) != 0;
  inputs.continue_after_loss = options.continue_after_loss && !closing;
  inputs.tick_age = newest.time == 0 ? std::numeric_limits<double>::infinity()
                                     : seconds(now - newest.time) - (running.lost - lost_before);
  inputs.wanted = newest.command.wanted;
  const bool can_arm =
      safety.state == SafetyState::idle && inputs.device_ready && inputs.tick_age <= profile.safety.tick_hold;
  inputs.arm = inputs.arm || (auto_arm && can_arm);
  const SafetyState before = safety.state;
  const std::uint32_t causes = safety.causes;
  const SafetyOutput output = step_safety(profile, inputs, safety);
  if (safety.state == SafetyState::armed) auto_arm = false;
  state = safety.state;
  if (safety.state != before || safety.causes != causes) tell_transition(before, output.flags);
  return output;
}

void ModbusSink::Worker::tell_transition(SafetyState before, std::uint32_t flags) {
  constexpr std::pair<SafetyFlag, const char*> kCauses[] = {
      {kStopPressed, "emergency stop"},
      {kDeviceFault, "the device reports a fault"},
      {kTickStopped, "no new tick"},
      {kCommandNotFinite, "a command that is no number"},
      {kHeartbeatLost, "heartbeat not echoed"},
      {kOtherMaster, "another master writes to the device, or it has lost what was written"},
      {kAnswerLost, "no answer"},
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
}

// Do the registers still hold what was written in the cycle before? A few of them at a time.
void ModbusSink::Worker::look_back() {
  const bool hurry = stop || closing || options.take_over;
  if (!link.is_open() || !standing || hurry || !(profile.read_back > 0)) return;
  if (seconds(now_ns() - last_look) < profile.read_back) return;
  last_look = now_ns();
  const auto [block, at] = words.part(look++);
  const LinkResult result = link.read(3, block, words.read_back.data());
  if (result.outcome == LinkOutcome::refused) {
    profile.read_back = 0;
    tell("another master would not be noticed: the device does not let its commands be read back (" +
         std::string(result.text) + ")");
    return;
  }
  if (answered(result, "reading back", block)) other_master = !words.holds(block, at);
}

bool ModbusSink::Worker::transfer() {
  const ExchangePlan& plan = words.plan;
  asked_at = now_ns();
  if (plan.combined) {
    return answered(link.exchange(plan.writes[0], words.written.data(), plan.reads[0], words.read.data()),
                    "writing", plan.writes[0]);
  }
  std::size_t at = 0;
  for (const RegisterBlock& block : plan.writes) {
    if (!answered(link.write(block, words.written.data() + at), "writing", block)) return false;
    at += block.count;
  }
  at = 0;
  asked_at = now_ns();
  for (const RegisterBlock& block : plan.reads) {
    if (!answered(link.read(profile.read_function, block, words.read.data() + at), "reading", block))
      return false;
    at += block.count;
  }
  return true;
}

// Each kind when it begins, with the first joint that it is about.
void ModbusSink::Worker::tell_doubts(const DeviceFeedback& feedback) {
  const std::uint32_t news = feedback.flags & ~std::exchange(doubts, feedback.flags);
  if (news == 0) return;
  const auto sensor = std::find_if(profile.sensors.begin(), profile.sensors.end(), [&](const Sensor& one) {
    return (feedback.valid >> one.angle & 1u) == 0;
  });
  const int motion = sensor->angle % 4, joint = 3 * (sensor->angle / 4) + std::max(motion - 1, 0);
  std::string text = "not believed, forces fade: angle of " + std::string(segment_name(joint));
  if ((news & kAngleOutOfRange) != 0) text += " out of its range";
  if ((news & kAngleJumped) != 0) text += " jumps farther than a finger can move";
  if ((news & kAngleStuck) != 0) text += " is not moved by torques that must move it";
  tell(std::move(text));
}

void ModbusSink::Worker::take_feedback(std::int64_t now) {
  device = words.status(profile);
  const std::uint16_t echo = device.echo;
  if (!any_answer || echo != last_echo) last_echo_change = now;
  last_echo = echo;
  if (profile.sensors.empty()) return;
  DeviceFeedback feedback;
  feedback.asked = asked_at;
  feedback.time = now;
  feedback.acted = std::exchange(acting, commanded);
  words.angles(profile, feedback.angle, feedback.valid);
  check_feedback(profile, feedback, feedback_memory);
  tell_doubts(feedback);
  feedbacks.put(feedback);
}

void ModbusSink::Worker::remember(const SafetyOutput& output, std::int64_t sent, std::int64_t acknowledged) {
  SentCommand* const slot = history.claim();
  if (slot == nullptr) return;  // no one listens
  slot->cycle = cycle;
  slot->tick = newest.command.tick;
  slot->sent = sent;
  slot->acknowledged = acknowledged;
  const std::int64_t read = newest.command.feedback_time;
  slot->loop_delay = read != 0 && acknowledged != 0 ? acknowledged - read : 0;
  slot->state = safety.state;
  slot->flags = output.flags;
  slot->actuator_count = static_cast<std::uint32_t>(profile.actuators.size());
  slot->value = output.command;
  history.publish();
}

void ModbusSink::Worker::count(bool acknowledged, std::int64_t now) {
  if (now - rate_start[1] > ns(1)) {
    rate_start = {rate_start[1], now};
    rate_count = {rate_count[1], report.acknowledged};
  }
  const std::lock_guard lock(mutex);
  report.cycles = cycle;
  report.acknowledged += acknowledged ? 1 : 0;
  report.state = safety.state;
  report.age = any_answer ? seconds(now - last_answer) : std::numeric_limits<double>::infinity();
  const std::int64_t span = now - rate_start[0];
  if (span > 0) report.rate = static_cast<double>(report.acknowledged - rate_count[0]) / seconds(span);
}

// One cycle. True: the device has acknowledged safe values with its control word off.
bool ModbusSink::Worker::step() {
  // While forces act, an emergency stop is answered soon or the link is closed: the device's watchdog acts
  // then.
  link.patience.hurried = 2 * std::max(running.usual, 1 / profile.rate);
  if (!link.is_open()) connect();
  bool taken_over = false;
  if (link.is_open() && !handshaken) {
    handshaken = options.take_over ? take_over() : shake_hands();
    if (handshaken) last_echo_change = now_ns();
    taken_over = handshaken && options.take_over;
  }
  look_back();
  await_tick();
  const std::int64_t begun = now_ns();
  // Letting go begins here, however long the way to the device took: else the first command would be a step.
  if (taken_over) last_step = begun - ns(1 / profile.rate);
  SafetyOutput output = decide(begun);
  if (options.dry_run) {
    for (std::size_t i = 0; i < profile.actuators.size(); ++i) output.command[i] = profile.actuators[i].safe;
    output.device_on = false;
  }
  const std::int64_t sent = now_ns();
  bool acknowledged = false;
  if (link.is_open() && handshaken) {
    commanded = output.command;
    words.write(profile, output, newest.command, static_cast<std::uint16_t>(cycle + 1));
    ++cycle;
    if (!output.at_safe_values && !options.dry_run) safe = false;  // it may arrive even if its reply does not
    acknowledged = transfer();
    standing = acknowledged;
    const std::int64_t now = now_ns();
    if (acknowledged) {
      exchange = seconds(now - sent);
      take_feedback(now);
      last_answer = now;
      any_answer = true;
      retry = 0;
      last_problem.clear();
    }
    remember(output, sent, acknowledged ? now : 0);
  }
  count(acknowledged, now_ns());
  {
    const std::lock_guard lock(mutex);
    report.flags = output.flags;
  }
  if (acknowledged) safe = output.at_safe_values || options.dry_run;
  return acknowledged && safe && !output.device_on;
}

void ModbusSink::Worker::run() {
  set_up_thread();
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / profile.rate));
  Clock::time_point next = Clock::now();
  last_step = opened = now_ns();
  rate_start.fill(opened);
  std::int64_t give_up = 0;
  for (;;) {
    if (closing && give_up == 0) {
      give_up = now_ns() +
                ns(profile.safety.fade + profile.safety.answer_timeout + 2 * profile.response_timeout + 0.1);
    }
    bool off = false;
    try {
      off = step();
    } catch (const std::bad_alloc&) {  // for a message; the next cycle is told what this one was not
      link.close();
    }
    if (give_up != 0 && (off || now_ns() > give_up)) {
      tell(off ? "closed: the device has acknowledged safe values"
               : "closed: the device could not be told; its own watchdog must act");
      return;
    }
    next += period;
    const Clock::time_point now = Clock::now();
    if (next < now) next = now;  // a late cycle is not made up for
    std::this_thread::sleep_until(next);
  }
}

}  // namespace lumbrical
