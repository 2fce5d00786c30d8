// What the report draws beside points: curves, stacked bars, and its first picture as a file.
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <utility>

#include "report_pages.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

TEST(Report, CurvesRunThroughTheirPointsOnPlainAxes) {
  const fs::path folder = fresh_folder();
  fs::create_directory(folder / "results");
  const Json curve = {{"series", "a <law>"}, {"x", {-20, 0, 12.5}}, {"y", {0, 3, 1.5}}};
  const Json figure = {{"title", "Figure 12"},
                       {"note", "a note"},
                       {"panels",
                        {{{"title", "Onto a slope"},
                          {"x_label", "way [mm]"},
                          {"y_label", "force [N]"},
                          {"curves", Json::array({curve})}}}}};
  const Json paper = {
      {"title", "The paper"}, {"command", "paper_experiments"}, {"figures", Json::array({figure})}};
  std::ofstream(folder / "results" / "paper.json") << paper;
  const Outcome outcome = shell("lumbrical report results --json", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(outcome.json()["figures"], 1);
  const std::string plot = plot_in(read_file((folder / "report.html").string()), "Onto a slope");
  EXPECT_NE(plot.find("<title>a &lt;law&gt;</title>"), std::string::npos) << plot;
  std::smatch path;
  ASSERT_TRUE(std::regex_search(
      plot, path,
      std::regex(R"re(class="line s0" d="M([0-9.]+) ([0-9.]+)L([0-9.]+) ([0-9.]+)L([0-9.]+) ([0-9.]+)")re")))
      << plot;
  // Read off the axes as a person would, from their outermost labels.
  const auto value = [](const std::map<double, double>& ticks, const std::string& at) {
    const auto [low, low_place] = *ticks.begin();
    const auto [high, high_place] = *ticks.rbegin();
    return low + (high - low) * (std::stod(at) - low_place) / (high_place - low_place);
  };
  for (int i = 0; i < 3; ++i) {
    const auto point = static_cast<std::size_t>(i);
    EXPECT_NEAR(value(ticks_in(plot, 'x'), path[2 * point + 1]), curve["x"][point], 0.02);
    EXPECT_NEAR(value(ticks_in(plot, 'y'), path[2 * point + 2]), curve["y"][point], 0.01);
  }

  for (const char* const bad : {R"("x": [1, 2])", R"("x": [1, 2, "3"])", R"("x": [])", R"("x": {})"}) {
    std::string text = paper.dump();
    const std::size_t at = text.find("\"x\":");
    text.replace(at, text.find(']', at) + 1 - at, bad);
    std::ofstream(folder / "results" / "paper.json") << text;
    const Outcome refused = shell("lumbrical report results", folder);
    EXPECT_EQ(refused.exit_code, 2) << bad;
    EXPECT_NE(refused.error.find("figures[0].panels[0].curves[0]."), std::string::npos) << refused.error;
  }
}

TEST(Report, BarsAreAsLongAsTheirPartsTogether) {
  const fs::path folder = fresh_folder();
  fs::create_directory(folder / "results");
  const Json stages = {
      {"cpu", "x"},
      {"isa", "sse2"},
      {"compiler", "c"},
      {"flags", ""},
      {"command", "stage_times"},
      {"note", "a note"},
      {"stages", {"search", "contacts"}},
      {"scenes", {{{"scene", "one"}, {"stage_us", {1, 3}}}, {{"scene", "two"}, {"stage_us", {6, 10}}}}}};
  std::ofstream(folder / "results" / "stages.json") << stages;
  ASSERT_EQ(shell("lumbrical report results", folder).exit_code, 0);
  const std::string page = read_file((folder / "report.html").string());
  static const std::regex bar(
      R"re(<rect class="point s\d" x="([0-9.]+)" [^>]*width="([0-9.]+)"[^>]*><title>([^<]*)</title>)re");
  std::map<std::string, std::pair<double, double>> bars;
  for (std::sregex_iterator match(page.begin(), page.end(), bar), end; match != end; ++match)
    bars[(*match)[3]] = {std::stod((*match)[1]), std::stod((*match)[2])};
  ASSERT_EQ(bars.size(), 4u);
  const auto [left, width] = bars["two, search: 6.00 us"];
  EXPECT_NEAR(bars["two, contacts: 10.0 us"].first, left + width, 0.02);
  EXPECT_NEAR(bars["one, contacts: 3.00 us"].second, width / 2, 0.02);
  EXPECT_NEAR(bars["one, search: 1.00 us"].first, left, 0.02);
  std::string text = stages.dump();
  text.replace(text.find("[1,3]"), 5, "[1]");
  std::ofstream(folder / "results" / "stages.json") << text;
  const Outcome refused = shell("lumbrical report results", folder);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.error.find("scenes[0].stage_us"), std::string::npos) << refused.error;
}

TEST(Report, TheFirstPictureIsAFileOfItsOwn) {
  const fs::path folder = fresh_folder();
  fs::create_directory(folder / "results");
  std::ofstream(folder / "results" / "peers.json")
      << peers_of({{"A drape", "ours, 1e-4", 200, 10.0, 1e-5}, {"A drape", "theirs", 200, 40.0, 0.3}});
  ASSERT_EQ(shell("lumbrical report results --picture front.svg", folder).exit_code, 0);
  const std::string picture = read_file((folder / "front.svg").string());
  EXPECT_EQ(picture.find("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox="), 0u) << picture.substr(0, 100);
  for (const char* const said : {"--s0:", ".s0.point", ">theirs</text>", "other libraries</text>"})
    EXPECT_NE(picture.find(said), std::string::npos) << said;
  for (const char* const foreign : {"<script", "href=", "url(", "@import"})
    EXPECT_EQ(picture.find(foreign), std::string::npos) << foreign;
  std::ofstream(folder / "results" / "peers.json")
      << google_of({{"A/tree/162", {{"candidates", 9}, {"triangles", 162}}}});
  const Outcome without = shell("lumbrical report results --picture front.svg", folder);
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_NE(without.error.find("add those of bench_peers"), std::string::npos) << without.error;
}

}  // namespace
}  // namespace lumbrical::test
