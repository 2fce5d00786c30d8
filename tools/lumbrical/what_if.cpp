// See what_if.h.
#include "what_if.h"

#include <algorithm>

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

// The largest change that was felt, or if none was the largest of all.
std::string lead(const WhatIfResult& result) {
  const auto by_max = [](const Change& a, const Change& b) { return a.max < b.max; };
  const auto most = std::max_element(result.force_jnd.begin(), result.force_jnd.end(), by_max);
  const auto part = static_cast<std::size_t>(most - result.force_jnd.begin());
  if (!(most->max > 0)) return "No force changes.\n";
  return "Forces change by up to " + brief(result.force[part].max) + " N, " + brief(most->max) +
         " just-noticeable differences (" + part_name(part) + ", tick " + grouped(most->max_tick) +
         "): felt in " + grouped(result.felt_ticks[part]) + " of " + grouped(result.ticks) + " ticks.\n";
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
  json["tick_us"] = {{"recorded", kMicroseconds * result.recorded_time},
                     {"unchanged", kMicroseconds * result.baseline_time},
                     {"changed", kMicroseconds * result.changed_time}};
  return json;
}

std::string what_if_text(const WhatIfResult& result) {
  Table table;
  for (std::size_t part = 0; part < result.force.size(); ++part) {
    const Change &force = result.force[part], &jnd = result.force_jnd[part];
    table.add(part == 0 ? "force changes by" : "",
              part_name(part) + ": max " + brief(force.max) + " N (" + brief(jnd.max) + " JND, tick " +
                  grouped(jnd.max_tick) + "), RMS " + brief(force.rms) + " N (" + brief(jnd.rms) +
                  " JND); felt in " + grouped(result.felt_ticks[part]) + " of " + grouped(result.ticks) +
                  " ticks");
  }
  const std::size_t joint = most_changed(result);
  table.add("torque changes by", "most at the base of " + std::string(segment_name(static_cast<int>(joint))) +
                                     ": max " + brief(1e3 * result.torque[joint].max) + " N mm, RMS " +
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
