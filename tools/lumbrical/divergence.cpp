// See divergence.h.
#include "divergence.h"

namespace lumbrical::tool {

namespace {

template <class Value>
Json value_or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

}  // namespace

Json divergence_json(const ReplayResult& result) {
  Json json;
  json["identical"] = !result.first_divergence.has_value();
  json["ticks"] = result.ticks;
  json["first_divergence"] = nullptr;
  if (result.first_divergence) {
    const Divergence& first = *result.first_divergence;
    json["first_divergence"] = {{"tick", first.tick},
                                {"stage", first.stage},
                                {"field", first.field},
                                {"recorded", first.recorded},
                                {"replayed", first.replayed},
                                {"primitive", value_or_null(first.primitive)},
                                {"triangle", value_or_null(first.triangle)},
                                {"ulp", value_or_null(first.ulp)},
                                {"recorded_build", first.recorded_build},
                                {"replayed_build", first.replayed_build}};
  }
  return json;
}

std::string divergence_text(const ReplayResult& result, const std::string& verb, bool both_hands) {
  const std::string ticks = grouped(result.ticks) + (result.ticks == 1 ? " tick " : " ticks ") +
                            (both_hands ? "of both hands " : "") + verb;
  if (!result.first_divergence) return "Identical: " + ticks + ", every bit the same.\n";
  const Divergence& first = *result.first_divergence;
  Table table;
  table.add("diverged at", "tick " + grouped(first.tick) + " (" + ticks + ")");
  table.add("stage", first.stage);
  if (first.primitive) table.add("primitive", std::to_string(*first.primitive));
  if (first.triangle) table.add("triangle", std::to_string(*first.triangle));
  const std::string other = verb == "compared" ? "the other" : verb;
  table.add("field", first.field);
  table.add("recorded", first.recorded);
  table.add(other, first.replayed);
  if (first.ulp) table.add("distance", grouped(*first.ulp) + " ulp");
  table.add("recorded by", first.recorded_build);
  table.add(other + " by", first.replayed_build);
  if (first.field == "hash" && verb == "replayed")
    table.add("", "what was recorded cannot be computed here: run replay --trace FILE --trace-tick " +
                      std::to_string(first.tick) + " on both machines and compare the files");
  return table.text();
}

}  // namespace lumbrical::tool
