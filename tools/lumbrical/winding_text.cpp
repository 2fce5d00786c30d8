// See winding_text.h.
#include "winding_text.h"

#include <cmath>

namespace lumbrical::tool {
namespace {

std::string share_text(double share) { return std::to_string(std::lround(100 * share)) + " %"; }

std::string parts(std::size_t count) { return grouped(count) + (count == 1 ? " part" : " parts"); }

std::string facing(const WindingReport& report) {
  const double facing = report.outward_area + report.inward_area;
  if (!(facing > 0.01 * report.open_area)) return "flat: felt from the side its triangles face";
  return share_text(report.outward_area / facing) + " of its area faces away from its middle, " +
         share_text(report.inward_area / facing) + " towards it";
}

}  // namespace

Json to_json(const WindingReport& report) {
  Json json;
  json["parts"] = report.parts;
  json["inner_parts"] = report.inner_parts;
  json["turned_parts"] = report.turned_parts;
  json["turned_triangles"] = report.turned_triangles;
  json["open_parts"] = report.open_parts;
  json["open_triangles"] = report.open_triangles;
  json["hole_area"] = report.hole_area;
  json["open_area"] = report.open_area;
  json["outward_area"] = report.outward_area;
  json["inward_area"] = report.inward_area;
  return json;
}

std::vector<std::string> winding_sentences(const WindingReport& report) {
  std::vector<std::string> sentences;
  if (report.turned_parts > 0)
    sentences.push_back(grouped(report.turned_parts) + " of " + parts(report.parts) +
                        " turned outside out, " + grouped(report.turned_triangles) + " triangles");
  else if (report.turned_triangles > 0)
    sentences.push_back("all " + grouped(report.turned_triangles) + " triangles turned, as asked");
  if (report.open_parts > 0)
    sentences.push_back(parts(report.open_parts) + " not closed, left as wound: " + facing(report) +
                        R"(; if it pulls, say "winding": "flip")");
  return sentences;
}

void add_windings(const std::vector<World::Object>& objects, Table& table) {
  bool first = true;
  for (const World::Object& object : objects) {
    for (const std::string& sentence : winding_sentences(object.winding)) {
      table.add(first ? "winding" : "", object.name + ": " + sentence);
      first = false;
    }
  }
}

}  // namespace lumbrical::tool
