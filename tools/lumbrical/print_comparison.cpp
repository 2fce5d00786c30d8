// See print_comparison.h.
#include "print_comparison.h"

#include "output.h"

namespace lumbrical::tool {
namespace {

Json json_of(const PrecisionFigures& rung) {
  return {{"precision", rung.precision},
          {"tick_us", {{"p50", rung.median_us}, {"p99", rung.p99_us}}},
          {"hand_error", {{"p98", rung.hand_error}, {"max", rung.worst_hand_error}}},
          {"segment_error", {{"p98", rung.segment_error}}}};
}

Json json_of(const PrecisionComparison& comparison) {
  Json rungs = Json::array();
  for (const PrecisionFigures& rung : comparison.rungs) rungs.push_back(json_of(rung));
  Json result;
  result["ticks"] = comparison.ticks;
  result["rungs"] = std::move(rungs);
  if (comparison.exact_for_each) result["exact_for_each"] = json_of(*comparison.exact_for_each);
  result["advised"] = comparison.rungs[comparison.advised].precision;
  return result;
}

std::string text_of(const PrecisionFigures& rung) {
  return "tick " + brief(rung.median_us) + " us, p99 " + brief(rung.p99_us) + " us   error 98 % " +
         brief(rung.hand_error) + ", worst " + brief(rung.worst_hand_error) +
         " of the hand's force; of a segment 98 % " + brief(rung.segment_error);
}

std::string advice_of(const PrecisionComparison& comparison) {
  if (comparison.ticks == 0) return "nothing was touched: nothing to compare";
  const double precision = comparison.rungs[comparison.advised].precision;
  return "--precision " + precision_name(precision) +
         (precision == 0 && comparison.exact_for_each ? " and \"felt_once\": \"always\" in the scene" : "") +
         (comparison.mixed ? ", of all segments alike: the scene's own are mixed" : "");
}

void add_rows(const PrecisionComparison& comparison, Table& table) {
  table.add("compared", grouped(comparison.ticks) + " moments in which the hand feels more than 0.05 N");
  for (const PrecisionFigures& rung : comparison.rungs)
    table.add(precision_name(rung.precision), text_of(rung));
  if (comparison.exact_for_each)
    table.add("",
              "exact feels here once what parts of the hand hold together (\"felt_once\": \"always\"); for "
              "each part, as the scene has it: " +
                  text_of(*comparison.exact_for_each));
  table.add("advice", advice_of(comparison));
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
