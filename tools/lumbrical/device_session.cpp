// See device_session.h. What is told of it afterwards is in device_figures.cpp.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>
#include <utility>

#include "device_session_state.h"
#include "lumbrical/real_time.h"
#include "lumbrical/ways_out.h"

namespace lumbrical::tool {
namespace {

constexpr std::int64_t kTellingPause = 1000000000;  // [ns] between two words about the certificate
constexpr std::size_t kToldJoint = 3;               // index proximal

// The sink that signals mean; they find nothing else.
std::atomic<DeviceSink*> signalled_sink{nullptr};

// SIGUSR2 is an emergency stop; SIGUSR1 releases it, resets whatever fault there is and, once the loop itself
// has armed, arms again.
extern "C" void stop_device(int) {
  if (DeviceSink* const sink = signalled_sink) sink->press_stop(true);
}
std::atomic<bool> arm_asked{false};
extern "C" void ask_to_arm(int) { arm_asked = true; }

void listen_to_signals(DeviceSink* sink) {
  signalled_sink = sink;
  fade_before_dying(sink);
  struct sigaction action {};
  action.sa_flags = SA_RESTART;
  action.sa_handler = stop_device;
  sigaction(SIGUSR2, &action, nullptr);
  action.sa_handler = ask_to_arm;
  sigaction(SIGUSR1, &action, nullptr);
}

}  // namespace

void DeviceSession::Told::report() {
  while (!ending) {
    if (arm_asked.exchange(false)) {
      loop.sink.press_stop(false);
      loop.sink.request_reset();
      if (loop.started()) loop.sink.arm_when_ready();
    }
    for (SinkEvent& event : loop.sink.events()) tell(std::move(event));
    tell_timing();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

void DeviceSession::Told::tell(SinkEvent event) {
  std::fprintf(stderr, "device %8.3f s: %s\n", event.time, printable(event.text).c_str());
  events.push_back(std::move(event));
}

std::string own_delay_text(const DeviceProfile& profile) {
  std::string text;
  if (const double own = own_delay(profile, kToldJoint); own > 0)
    text = ", with " + brief(1e3 * own) + " ms of the device's own";
  if (!knows_own_delays(profile))
    text += "; the profile does not say every `delay` of sensors and drives, and counts on none there";
  return text;
}

// At most once a second: a bus that gets slower all the time is told of often enough.
void DeviceSession::Told::tell_timing() {
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
  text += own_delay_text(profile);
  tell({static_cast<double>(now - opened) * 1e-9, std::move(text)});
}

namespace {

// Torques of one hand must never reach a device that is worn on the other.
Status choose_hand(const DeviceProfile& profile, const std::vector<Model>& models, std::size_t& hand) {
  if (!profile.side && models.size() == 1) return {};
  if (!profile.side)
    return Status::error("the session is of two hands, and " + profile.name +
                         " does not say which it drives; add side=left or side=right to the sink");
  if (models.size() > 1 && models[0].hand.side != *profile.side) hand = 1;
  return {};
}

}  // namespace

DeviceSession::DeviceSession() = default;
DeviceSession::~DeviceSession() { close(); }

Status DeviceSession::open(const std::string& text, const std::vector<Model>& models, std::size_t& hand) {
  auto told = std::make_unique<Told>();
  if (Status status = parse_sink_uri(text, told->uri); !status.ok()) return status;
  if (Status status = load_profile(told->uri, told->profile); !status.ok()) return status;
  if (Status status = choose_hand(told->profile, models, hand); !status.ok()) return status;
  told->model = &models[hand];
  LoopSettings settings;
  settings.control.feedback = told->uri.feedback;
  settings.control.limiter = told->uri.limiter;
  settings.control.account = told->uri.observer;
  settings.control.local = told->uri.local;
  settings.stop_on_loss = told->uri.stop_on_loss;
  settings.sink.thread = true;
  settings.sink.dry_run = told->uri.dry_run;
  settings.sink.priority = 81;  // its cycles are short, and a late command is worse than a late tick
  std::unique_ptr<DeviceWire> wire;
  if (Status status = make_wire(told->profile, wire); !status.ok()) return status;
  if (told->uri.guard && !told->uri.dry_run) {
    Status status = told->guard.start({"/proc/self/exe", "guard", text});
    if (!status.ok()) return Status::error(status.message() + "; guard=off goes without");
  }
  Status status = told->loop.open(models[hand], told->profile, std::move(wire), settings);
  if (!status.ok()) {
    told->guard.dismiss();
    return status;
  }
  told->opened = clock_ns();
  listen_to_signals(&told->loop.sink);
  told_ = std::move(told);
  told_->reporter = std::thread([raw = told_.get()] { raw->report(); });
  return {};
}

DeviceLoop& DeviceSession::loop() { return told_->loop; }

void DeviceSession::note(const LoopStep& step) {
  Told& told = *told_;
  for (std::uint32_t i = 0; i < step.sent_count; ++i) {
    const std::int64_t delay = step.sent[i].loop_delay;
    if (delay > 0)
      told.loop_delays.add(static_cast<std::uint32_t>(std::min<std::int64_t>(delay, 4000000000)));
  }
  const LoopTiming& timing = told.loop.control.certificate.timing;
  if (told.renewals == told.loop.figures.renewals) return;
  told.period = timing.period;
  told.jitter = timing.jitter;
  told.delay = timing.delay;
  told.renewals = told.loop.figures.renewals;
}

std::string DeviceSession::certificate_text() const { return certificate_json().dump(); }

bool DeviceSession::forces_flow() const {
  const LoopFigures& figures = told_->loop.figures;
  const SafetyState state = figures.last.state;
  const bool flow = state == SafetyState::active || state == SafetyState::armed;  // armed: switch let go
  return told_->uri.dry_run || (figures.was_active && flow && figures.safe_at_end);
}

void DeviceSession::close() {
  if (!told_ || told_->ending) return;
  Told& told = *told_;
  const bool safe = told.loop.close();
  if (safe || !told.loop.figures.was_active) told.guard.dismiss();
  listen_to_signals(nullptr);
  told.ending = true;
  if (told.reporter.joinable()) told.reporter.join();
  for (SinkEvent& event : told.loop.sink.events()) told.tell(std::move(event));
}

}  // namespace lumbrical::tool
