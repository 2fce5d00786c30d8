// See report_changes.h.
#include "report_changes.h"

namespace lumbrical::tool {
namespace {

Json number_or_null(const std::optional<double>& number) { return number ? Json(*number) : Json(); }

Json change_json(const Change& change, const MachineFactor& machine, double slower_from) {
  const double beside = times_beside_machine(change, machine);
  return {{"benchmark", change.name},
          {"before_us", change.before.time},
          {"after_us", change.after.time},
          {"times", change.times()},
          {"times_beside_machine", beside},
          {"error_before", number_or_null(change.before.error)},
          {"error_after", number_or_null(change.after.error)},
          {"slower", beside > slower_from},
          {"less_accurate", is_less_accurate(change)}};
}

}  // namespace

std::vector<Step> steps_between(const std::vector<ResultFolder>& folders) {
  std::vector<Step> steps;
  for (std::size_t i = 1; i < folders.size(); ++i) {
    const ResultFolder &from = folders[i - 1], &to = folders[i];
    steps.push_back({from.name, to.name, builds_of(from.results), builds_of(to.results),
                     compare_results(from.results, to.results)});
  }
  return steps;
}

Json changes_json(const std::vector<Step>& steps, double slower_from) {
  Json list = Json::array();
  for (const Step& step : steps) {
    const MachineFactor& machine = step.comparison.machine;
    Json changes = Json::array();
    for (const Change& change : step.comparison.changes)
      changes.push_back(change_json(change, machine, slower_from));
    list.push_back({{"from", step.from},
                    {"to", step.to},
                    {"from_build", step.from_build},
                    {"to_build", step.to_build},
                    {"machine_factor", machine.rows > 0 ? Json(machine.times) : Json()},
                    {"machine_rows", machine.rows},
                    {"benchmarks", std::move(changes)}});
  }
  return {{"changes_of", "lumbrical report"}, {"slower_from", slower_from}, {"steps", std::move(list)}};
}

std::vector<std::string> slower_benchmarks(const std::vector<Step>& steps, double slower_from) {
  std::vector<std::string> slower;
  for (const Step& step : steps) {
    for (const Change& change : step.comparison.changes) {
      const double beside = times_beside_machine(change, step.comparison.machine);
      if (beside > slower_from)
        slower.push_back(change.name + " takes " + brief(beside) + " times as long (from " + step.from +
                         " to " + step.to + ")");
    }
  }
  return slower;
}

}  // namespace lumbrical::tool
