// See what_if.h.
#include "what_if.h"

#include <algorithm>
#include <array>

#include "winding_text.h"

namespace lumbrical::tool {
namespace {

constexpr double kMicroseconds = 1e6;

std::string part_name(std::size_t part) {
  return part < kFingerCount ? std::string(finger_name(static_cast<int>(part))) : "palm";
}

Json change_json(const Change& change) {
  return {{"max", change.max}, {"rms", change.rms}, {"max_tick", change.max_tick}};
}

/// The joint whose torque changed most.
std::size_t most_changed(const WhatIfResult& result) {
  const auto most = std::max_element(result.torque.begin(), result.torque.end(),
                                     [](const Change& a, const Change& b) { return a.max < b.max; });
  return static_cast<std::size_t>(most - result.torque.begin());
}

std::size_t largest(const std::array<Change, kFingerCount + 1>& changes) {
  const auto most = std::max_element(changes.begin(), changes.end(),
                                     [](const Change& a, const Change& b) { return a.max < b.max; });
  return static_cast<std::size_t>(most - changes.begin());
}

std::string at_tick(std::size_t part, const Change& change) {
  return " (" + part_name(part) + ", tick " + grouped(change.max_tick) + ")";
}

// The most newtons, and the most that a person would notice, which may be elsewhere.
std::string lead(const WhatIfResult& result) {
  const std::size_t newtons = largest(result.force), noticed = largest(result.force_jnd);
  const Change &force = result.force[newtons], &jnd = result.force_jnd[noticed];
  if (!(force.max > 0)) return "No force changes.\n";
  return "Forces change by up to " + brief(force.max) + " N" + at_tick(newtons, force) + " and " +
         brief(jnd.max) + " just-noticeable differences" + at_tick(noticed, jnd) + ": felt in " +
         grouped(result.felt_ticks[noticed]) + " of " + grouped(result.ticks) + " ticks.\n";
}

}  // namespace

Json what_if_json(const WhatIfResult& result) {
  Json json;
  json["ticks"] = result.ticks;
  json["unlike_recorded"] = result.unlike_recorded;
  for (std::size_t part = 0; part < result.force.size(); ++part) {
    Json force = change_json(result.force[part]);
    force["max_jnd"] = result.force_jnd[part].max;
    force["rms_jnd"] = result.force_jnd[part].rms;
    force["felt_ticks"] = result.felt_ticks[part];
    json["force"][part_name(part)] = force;
  }
  for (std::size_t s = 0; s < result.torque.size(); ++s)
    json["torque"][std::string(segment_name(static_cast<int>(s)))] = change_json(result.torque[s]);
  if (!result.replaced.empty()) json["windings"] = windings_json(result.replaced);
  json["tick_us"] = {{"recorded", kMicroseconds * result.recorded_time},
                     {"unchanged", kMicroseconds * result.baseline_time},
                     {"changed", kMicroseconds * result.changed_time}};
  return json;
}

std::string what_if_text(const WhatIfResult& result) {
  Table table;
  add_windings(result.replaced, table);
  for (std::size_t part = 0; part < result.force.size(); ++part) {
    const Change &force = result.force[part], &jnd = result.force_jnd[part];
    table.add(part == 0 ? "force changes by" : "",
              part_name(part) + ": max " + brief(force.max) + " N (" + brief(jnd.max) + " JND, tick " +
                  grouped(jnd.max_tick) + "), RMS " + brief(force.rms) + " N (" + brief(jnd.rms) +
                  " JND); felt in " + grouped(result.felt_ticks[part]) + " of " + grouped(result.ticks) +
                  " ticks");
  }
  const std::size_t joint = most_changed(result);
  const std::string name(segment_name(static_cast<int>(joint)));
  table.add("torque changes by", "most at the " + (name == "palm" ? "wrist" : "base of " + name) + ": max " +
                                     brief(1e3 * result.torque[joint].max) + " N mm, RMS " +
                                     brief(1e3 * result.torque[joint].rms) + " N mm");
  table.add("mean tick time", brief(kMicroseconds * result.changed_time) + " us, unchanged " +
                                  brief(kMicroseconds * result.baseline_time) + " us, when recorded " +
                                  brief(kMicroseconds * result.recorded_time) + " us");
  if (result.unlike_recorded > 0)
    table.add("not as recorded",
              grouped(result.unlike_recorded) +
                  " ticks without forces in the file, which this build computes otherwise: "
                  "compared with what it computes");
  return lead(result) + table.text();
}

}  // namespace lumbrical::tool
