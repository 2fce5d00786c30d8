// See report_compare.h.
#include "report_compare.h"

#include <algorithm>
#include <map>

#include "output.h"
#include "report_json.h"

namespace lumbrical::tool {
namespace {

constexpr double kErrorNoise = 1.3;
constexpr double kLeastError = 1e-12;  // below that an error is rounding

std::optional<double> counter(const std::map<std::string, double>& counters,
                              std::initializer_list<const char*> names) {
  for (const char* const name : names) {
    const auto found = counters.find(name);
    if (found != counters.end()) return found->second;
  }
  return std::nullopt;
}

using Measurements = std::map<std::string, Measurement>;

std::string name_of(const PeerResult& peer) {
  return "bench_peers: " + peer.scene + ", " + count_text(peer.triangles) + " triangles, " + peer.contender;
}

Measurements measurements_of(const std::vector<Results>& all) {
  Measurements figures;
  for (const Results& results : all) {
    for (const auto& [name, counters] : results.counters) {
      const auto time = counter(counters, {"processor_p50_us", "p50_us", "median_us", "microseconds"});
      if (time && *time > 0)
        figures[name] = {*time, counter(counters, {"force_error", "error_R3", "hand_error"})};
    }
    for (const PeerResult& peer : results.peers) {
      if (peer.is_ours()) figures[name_of(peer)] = {peer.median_us, peer.force_error};
    }
  }
  return figures;
}

// Of code that is not ours: the same in both folders, whatever we did.
Measurements others_in(const std::vector<Results>& all) {
  Measurements others;
  for (const Results& results : all) {
    for (const PeerResult& peer : results.peers)
      if (!peer.is_ours()) others[name_of(peer)] = {peer.median_us, peer.force_error};
  }
  return others;
}

bool is_worse(const Change& change, double sign) {
  if (!change.before.error || !change.after.error) return false;
  const double from = std::max(*change.before.error, kLeastError);
  const double to = std::max(*change.after.error, kLeastError);
  return sign > 0 ? to > kErrorNoise * from : from > kErrorNoise * to;
}

std::vector<Change> changes_between(const Measurements& before, const Measurements& after) {
  std::vector<Change> changes;
  for (const auto& [name, figures] : after) {
    const auto found = before.find(name);
    if (found != before.end()) changes.push_back({name, found->second, figures});
  }
  std::stable_sort(changes.begin(), changes.end(),
                   [](const Change& a, const Change& b) { return a.times() > b.times(); });
  return changes;
}

MachineFactor machine_between(const std::vector<Results>& before, const std::vector<Results>& after) {
  const std::vector<Change> others = changes_between(others_in(before), others_in(after));
  if (others.empty()) return {};
  return {others[others.size() / 2].times(), others.size()};
}

std::string machine_sentence(const MachineFactor& machine) {
  if (machine.rows == 0)
    return "How far the machine itself was slower or faster is not told apart: the folders have no other "
           "libraries of bench_peers in common.";
  return "What is not our code, " + std::to_string(machine.rows) + (machine.rows == 1 ? " row" : " rows") +
         " of bench_peers, takes " + brief(machine.times) +
         " times as long as before: so far the machine itself is another. The column \"beside machine\" has "
         "it "
         "divided out.";
}

// "7 of 120 are slower by more than 15 %, most A_drape/1e-4/162 (2.1 times)."
template <class Is>
std::string count_sentence(const std::vector<Change>& changes, const char* what, const Is& is,
                           const Change* worst, const std::string& by) {
  const auto count = static_cast<std::size_t>(std::count_if(changes.begin(), changes.end(), is));
  if (count == 0) return std::string("None is ") + what + ".";
  return std::to_string(count) + " of " + std::to_string(changes.size()) + (count == 1 ? " is " : " are ") +
         what + ", most " + worst->name + " (" + by + ").";
}

std::string error_text(const std::optional<double>& error) {
  return !error ? "" : *error > 0 ? scientific(*error) : "0";
}

std::string origin_of(const std::vector<Results>& all) {
  for (const Results& results : all) {
    std::string text;
    for (const auto& [name, value] : results.origin) {
      if (name == "cpu" || name == "isa" || name == "compiler") text += (text.empty() ? "" : ", ") + value;
    }
    if (!text.empty()) return text;
  }
  return {};
}

std::vector<std::string> words_of(const std::vector<Change>& changes, const MachineFactor& machine) {
  if (changes.empty()) return {"They have no benchmark in common."};
  const auto worst_error = [&](double sign) {
    const auto ratio = [&](const Change& change) {
      if (!is_worse(change, sign)) return 0.0;
      const double r =
          std::max(*change.after.error, kLeastError) / std::max(*change.before.error, kLeastError);
      return sign > 0 ? r : 1 / r;
    };
    return *std::max_element(changes.begin(), changes.end(),
                             [&](const Change& a, const Change& b) { return ratio(a) < ratio(b); });
  };
  const Change slowest = changes.front(), fastest = changes.back(), worse = worst_error(1),
               better = worst_error(-1);
  const auto errors = [](const Change& c) {
    return error_text(c.before.error) + " -> " + error_text(c.after.error);
  };
  return {
      count_sentence(
          changes, "slower by more than 15 %", [](const Change& c) { return c.times() > kTimeNoise; },
          &slowest, brief(slowest.times()) + " times as long"),
      count_sentence(
          changes, "less accurate", [](const Change& c) { return is_worse(c, 1); }, &worse, errors(worse)),
      count_sentence(
          changes, "faster by more than 15 %", [](const Change& c) { return c.times() * kTimeNoise < 1; },
          &fastest, brief(1 / fastest.times()) + " times as fast"),
      count_sentence(
          changes, "more accurate", [](const Change& c) { return is_worse(c, -1); }, &better, errors(better)),
      "The median benchmark takes " + brief(changes[changes.size() / 2].times()) +
          " times as long as before.",
      machine_sentence(machine)};
}

}  // namespace

double times_beside_machine(const Change& change, const MachineFactor& machine) {
  return change.times() / machine.times;
}

bool is_less_accurate(const Change& change) { return is_worse(change, 1); }

Comparison compare_results(const std::vector<Results>& before, const std::vector<Results>& after) {
  Comparison comparison;
  comparison.changes = changes_between(measurements_of(before), measurements_of(after));
  comparison.machine = machine_between(before, after);
  comparison.words = words_of(comparison.changes, comparison.machine);
  const std::string one = origin_of(before), other = origin_of(after);
  if (one != other)
    comparison.words.push_back("Machine or build differ: " + one + " before, " + other + " after.");
  comparison.table.head = {"benchmark",      "before, us",   "after, us",  "times",
                           "beside machine", "error before", "error after"};
  for (const Change& change : comparison.changes)
    comparison.table.rows.push_back({change.name, brief(change.before.time), brief(change.after.time),
                                     brief(change.times()),
                                     brief(times_beside_machine(change, comparison.machine)),
                                     error_text(change.before.error), error_text(change.after.error)});
  return comparison;
}

}  // namespace lumbrical::tool
