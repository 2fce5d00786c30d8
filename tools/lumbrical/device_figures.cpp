// What is told of a device loop after a session: figures, certificate, events.
#include <algorithm>
#include <cmath>

#include "device_session_state.h"

namespace lumbrical::tool {
namespace {

Json events_json(const std::vector<SinkEvent>& events) {
  Json list = Json::array();
  for (const SinkEvent& event : events) list.push_back({{"time", event.time}, {"text", event.text}});
  return list;
}

// Infinity is no JSON number.
Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json timing_json(const LoopTiming& timing) {
  return {{"period", timing.period}, {"jitter", timing.jitter}, {"delay", finite_or_null(timing.delay)}};
}

bool limiter_knows(const Settings& settings) {
  return std::all_of(settings.law.begin(), settings.law.begin() + kPhalanxCount,
                     [](Law law) { return law == Law::field; });
}

// Why forces do not reach the device, in its last state.
std::string cause(const SinkReport& report) {
  switch (report.state) {
    case SafetyState::idle:
      return "the device is not ready" + (report.trouble.empty() ? "" : " (" + report.trouble + ")");
    case SafetyState::armed:
      return (report.flags & kDeadManReleased) != 0 ? "the dead-man switch is not held"
                                                    : "ticks came too late";
    default:
      return report.trouble.empty() ? "no answer" : report.trouble;
  }
}

std::string counted(std::uint64_t count, const char* one, const char* many) {
  return grouped(count) + " " + (count == 1 ? one : many);
}

double most_generated(const HapticLoop& loop) {
  double most = 0;
  for (const EnergyAccount& account : loop.account) most = std::max(most, account.generated);
  return most;
}

// Of delays in nanoseconds; nothing where none was measured.
Json delays_json(const TickTimes& delays) {
  if (delays.max() == 0) return {{"p50", nullptr}, {"p99", nullptr}, {"max", nullptr}};
  return {{"p50", delays.percentile(0.5) / 1000},
          {"p99", delays.percentile(0.99) / 1000},
          {"max", delays.max() / 1000.0}};
}

std::string delays_text(const TickTimes& delays) {
  if (delays.max() == 0) return "not measured: the device told no angles";
  return "p50 " + brief(delays.percentile(0.5) / 1000) + "   p99 " + brief(delays.percentile(0.99) / 1000) +
         "   max " + brief(delays.max() / 1000.0) + " us from angle to torque";
}

// The limiter can't but hold these fingers at nothing.
bool has_frictionless_steps(const HapticLoop& loop) {
  bool found = false;
  for (std::size_t j = 0; j < kPhalanxCount; ++j)
    found = found || (loop.certificate.known[j] && loop.certificate.joint[j].friction == 0);
  return found && loop.options.limiter;
}

// The certificate is of a loop whose delay was measured.
bool has_measured(const HapticLoop& loop) { return is_measured(loop.meter) && !loop.local_loop; }

std::string by_finger(const std::array<double, kFingerCount>& values) {
  std::string text;
  for (int f = 0; f < kFingerCount; ++f) {
    text +=
        (f > 0 ? "   " : "") + std::string(finger_name(f)) + " " + brief(values[static_cast<std::size_t>(f)]);
  }
  return text;
}

std::string told_text(const HapticLoop& loop) {
  std::string text;
  for (std::size_t j = 0; j < kPhalanxCount; ++j) {
    const std::string finger(finger_name(static_cast<int>(j / 3)));
    text += j % 3 > 0 ? " " : (j > 0 ? ", " : "") + finger + " ";
    text += brief(1e3 * loop.largest_told[j]);
  }
  return text + " N mm, joint by joint";
}

std::string doubts_text(std::uint32_t flags) {
  std::string text;
  for (const auto& [flag, name] : {std::pair(kAngleOutOfRange, "out of range"),
                                   std::pair(kAngleJumped, "jumped"), std::pair(kAngleStuck, "stuck")}) {
    if ((flags & flag) != 0) text += (text.empty() ? " " : ", ") + std::string(name);
  }
  return text;
}

}  // namespace

std::vector<std::string> DeviceSession::trouble() const {
  const LoopFigures& figures = told_->loop.figures;
  const SinkReport& report = figures.last;
  std::vector<std::string> lines;
  if (!forces_flow()) {
    lines.push_back((figures.was_active ? "forces no longer reached the device: "
                                        : "no force ever reached the device: ") +
                    cause(report));
  }
  if (figures.never_measured)
    lines.push_back(
        "the device has no sensors, so its delay can't be measured: joint angles gave no forces with the "
        "limiter on");
  if (has_frictionless_steps(told_->loop.control))
    lines.push_back(
        "the profile says an encoder step and no friction of some joints: 2 friction / step allows them no "
        "stiffness, and their fingers got no force; say their friction, or write limiter=off");
  if (report.faults > 0)
    lines.push_back(counted(report.faults, "fault of the device loop", "faults of the device loop"));
  if (report.losses > 0)
    lines.push_back(counted(report.losses, "loss of the device", "losses of the device"));
  if (report.lapses > 0)
    lines.push_back("the device was not ready any more " + counted(report.lapses, "time", "times") +
                    ": forces began anew, softly");
  if (figures.doubted_steps > 0) {
    lines.push_back("angles of the device were not believed in " +
                    counted(figures.doubted_steps, "tick", "ticks") + ":" + doubts_text(figures.doubts));
  }
  if (figures.was_active && !figures.safe_at_end)
    lines.push_back("the device is NOT known to be at safe values");
  return lines;
}

std::uint64_t DeviceSession::ticks_without_angles() const { return told_->loop.figures.blind_steps; }

Json DeviceSession::certificate_json() const {
  const HapticLoop& control = told_->loop.control;
  const StiffnessCertificate& certificate = control.certificate;
  Json json = {{"device", told_->profile.name},
               {"measured", has_measured(control)},
               {"period", certificate.timing.period},
               {"jitter", certificate.timing.jitter},
               {"delay", finite_or_null(certificate.timing.delay)},
               {"margin", certificate.margin},
               {"renewals", told_->loop.figures.renewals},
               {"slowest", timing_json(control.slowest)}};
  json["joints"] = Json::array();
  for (std::size_t j = 0; j < kPhalanxCount; ++j) {
    if (!certificate.known[j]) continue;
    const StiffnessBound& bound = certificate.joint[j];
    json["joints"].push_back({{"joint", segment_name(static_cast<int>(j))},
                              {"own_delay", own_delay(told_->profile, j)},
                              {"sampled", finite_or_null(bound.sampled)},
                              {"delayed", finite_or_null(bound.delayed)},
                              {"friction", finite_or_null(bound.friction)},
                              {"largest", finite_or_null(bound.largest)}});
  }
  return json;
}

Json DeviceSession::json() const {
  const Told& told = *told_;
  const HapticLoop& control = told.loop.control;
  const LoopFigures& figures = told.loop.figures;
  const SinkReport& report = figures.last;
  Json json;
  json["profile"] = told.profile.name;
  json["verified_on_hardware"] = told.profile.verified;
  json["state"] = safety_state_name(report.state);
  json["rate_hz"] = report.rate;
  json["oldest_command_ms"] = 1e3 * figures.oldest;
  json["cycles"] = report.cycles;
  json["acknowledged"] = report.acknowledged;
  json["refused"] = report.refused;
  json["broken"] = report.broken;
  json["connections"] = report.connections;
  json["safe_at_end"] = figures.safe_at_end;
  json["loop_delay_us"] = delays_json(told.loop_delays);
  json["largest_lost_torque"] = control.largest_lost;
  json["largest_told_torque"] = control.largest_told;
  json["limiter_knows_law"] = limiter_knows(told.model->settings);
  json["least_stiffness_factor"] = control.least_factor;
  json["energy"] = {{"generated_most", most_generated(control)}, {"least_share", control.least_share}};
  json["gaps"] = control.gaps;
  json["certificate"] = certificate_json();
  json["events"] = events_json(told.events);
  return json;
}

void DeviceSession::add_rows(Table& table) const {
  const Told& told = *told_;
  const HapticLoop& control = told.loop.control;
  const LoopFigures& figures = told.loop.figures;
  const SinkReport& report = figures.last;
  table.add("device",
            told.profile.name + (told.profile.verified ? "" : " (profile not verified on hardware)"));
  table.add("", grouped(report.acknowledged) + " of " + grouped(report.cycles) + " commands acknowledged, " +
                    brief(report.rate) + " Hz, oldest " + brief(1e3 * figures.oldest) + " ms; ended " +
                    std::string(safety_state_name(report.state)) +
                    (figures.safe_at_end ? ", at safe values" : ", NOT known to be at safe values"));
  table.add("loop delay", delays_text(told.loop_delays));
  const LoopTiming& timing = control.certificate.timing;
  const bool measured = has_measured(control);
  if (measured || control.local_loop) {
    table.add("stiffness certificate",
              std::string(measured ? "measured" : "assumed") + " period " + brief(1e3 * timing.period) +
                  " ms, jitter " + brief(1e3 * timing.jitter) + " ms, delay " + brief(1e3 * timing.delay) +
                  " ms" + (control.local_loop ? " of the device's own loop" : ""));
  } else {
    table.add("stiffness certificate", "none: no delay was measured");
  }
  const LoopTiming& slowest = control.slowest;
  if (measured)
    table.add("", "renewed " + grouped(figures.renewals) + " times; at the slowest period " +
                      brief(1e3 * slowest.period) + " ms, jitter " + brief(1e3 * slowest.jitter) +
                      " ms, delay " + brief(1e3 * slowest.delay) + " ms");
  const StiffnessBound& bound = control.certificate.joint[3];
  if (control.certificate.known[3] && !measured && !control.local_loop) {
    table.add("", "with the limiter on no force of joint angles is let through");
  } else if (control.certificate.known[3]) {
    table.add("", "index proximal: 2b/T " + brief(bound.sampled) + ", with delay " + brief(bound.delayed) +
                      ", friction " + brief(bound.friction) + "; allowed " +
                      brief(control.certificate.margin * bound.largest) + " N m/rad" +
                      own_delay_text(told.profile));
  } else {
    table.add("",
              "the profile does not say the joints' damping: nothing can be promised, nothing is limited");
  }
  if (!limiter_knows(told.model->settings)) {
    table.add("",
              "the limiter knows the stiffness of the field law only: what follows another law may shake");
  }
  table.add("told the device", "at most " + told_text(control));
  table.add("least stiffness factor", by_finger(control.least_factor));
  if (keeps_accounts(control)) {
    table.add("energy accounts",
              brief(1e3 * most_generated(control)) + " mJ generated at most by one finger");
    table.add("", "torques paid for: " + by_finger(control.least_share) + " at least");
  } else {
    table.add("energy accounts", "not kept");
  }
  if (control.gaps > 0)
    table.add("stale angles",
              counted(control.gaps, "time", "times") + " in a touch: " +
                  (control.gain == 1 ? "forces came back softly" : "forces were not all back at the end"));
  if (control.largest_lost > 0) table.add("lost torque", brief(1e3 * control.largest_lost) + " N mm at most");
}

}  // namespace lumbrical::tool
