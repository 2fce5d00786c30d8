// See device_loop.h. What is told of it afterwards is in device_figures.cpp.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <thread>

#include "device_loop_state.h"
#include "real_time.h"
#include "ways_out.h"

namespace lumbrical::tool {
namespace {

// A local model is trusted as far as it takes to make the torque nothing, or twice what it is.
constexpr double kLocalShare = 1, kLargestRadius = 0.1;  // [1], [rad]
constexpr double kLocalPeriod = 0.001;                   // [s] of the device's own loop, at least as fast
// Of the joint's own damping: what the passivity controller may add.
constexpr double kControllerShare = 0.5;

// The sink that signals mean; they find nothing else.
std::atomic<ModbusSink*> signalled_sink{nullptr};

// The thread that crashed makes no more commands; the sink's thread fades them out meanwhile.
void let_go() {
  ModbusSink* const sink = signalled_sink;
  if (sink == nullptr) return;
  sink->press_stop(true);
  for (int i = 0; i < 400 && !sink->is_safe() && sink->state() != SafetyState::disconnected; ++i) {
    const timespec pause{0, 5000000};
    nanosleep(&pause, nullptr);
  }
}

// SIGUSR2 is an emergency stop; SIGUSR1 releases it, resets whatever fault there is and arms again.
extern "C" void stop_device(int) {
  if (ModbusSink* const sink = signalled_sink) sink->press_stop(true);
}
std::atomic<bool> arm_asked{false};
extern "C" void ask_to_arm(int) { arm_asked = true; }

void listen_to_signals(ModbusSink* sink) {
  signalled_sink = sink;
  before_dying(sink != nullptr ? let_go : nullptr);
  struct sigaction action {};
  action.sa_flags = SA_RESTART;
  action.sa_handler = stop_device;
  sigaction(SIGUSR2, &action, nullptr);
  action.sa_handler = ask_to_arm;
  sigaction(SIGUSR1, &action, nullptr);
}

}  // namespace

void DeviceLoop::Loop::report() {
  while (!ending) {
    if (arm_asked.exchange(false)) {
      sink.press_stop(false);
      sink.request_reset();
      sink.arm_when_ready();
    }
    for (SinkEvent& event : sink.events()) {
      std::fprintf(stderr, "device %8.3f s: %s\n", event.time, event.text.c_str());
      events.push_back(std::move(event));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

void DeviceLoop::Loop::take_angles() {
  const std::array<float, kAngleCount> before = feedback.angle;
  fresh_feedback = sink.feedback(feedback);
  if (!fresh_feedback) return;
  const double passed = static_cast<double>(feedback.time - feedback_before) * 1e-9;
  for (std::size_t j = 0; j < kPhalanxCount; ++j) {
    const std::size_t a = 4 * (j / 3) + 1 + j % 3;
    speed[j] = any_feedback && passed > 0 ? static_cast<double>(feedback.angle[a] - before[a]) / passed : 0;
  }
  feedback_before = feedback.time;
  any_feedback = true;
}

// One finger a tick: all of them would take longer than the tick itself.
void DeviceLoop::Loop::update_stiffness(const Scratch& scratch, const ActuatorFrame& output) {
  turn = (turn + 1) % kFingerCount;
  segment_jacobians(*model, scratch, jacobians, 7u << 3 * turn);
  bool known = true;  // a finger folded upon itself may be unknown for a moment: then what it was counts
  for (std::size_t i = 3 * turn; i < 3 * turn + 3; ++i)
    known = known && (jacobians[i].known || model->settings.law[i] != Law::field);
  if (known) stiffness[turn] = joint_stiffness(X_WJ, output, jacobians)[turn];
  if (certified && uri.limiter) limit_stiffness(certificate, stiffness, period, limiter);
}

void DeviceLoop::Loop::follow_hand(const DeviceFrame& frame, const ActuatorFrame& output) {
  std::array<double, kAngleCount> angles;
  std::copy(frame.angle.begin(), frame.angle.end(), angles.begin());
  forward_kinematics(model->hand, frame.base, angles, X_WJ);
  const std::array<double, kFingerCount> work = arm_work(base_before, frame.base, X_WJ, output);
  base_before = frame.base;
  for (std::size_t f = 0; f < kFingerCount; ++f) arm[f] += limiter.factor[f] * work[f];
}

// What the arm has given goes to the joints by the part they had in the finger's work.
void DeviceLoop::Loop::observe(const DeviceFrame& frame, const JointArray& wanted) {
  const JointArray acted = acted_torque();
  for (std::size_t f = 0; f < kFingerCount; ++f) {
    std::array<double, 3> part{};
    double all = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double angle = static_cast<double>(frame.angle[4 * f + 1 + k]);
      part[k] = std::fabs(acted[3 * f + k] * (angle - observer[3 * f + k].angle));
      all += part[k];
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t j = 3 * f + k;
      PassivityLimits limits;
      limits.damping = kControllerShare * profile.dynamics[j].damping;
      // What rounding an angle may invent.
      limits.tolerance = max(limits.tolerance, profile.dynamics[j].encoder_step * std::fabs(wanted[j]));
      const double given = arm[f] * (all > 0 ? part[k] / all : 1.0 / 3);
      const double angle = static_cast<double>(frame.angle[4 * f + 1 + k]);
      damping[j] =
          observe_passivity(limits, {period, angle, acted[j], wanted[j], given}, observer[j]) - wanted[j];
    }
    arm[f] = 0;
  }
}

JointArray DeviceLoop::Loop::acted_torque() const {
  JointArray torque{};
  for (std::size_t i = 0; i < profile.actuators.size(); ++i) {
    for (std::size_t j = 0; j < kPhalanxCount; ++j)
      torque[j] += profile.actuators[i].arm[j] * feedback.acted[i];
  }
  return torque;
}

void DeviceLoop::Loop::note(const SentCommand& sent) {
  if (sent_before != 0)
    intervals.add(static_cast<std::uint32_t>(std::min<std::int64_t>(sent.sent - sent_before, 4000000000)));
  sent_before = sent.sent;
  if (sent.loop_delay > 0)
    loop_delays.add(static_cast<std::uint32_t>(std::min<std::int64_t>(sent.loop_delay, 4000000000)));
  if (sent.acknowledged != 0) last_acknowledged = sent.acknowledged;
}

std::string check_sink_uri(std::string& text) {
  SinkUri uri;
  return text == "null" ? std::string() : parse_sink_uri(text, uri).message();
}

DeviceLoop::DeviceLoop() = default;
DeviceLoop::~DeviceLoop() { close(); }

Status DeviceLoop::open(const std::string& text, const Model& model) {
  auto loop = std::make_unique<Loop>();
  if (Status status = parse_sink_uri(text, loop->uri); !status.ok()) return status;
  if (Status status = load_profile(loop->uri, loop->profile); !status.ok()) return status;
  loop->model = &model;
  loop->period = 1 / model.settings.rate;
  if (loop->profile.sensors.empty()) loop->uri.feedback = false;
  SinkOptions options;
  options.arm = false;
  options.continue_after_loss = !loop->uri.stop_on_loss;
  options.dry_run = loop->uri.dry_run;
  options.priority = 81;  // its cycles are short, and a late command is worse than a late tick
  if (loop->uri.guard && !options.dry_run) {
    if (Status status = loop->guard.start(text); !status.ok()) return status;
  }
  if (Status status = loop->sink.open(loop->profile, options); !status.ok()) {
    loop->guard.dismiss();
    return status;
  }
  listen_to_signals(&loop->sink);
  loop_ = std::move(loop);
  loop_->reporter = std::thread([raw = loop_.get()] { raw->report(); });
  return {};
}

void DeviceLoop::before(DeviceFrame& frame) {
  Loop& loop = *loop_;
  loop.take_angles();
  if (!loop.uri.feedback) return;
  if (frame.kind == InputKind::joint_poses) {  // the wrist is the motion's, the fingers are the device's
    const JointPose& wrist = frame.joint[kWrist];
    const auto [px, py, pz] = wrist.position;
    const auto [qx, qy, qz, qw] = wrist.orientation;
    frame.base = frame.base * Pose{{px, py, pz}, normalized({qw, qx, qy, qz})};
    frame.kind = InputKind::joint_angles;
    frame.angle.fill(0);
    if ((frame.valid >> kWrist & 1u) == 0) frame.flags |= kTrackingLost;
    frame.joint = {};
    frame.valid = (1u << kJointCount) - 1;
  }
  std::uint32_t wanted = 0;
  for (const Sensor& sensor : loop.profile.sensors) wanted |= 1u << sensor.angle;
  for (std::size_t a = 0; a < kAngleCount; ++a) {
    if ((loop.feedback.valid >> a & 1u) != 0) frame.angle[a] = loop.feedback.angle[a];
  }
  const double age = static_cast<double>(clock_ns() - loop.feedback.time) * 1e-9;
  if (!loop.any_feedback || age > loop.profile.safety.answer_timeout ||
      (loop.feedback.valid & wanted) != wanted) {
    frame.flags |= kTrackingLost;
    if (loop.armed_at != 0) ++loop.blind_ticks;
  }
}

bool DeviceLoop::after(const Scratch& scratch, const DeviceFrame& frame, const ActuatorFrame& output,
                       TickRecord& record) {
  Loop& loop = *loop_;
  record.sent_count = 0;
  while (record.sent_count < kMaxSentPerTick && loop.sink.sent(record.sent[record.sent_count])) {
    loop.note(record.sent[record.sent_count++]);
  }
  const bool angles = frame.kind == InputKind::joint_angles;
  if (angles) {
    loop.follow_hand(frame, output);
    loop.update_stiffness(scratch, output);
  }
  JointArray wanted;
  for (std::size_t j = 0; j < kPhalanxCount; ++j)
    wanted[j] = loop.limiter.factor[j / 3] * output.flexion_torque[j];
  if (angles && loop.fresh_feedback && loop.uri.observer && loop.uri.feedback) loop.observe(frame, wanted);
  for (std::size_t j = 0; j < kPhalanxCount; ++j) {
    wanted[j] += wanted[j] == 0 ? 0 : loop.damping[j];  // free air stays free
  }

  const ActuatorSolution solution = solve_actuators(loop.profile, wanted, loop.speed);
  loop.largest_lost = max(loop.largest_lost, solution.lost_norm);
  DeviceCommand command;
  command.tick = output.tick;
  command.feedback_time = loop.any_feedback ? loop.feedback.time : 0;
  command.wanted = solution.command;
  for (std::size_t i = 0; loop.uri.local && i < loop.profile.actuators.size(); ++i) {
    const Actuator& actuator = loop.profile.actuators[i];
    if (!actuator.local.present) continue;
    const auto j = static_cast<std::size_t>(
        std::find_if(actuator.arm.begin(), actuator.arm.end(), [](double arm) { return arm != 0; }) -
        actuator.arm.begin());
    const double k = loop.limiter.factor[j / 3] * loop.stiffness[j / 3][j % 3][j % 3];
    command.angle[i] = static_cast<double>(frame.angle[4 * (j / 3) + 1 + j % 3]);
    command.stiffness[i] = max(0, k);
    command.radius[i] = k > 0 ? min(kLocalShare * std::fabs(wanted[j]) / k, kLargestRadius) : 0;
  }
  loop.sink.publish(command);

  for (std::size_t f = 0; f < kFingerCount; ++f) {
    loop.least_factor[f] = min(loop.least_factor[f], loop.limiter.factor[f]);
  }
  const SafetyState state = loop.sink.state();
  loop.was_active = loop.was_active || state == SafetyState::active;
  if (loop.certified && loop.any_feedback && loop.was_active) {
    loop.oldest = max(loop.oldest, static_cast<double>(clock_ns() - loop.last_acknowledged) * 1e-9);
  }
  return !(loop.uri.stop_on_loss && loop.lost(state));
}

// A device that was never there has as long as it takes to notice one that falls silent.
bool DeviceLoop::Loop::lost(SafetyState now) const {
  if (now == SafetyState::fault || (was_active && now == SafetyState::idle)) return true;
  if (now != SafetyState::disconnected || armed_at == 0) return false;
  const double waited = static_cast<double>(clock_ns() - armed_at) * 1e-9;
  return was_active || waited > profile.safety.answer_timeout + profile.response_timeout;
}

void DeviceLoop::certify() {
  Loop& loop = *loop_;
  LoopTiming timing;
  loop.measured = loop.loop_delays.max() > 0 && loop.intervals.max() > 0;
  if (loop.measured) {
    timing.period = loop.intervals.percentile(0.5) * 1e-9;
    timing.jitter = std::max(0.0, loop.intervals.percentile(0.99) * 1e-9 - timing.period);
    timing.delay = loop.loop_delays.percentile(0.99) * 1e-9;
  } else {
    timing.period = std::max(1 / loop.profile.rate, bus_cycle(loop.profile));
    timing.delay = timing.period + loop.period;
  }
  bool local = loop.uri.local;
  for (const Actuator& actuator : loop.profile.actuators) local = local && actuator.local.present;
  // With a local model the fast loop is the device's own; the bus only tells it where the touch has moved to.
  if (local) timing = {kLocalPeriod, 0, 0};
  loop.local_loop = local;
  loop.certificate = make_certificate(loop.profile, timing);
  loop.certified = true;
}

void DeviceLoop::arm() {
  loop_->armed_at = clock_ns();
  loop_->sink.arm_when_ready();
}

std::string DeviceLoop::certificate_text() const { return json()["certificate"].dump(); }

bool DeviceLoop::forces_flow() const {
  const SafetyState state = loop_->last.state;
  const bool flow = state == SafetyState::active || state == SafetyState::armed;  // armed: switch let go
  return loop_->uri.dry_run || (loop_->was_active && flow);
}

void DeviceLoop::close() {
  if (!loop_ || loop_->ending) return;
  Loop& loop = *loop_;
  loop.last = loop.sink.report();
  loop.safe_at_end = loop.sink.close();
  if (loop.safe_at_end || !loop.was_active) loop.guard.dismiss();
  listen_to_signals(nullptr);
  loop.ending = true;
  if (loop.reporter.joinable()) loop.reporter.join();
  for (SinkEvent& event : loop.sink.events()) {
    std::fprintf(stderr, "device %8.3f s: %s\n", event.time, event.text.c_str());
    loop.events.push_back(std::move(event));
  }
}

}  // namespace lumbrical::tool
