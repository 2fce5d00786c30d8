// See winding_text.h.
#include "winding_text.h"

#include <cmath>

namespace lumbrical::tool {
namespace {

std::string share_text(double share) { return std::to_string(std::lround(100 * share)) + " %"; }

std::string parts(std::size_t count) { return grouped(count) + (count == 1 ? " part" : " parts"); }

std::string triangles(std::size_t count) {
  return grouped(count) + (count == 1 ? " triangle stands" : " triangles stand");
}

std::string facing(const WindingReport& report) {
  const double facing = report.outward_area + report.inward_area;
  if (!(facing > 0.01 * report.open_area))
    return "flat: felt from the side its triangles face, and not where others face the other way there";
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
  json["double_triangles"] = report.double_triangles;
  json["back_to_back_triangles"] = report.back_to_back_triangles;
  return json;
}

std::vector<std::string> winding_sentences(const WindingReport& report) {
  std::vector<std::string> sentences;
  if (report.turned_parts > 0)
    sentences.push_back(grouped(report.turned_parts) + " of " + parts(report.parts) +
                        " turned outside out, " + grouped(report.turned_triangles) + " triangles");
  else if (report.turned_triangles > 0)
    sentences.push_back("all " + grouped(report.turned_triangles) + " triangles turned, as asked");
  const bool all_back_to_back = 2 * report.back_to_back_triangles >= report.open_triangles;
  if (report.open_parts > 0 && !all_back_to_back)
    sentences.push_back(parts(report.open_parts) + " not closed, left as wound: " + facing(report) +
                        R"(; if it pulls, say "winding": "flip")");
  if (report.double_triangles > 0)
    sentences.push_back(triangles(report.double_triangles) +
                        " there twice, and felt twice; lumbrical inspect --fix leaves the second ones out");
  if (report.back_to_back_triangles > 0)
    sentences.push_back(triangles(report.back_to_back_triangles) +
                        " back to back with others: what both push cancels, so neither side is felt but by a "
                        "proxy (settings.proxy_stiffness); else leave out the side that nobody touches");
  return sentences;
}

Json windings_json(const std::vector<World::Object>& objects) {
  Json windings = Json::array();
  for (const World::Object& object : objects)
    windings.push_back({{"name", object.name}, {"winding", to_json(object.winding)}});
  return windings;
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
