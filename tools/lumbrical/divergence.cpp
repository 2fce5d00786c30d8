// See divergence.h.
#include "divergence.h"

namespace lumbrical::tool {

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
                                {"replayed", first.replayed}};
  }
  return json;
}

std::string divergence_text(const ReplayResult& result, const std::string& verb) {
  if (!result.first_divergence)
    return "Identical: " + grouped(result.ticks) + " ticks " + verb + ", every bit the same.\n";
  const Divergence& first = *result.first_divergence;
  Table table;
  table.add("diverged at",
            "tick " + grouped(first.tick) + " (" + grouped(result.ticks) + " ticks " + verb + ")");
  table.add("stage", first.stage);
  table.add("field", first.field);
  table.add("recorded", first.recorded);
  table.add(verb == "compared" ? "the other" : verb, first.replayed);
  return table.text();
}

}  // namespace lumbrical::tool
