// See print_comparison.h.
#include "print_comparison.h"

#include <algorithm>

#include "output.h"

namespace lumbrical::tool {
namespace {

Json json_of(const PrecisionFigures& rung) {
  return {{"precision", rung.precision},
          {"tick_us", {{"p50", rung.median_us}, {"p99", rung.p99_us}}},
          {"wall_us", {{"p50", rung.wall_median_us}, {"p99", rung.wall_p99_us}}},
          {"coarsened", rung.coarsened},
          {"max_evaluations", rung.max_evaluations},
          {"hand_error", {{"p98", rung.hand_error}, {"max", rung.worst_hand_error}}},
          {"segment_error", {{"p98", rung.segment_error}}}};
}

const PrecisionFigures& advised(const PrecisionComparison& comparison) {
  return comparison.rungs[comparison.advised];
}

bool keeps(double rate, const PrecisionFigures& rung) { return rung.p99_us <= 1e6 / rate; }

Json json_of(const PrecisionComparison& comparison, std::optional<double> rate) {
  Json rungs = Json::array();
  for (const PrecisionFigures& rung : comparison.rungs) rungs.push_back(json_of(rung));
  Json result;
  result["ticks"] = comparison.ticks;
  result["clock"] = comparison.by_processor_time ? "processor" : "wall";
  result["rungs"] = std::move(rungs);
  if (comparison.exact_for_each) result["exact_for_each"] = json_of(*comparison.exact_for_each);
  if (comparison.own) result["own"] = json_of(*comparison.own);
  result["advised"] = advised(comparison).precision;
  result["cut_by_effort"] = comparison.cut_by_effort;
  if (rate && comparison.ticks > 0) result["keeps_rate"] = keeps(*rate, advised(comparison));
  return result;
}

std::string text_of(const PrecisionFigures& rung) {
  return "tick " + brief(rung.median_us) + " us, p99 " + brief(rung.p99_us) + " us   error 98 % " +
         brief(rung.hand_error) + ", worst " + brief(rung.worst_hand_error) +
         " of the hand's force; of a segment 98 % " + brief(rung.segment_error) +
         (rung.coarsened > 0 ? "; coarsened " + grouped(rung.coarsened) + " times" : "");
}

std::size_t segments_by_law(const Settings& settings) {
  return static_cast<std::size_t>(
      std::count_if(settings.law.begin(), settings.law.end(), [](Law law) { return law != Law::field; }));
}

bool has_exact(const Settings& settings) {
  const auto& precision = settings.precision;
  return std::find(precision.begin(), precision.end(), 0.0) != precision.end();
}

std::string effort_text(const PrecisionComparison& comparison) {
  const PrecisionFigures& rung = advised(comparison);
  std::string text = "--precision " + precision_name(rung.precision) + ": \"effort\" " +
                     grouped(comparison.settings.effort) +
                     " lets none keep the precision wanted. This one is coarsened in " +
                     grouped(rung.coarsened) + " moments, and off by " + brief(rung.hand_error) +
                     " of the hand's force; a larger effort and a lower rate help";
  if (rung.max_evaluations > comparison.settings.effort)
    text += "; it can't do with less than " + grouped(rung.max_evaluations) + " evaluations";
  return text;
}

std::string advice_of(const PrecisionComparison& comparison) {
  if (comparison.ticks == 0) return "nothing was touched: nothing to compare";
  const std::size_t by_law = segments_by_law(comparison.settings);
  if (by_law == kSegmentCount)
    return "none: other laws than field are always exact, so no precision changes anything here; what takes "
           "less time is --law field";
  std::string text;
  if (comparison.cut_by_effort) {
    text = effort_text(comparison);
  } else {
    const double precision = advised(comparison).precision;
    text = "--precision " + precision_name(precision);
    if (precision == 0 && comparison.exact_for_each)
      text += " and \"felt_once\": \"always\" in the scene, or what parts hold together is felt by each";
    if (precision == 0 && comparison.settings.effort > 0) text += "; no effort bounds what is exact";
  }
  if (comparison.own) text += ", of all segments alike: the scene's own are mixed";
  if (comparison.own && advised(comparison).precision > 0 && has_exact(comparison.settings))
    text += ", and the exact ones among them exact only as it is";
  if (by_law > 0) text += "; segments of other laws than field (" + grouped(by_law) + ") are always exact";
  return text;
}

std::string rate_text(const PrecisionComparison& comparison, double rate) {
  const PrecisionFigures& rung = advised(comparison);
  const std::string wanted = grouped(static_cast<std::uint64_t>(rate)) + " Hz",
                    period = brief(1e6 / rate) + " us";
  if (keeps(rate, rung)) return "keeps " + wanted + ": 99 of 100 ticks that touch are within " + period;
  for (const PrecisionFigures& other : comparison.rungs)
    if (keeps(rate, other) && other.precision > rung.precision)
      return "does not keep " + wanted + ", a period of " + period + "; --precision " +
             precision_name(other.precision) + " does";
  return "does not keep " + wanted + ", a period of " + period +
         ", and no coarser one does; a lower rate, or an effort, helps";
}

void add_rows(const PrecisionComparison& comparison, std::optional<double> rate, Table& table) {
  table.add("compared",
            grouped(comparison.ticks) + " moments in which the hand feels more than 0.05 N; times are " +
                (comparison.by_processor_time
                     ? "processor time: what other work takes is not in them"
                     : "of the clock on the wall, other work's included, since several threads compute"));
  for (const PrecisionFigures& rung : comparison.rungs)
    table.add(precision_name(rung.precision), text_of(rung));
  if (comparison.exact_for_each)
    table.add("",
              "exact feels here once what parts of the hand hold together (\"felt_once\": \"always\"); for "
              "each part, as the scene has it: " +
                  text_of(*comparison.exact_for_each));
  if (comparison.own) table.add("as it is", text_of(*comparison.own));
  table.add("advice", advice_of(comparison));
  if (rate && comparison.ticks > 0) table.add("", rate_text(comparison, *rate));
}

}  // namespace

int print_comparison(const std::vector<HandComparison>& hands, std::optional<double> rate, bool json) {
  const bool both = hands.size() > 1;
  if (json && !both) return print_json(json_of(hands[0].comparison, rate));
  Json result;
  Table table;
  for (const auto& [side, comparison] : hands) {
    if (both) {
      Json of_hand = json_of(comparison, rate);
      of_hand["side"] = side_name(side);
      result["hands"].push_back(std::move(of_hand));
      table.add("hand", std::string(side_name(side)));
    }
    add_rows(comparison, rate, table);
  }
  return json ? print_json(result) : print_text(table.text());
}

}  // namespace lumbrical::tool
