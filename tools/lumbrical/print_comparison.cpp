// See print_comparison.h.
#include "print_comparison.h"

#include "output.h"

namespace lumbrical::tool {
namespace {

Json json_of(const PrecisionComparison& comparison) {
  Json rungs = Json::array();
  for (const PrecisionFigures& rung : comparison.rungs) {
    rungs.push_back({{"precision", rung.precision},
                     {"tick_us", {{"p50", rung.median_us}, {"p99", rung.p99_us}}},
                     {"hand_error", {{"p98", rung.hand_error}, {"max", rung.worst_hand_error}}},
                     {"segment_error", {{"p98", rung.segment_error}}}});
  }
  Json result;
  result["ticks"] = comparison.ticks;
  result["rungs"] = std::move(rungs);
  result["advised"] = comparison.rungs[comparison.advised].precision;
  return result;
}

void add_rows(const PrecisionComparison& comparison, Table& table) {
  table.add("compared", grouped(comparison.ticks) + " moments in which the hand feels more than 0.05 N");
  for (const PrecisionFigures& rung : comparison.rungs) {
    table.add(precision_name(rung.precision),
              "tick " + brief(rung.median_us) + " us, p99 " + brief(rung.p99_us) + " us   error 98 % " +
                  brief(rung.hand_error) + ", worst " + brief(rung.worst_hand_error) +
                  " of the hand's force; of a segment 98 % " + brief(rung.segment_error));
  }
  table.add("advice",
            comparison.ticks == 0
                ? std::string("nothing was touched: nothing to compare")
                : "--precision " + precision_name(comparison.rungs[comparison.advised].precision) +
                      (comparison.mixed ? ", of all segments alike: the scene's own are mixed" : ""));
}

}  // namespace

int print_comparison(const std::vector<HandComparison>& hands, bool json) {
  const bool both = hands.size() > 1;
  if (json && !both) return print_json(json_of(hands[0].comparison));
  Json result;
  Table table;
  for (const auto& [side, comparison] : hands) {
    if (both) {
      Json of_hand = json_of(comparison);
      of_hand["side"] = side_name(side);
      result["hands"].push_back(std::move(of_hand));
      table.add("hand", std::string(side_name(side)));
    }
    add_rows(comparison, table);
  }
  return json ? print_json(result) : print_text(table.text());
}

}  // namespace lumbrical::tool
