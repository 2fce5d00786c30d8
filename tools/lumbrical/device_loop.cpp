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

constexpr std::int64_t kTellingPause = 1000000000;  // [ns] between two words about the certificate
constexpr std::size_t kToldJoint = 3;               // index proximal

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
    for (SinkEvent& event : sink.events()) tell(std::move(event));
    tell_timing();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

void DeviceLoop::Loop::tell(SinkEvent event) {
  std::fprintf(stderr, "device %8.3f s: %s\n", event.time, printable(event.text).c_str());
  events.push_back(std::move(event));
}

// At most once a second: a bus that gets slower all the time is told of often enough.
void DeviceLoop::Loop::tell_timing() {
  const std::int64_t now = clock_ns();
  const std::uint64_t count = renewals;
  if (now - timing_told < kTellingPause || count == renewals_told) return;
  timing_told = now;
  renewals_told = count;
  const LoopTiming known = {period, jitter, delay};
  const auto ms = [](double seconds) { return brief(1e3 * seconds) + " ms"; };
  std::string text = "certificate: period " + ms(known.period) + ", jitter " + ms(known.jitter) + ", delay " +
                     ms(known.delay);
  const StiffnessCertificate certificate = make_certificate(profile, known);
  if (certificate.known[kToldJoint])
    text += "; index proximal " + brief(certificate.margin * certificate.joint[kToldJoint].largest) +
            " N m/rad allowed";
  tell({static_cast<double>(now - opened) * 1e-9, std::move(text)});
}

void DeviceLoop::Loop::note(const SentCommand& sent) {
  if (sent.loop_delay > 0)
    loop_delays.add(static_cast<std::uint32_t>(std::min<std::int64_t>(sent.loop_delay, 4000000000)));
  note_exchange(sent, control);
  if (sent.acknowledged != 0) last_acknowledged = sent.acknowledged;
  other_master = other_master || (sent.flags & kOtherMaster) != 0;
}

std::string check_sink_uri(std::string& text) {
  SinkUri uri;
  return text == "null" ? std::string() : parse_sink_uri(text, uri).message();
}

namespace {

// Torques of one hand must never reach a device that is worn on the other.
Status choose_hand(const DeviceProfile& profile, const std::vector<Model>& models, std::size_t& hand) {
  if (!profile.side && models.size() == 1) return {};
  if (!profile.side)
    return Status::error("the session is of two hands, and " + profile.name +
                         " does not say which it drives; add side=left or side=right to the sink");
  for (hand = 0; hand < models.size(); ++hand)
    if (models[hand].hand.side == *profile.side) return {};
  return Status::error(profile.name + " drives a " + std::string(side_name(*profile.side)) +
                       " hand, and the session is of the other one");
}

}  // namespace

DeviceLoop::DeviceLoop() = default;
DeviceLoop::~DeviceLoop() { close(); }

Status DeviceLoop::open(const std::string& text, const std::vector<Model>& models, std::size_t& hand) {
  auto loop = std::make_unique<Loop>();
  if (Status status = parse_sink_uri(text, loop->uri); !status.ok()) return status;
  if (Status status = load_profile(loop->uri, loop->profile); !status.ok()) return status;
  if (Status status = choose_hand(loop->profile, models, hand); !status.ok()) return status;
  loop->model = &models[hand];
  LoopOptions control;
  control.feedback = loop->uri.feedback;
  control.limiter = loop->uri.limiter;
  control.account = loop->uri.observer;
  control.local = loop->uri.local;
  loop->control = start_loop(loop->profile, control);
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
  loop->opened = clock_ns();
  listen_to_signals(&loop->sink);
  loop_ = std::move(loop);
  loop_->reporter = std::thread([raw = loop_.get()] { raw->report(); });
  return {};
}

void DeviceLoop::before(DeviceFrame& frame) {
  Loop& loop = *loop_;
  if (DeviceFeedback feedback; loop.sink.feedback(feedback)) take_feedback(feedback, loop.control);
  if (put_angles(loop.control, clock_ns(), frame) || loop.armed_at == 0) return;
  ++loop.blind_ticks;
  if (loop.control.feedback.flags == 0) return;
  ++loop.doubted_ticks;
  loop.doubts |= loop.control.feedback.flags;
}

bool DeviceLoop::after(const Scratch& scratch, const DeviceFrame& frame, const ActuatorFrame& output,
                       TickRecord& record) {
  Loop& loop = *loop_;
  record.sent_count = 0;
  while (record.sent_count < kMaxSentPerTick && loop.sink.sent(record.sent[record.sent_count])) {
    loop.note(record.sent[record.sent_count++]);
  }
  record.timing.reset();
  if (news_of_timing(loop.control)) {
    record.timing = loop.control.certificate.timing;
    loop.period = record.timing->period;
    loop.jitter = record.timing->jitter;
    loop.delay = record.timing->delay;
    ++loop.renewals;
  }
  loop.sink.publish(command_forces(*loop.model, scratch, frame, output, clock_ns(), loop.control));
  const SafetyState state = loop.sink.state();
  loop.was_active = loop.was_active || state == SafetyState::active;
  if (loop.control.certified && loop.control.any_feedback && loop.was_active) {
    loop.oldest = max(loop.oldest, static_cast<double>(clock_ns() - loop.last_acknowledged) * 1e-9);
  }
  return !loop.other_master && !(loop.uri.stop_on_loss && loop.lost(state));
}

// A device that was never there has as long as it takes to notice one that falls silent.
bool DeviceLoop::Loop::lost(SafetyState now) const {
  if (now == SafetyState::fault || (was_active && now == SafetyState::idle)) return true;
  if (now != SafetyState::disconnected || armed_at == 0) return false;
  const double waited = static_cast<double>(clock_ns() - armed_at) * 1e-9;
  return was_active || waited > profile.safety.answer_timeout + profile.response_timeout;
}

void DeviceLoop::certify() { certify_loop(loop_->control); }

void DeviceLoop::measure_again() { forget_timing(loop_->control); }

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
  for (SinkEvent& event : loop.sink.events()) loop.tell(std::move(event));
}

}  // namespace lumbrical::tool
