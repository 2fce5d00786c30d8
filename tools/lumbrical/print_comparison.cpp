// See print_comparison.h.
#include "print_comparison.h"

#include "output.h"

namespace lumbrical::tool {
namespace {

std::string rung_name(double precision) { return precision > 0 ? brief(precision) : "exact"; }

}  // namespace

int print_comparison(const PrecisionComparison& comparison, bool json) {
  if (json) {
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
    return print_json(result);
  }
  Table table;
  table.add("compared", grouped(comparison.ticks) + " moments in which the hand feels more than 0.05 N");
  for (const PrecisionFigures& rung : comparison.rungs) {
    table.add(rung_name(rung.precision),
              "tick " + brief(rung.median_us) + " us, p99 " + brief(rung.p99_us) + " us   error 98 % " +
                  brief(rung.hand_error) + ", worst " + brief(rung.worst_hand_error) +
                  " of the hand's force; of a segment 98 % " + brief(rung.segment_error));
  }
  table.add("advice", comparison.ticks == 0
                          ? std::string("nothing was touched: nothing to compare")
                          : "--precision " + rung_name(comparison.rungs[comparison.advised].precision));
  return print_text(table.text());
}

}  // namespace lumbrical::tool
