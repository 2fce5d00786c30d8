// The report's first picture, and what other libraries and real meshes are held against.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "report_pages.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

TEST(Report, TheFirstPictureHasOurRungsAsALineAndOthersByNameUnderTheDeadline) {
  const fs::path folder = fresh_folder();
  fs::create_directory(folder / "results");
  std::ofstream(folder / "results" / "peers.json") << peers_of({{"A drape", "ours, exact", 9522, 320, 0},
                                                                {"A drape", "ours, 1e-4", 9522, 60, 2e-5},
                                                                {"A drape", "ours, 1e-3", 9522, 40, 3e-4},
                                                                {"A drape", "theirs", 9522, 2100, 0.02},
                                                                {"A drape", "their area", 9522, 950, 0.04},
                                                                {"A drape", "their twin", 9522, 950, 0.04},
                                                                {"A drape", "ours, 1e-4", 100352, 200, 1e-5},
                                                                {"A drape", "theirs", 100352, 9000, 0.02},
                                                                {"A tips", "ours, 1e-4", 9522, 20, 1e-4}});
  std::ofstream(folder / "results" / "tick.json") << google_of(
      {{"A_drape/1e-4/9522",
        {{"p50_us", 90}, {"processor_p50_us", 80}, {"force_error", 1e-5}, {"triangles", 9522}}}});
  const Outcome outcome = shell("lumbrical report results", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const std::string page = read_file((folder / "report.html").string());
  const std::string title = "Whole hand, pressed in: 9,522 triangles";
  const std::size_t first = page.find("<text class=\"title\"");
  ASSERT_EQ(page.find(">" + title), page.find('>', first)) << "it comes first";
  EXPECT_NE(page.find("Four fingertips: 9,522 triangles"), std::string::npos);
  EXPECT_NE(page.find("leaves out the &lt;hard&gt; part"), std::string::npos);
  const std::size_t answer = page.find(
      "Whole hand, pressed in, 9,522 triangles: a tick takes 60.0 us at an error of 2.0e-05, or 320 us "
      "without "
      "an error. The fastest of other libraries, their area, takes 950 us at an error of 4.0e-02.");
  EXPECT_LT(answer, first) << "in words, above it";

  const std::string plot = plot_in(page, title);
  auto marks = marks_in(plot);
  ASSERT_EQ(marks.size(), 7u) << plot;
  const auto x = ticks_in(plot, 'x'), y = ticks_in(plot, 'y');
  EXPECT_NEAR(read_off(y, marks["ours, exact"].y) / 320, 1, 0.01);
  EXPECT_NEAR(read_off(x, marks["theirs"].x) / 0.02, 1, 0.01);
  EXPECT_NEAR(read_off(y, marks["theirs"].y) / 2100, 1, 0.01);
  EXPECT_NEAR(read_off(y, marks["tick_bench"].y) / 80, 1, 0.01) << "processor time, as beside it";
  std::smatch match;
  ASSERT_TRUE(std::regex_search(plot, match, std::regex(R"re(<text class="x" x="([0-9.]+)"[^>]*>exact<)re")));
  EXPECT_NEAR(marks["ours, exact"].x, std::stod(match[1]), 0.01) << "no error stands left of the axis";
  ASSERT_TRUE(std::regex_search(plot, match, std::regex(R"re(class="deadline" d="M[0-9.]+ ([0-9.]+)H)re")));
  EXPECT_NEAR(read_off(y, std::stod(match[1])) / 1000, 1, 0.01);
  ASSERT_TRUE(std::regex_search(plot, match, std::regex(R"re(class="line s0" d="([^"]*)")re")));
  const std::string line = match[1];
  EXPECT_EQ(std::count(line.begin(), line.end(), 'L'), 2) << "three rungs: " << line;

  const auto names = names_in(plot);
  for (const char* const name : {"exact", "1e-4", "1e-3", "theirs", "their area", "their twin"})
    EXPECT_TRUE(names.contains(name)) << name;
  for (const auto& [name, at] : names) {
    for (const auto& [other, place] : names) {
      const bool beside = at.right < place.left || place.right < at.left;
      if (name != other) {
        EXPECT_TRUE(beside || std::abs(at.y - place.y) > 9) << name << " on " << other;
      }
    }
  }
}

TEST(Report, EveryJobHasItsPictureAndOnlyWhatDoesItIsRingedAsUnbeaten) {
  const fs::path folder = fresh_folder();
  fs::create_directory(folder / "results");
  std::ofstream(folder / "results" / "peers.json")
      << peers_of({{"A one finger", "ours, exact", 9522, 12, 0},
                   {"A one finger", "ours, 1e-4", 9522, 10, 1e-4},
                   {"A one finger", "theirs", 9522, 90, 0.02},
                   {"A one finger", "probes [8]", 9522, 5, 0.4}});
  const auto tick_of = [](double time, double error, double triangles) {
    return Json{
        {"p50_us", time}, {"processor_p50_us", time}, {"force_error", error}, {"triangles", triangles}};
  };
  Json paper = tick_of(64, 0.9, 9522);
  paper["paper_hz"] = 700;
  std::ofstream(folder / "results" / "tick.json")
      << google_of({{"A_one_finger/1e-4/9522", tick_of(8, 1e-5, 9522)},
                    {"A_drape/1e-4/9999392", tick_of(6000, 1e-5, 9999392)},
                    {"A_drape/exact/9999392", tick_of(120000, 0, 9999392)},
                    {"table2_row_10/field/9522/levels_6", tick_of(24, 1e-4, 9522)},
                    {"table2_row_10/max-depth/9522/levels_6", paper}});
  ASSERT_EQ(shell("lumbrical report results", folder).exit_code, 0);
  const std::string page = read_file((folder / "report.html").string());
  const auto rings = [&](const std::string& plot) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = plot.find("class=\"ring\"", at)) != std::string::npos; ++at) ++count;
    return count;
  };
  const std::string finger = plot_in(page, "One finger: 9,522 triangles");
  EXPECT_EQ(rings(finger), 3u) << "exact, 1e-4 and the probes; the other hand's point does another job";
  EXPECT_NE(finger.find("leaves out the &lt;hard&gt; part"), std::string::npos);
  EXPECT_NE(finger.find("--benchmark_filter=&#39;^A_one_finger/1e-4/9522"), std::string::npos);
  EXPECT_NE(finger.find("just noticeable"), std::string::npos);
  const std::string table2 = plot_in(page, "The paper&#39;s Table 2, row 10: 52 contacts");
  EXPECT_NEAR(read_off(ticks_in(table2, 'y'), marks_in(table2)["the paper, Table 2, row 10"].y) * 700 / 1e6,
              1, 0.01);
  EXPECT_EQ(names_in(plot_in(page, "A huge world: 9,999,392 triangles")).size(), 2u);
}

TEST(Report, TwoFoldersAreComparedInWordsTheBadNewsFirst) {
  const fs::path folder = fresh_folder();
  for (const bool after : {false, true}) {
    const fs::path results = folder / (after ? "after" : "before");
    fs::create_directory(results);
    const auto row = [&](double before, double now, double error) {
      return Json{{"p50_us", after ? now : before}, {"force_error", error}, {"triangles", 162}};
    };
    std::ofstream(results / "tick.json")
        << google_of({{"A_drape/1e-4/162", row(10, 21, after ? 3e-5 : 1e-5)},
                      {"A_tips/1e-4/162", row(10, 11, 1e-5)},
                      {"B_drape/exact/162", row(10, 4, 0)},
                      {after ? "new/1e-4/162" : "old/1e-4/162", row(10, 10, 0)}});
  }
  ASSERT_EQ(shell("lumbrical report before after", folder).exit_code, 0);
  const std::string page = read_file((folder / "report.html").string());
  std::size_t at = page.find("From before to after");
  ASSERT_LT(at, page.find("How fast, at which error")) << "it comes first";
  for (const char* const words :
       {"1 of 3 is slower by more than 15 %, most A_drape/1e-4/162 (2.10 times as long)",
        "1 of 3 is less accurate, most A_drape/1e-4/162 (1.0e-05 -&gt; 3.0e-05)",
        "1 of 3 is faster by more than 15 %, most B_drape/exact/162 (2.50 times as fast)",
        "None is more accurate"}) {
    const std::size_t next = page.find(words, at);
    ASSERT_NE(next, std::string::npos) << words << "\n" << page.substr(at, 1500);
    at = next;
  }
}

TEST(Report, OthersAreHeldAgainstOurDefaultRungSceneByScene) {
  const fs::path folder = fresh_folder();
  fs::create_directory(folder / "results");
  std::ofstream(folder / "results" / "peers.json") << peers_of({{"A drape", "ours, exact", 1682, 1, 0},
                                                                {"A drape", "ours, 1e-4", 1682, 10, 0},
                                                                {"A drape", "their area", 1682, 130, 0},
                                                                {"A drape", "theirs", 1682, 90, 0},
                                                                {"A drape", "ours, 1e-4", 162, 10, 0},
                                                                {"A drape", "their area", 162, 40, 0},
                                                                {"A tips", "ours, 1e-4", 162, 10, 0},
                                                                {"A tips", "their area", 162, 12, 0},
                                                                {"A tips", "theirs", 162, 15, 0},
                                                                {"B drape", "ours, 1e-4", 9522, 10, 0},
                                                                {"B drape", "theirs", 9522, 260, 0},
                                                                {"B drape", "their area", 9522, 110, 0}});
  ASSERT_EQ(shell("lumbrical report results --targets targets.md", folder).exit_code, 0);
  const std::string targets = read_file((folder / "targets.md").string());
  for (const char* const row :
       {"| at least 12.0 times | 11.0 times | MISSED | bench_peers: B drape, 9,522 triangles, their area |",
        "| at least 5.00 times | 4.00 times | MISSED | bench_peers: A drape, 162 triangles, their area |",
        "| at least 1.00 times | 1.20 times | yes | bench_peers: A tips, 162 triangles, their area |",
        "| at least 25.0 times | 26.0 times | yes | bench_peers: B drape, 9,522 triangles, theirs |",
        "| at least 8.00 times | 9.00 times | yes | bench_peers: A drape, 1,682 triangles, theirs |",
        "| at least 2.00 times | 1.50 times | MISSED | bench_peers: A tips, 162 triangles, theirs |"})
    EXPECT_NE(targets.find(row), std::string::npos) << row << "\n" << targets;
}

Json meshes_of(const std::vector<std::pair<const char*, double>>& p99) {
  Json rows = Json::array();
  for (const auto& [mesh, time] : p99) {
    for (const char* const rung : {"exact", "1e-4"}) {
      const bool exact = rung == std::string("exact");
      rows.push_back({{"mesh", mesh},
                      {"triangles", 69451},
                      {"contacts", 4204.5},
                      {"moments", 80},
                      {"rung", rung},
                      {"median_us", exact ? 900 : 100},
                      {"p99_us", exact ? 2000 : time},
                      {"hand_error", exact ? 0 : 9e-5},
                      {"worst_hand_error", exact ? 0 : 1e-3},
                      {"segment_error", exact ? 0 : 4e-4}});
    }
  }
  return {
      {"cpu", "x"},    {"isa", "avx2"}, {"compiler", "c"}, {"flags", ""}, {"command", "bench/mesh_grasps"},
      {"meshes", rows}};
}

TEST(Report, RealMeshesAreDrawnByPrecisionAndTheWorstOfThemIsHeldAgainstTheTargets) {
  const fs::path folder = fresh_folder();
  fs::create_directory(folder / "results");
  std::ofstream(folder / "results" / "meshes.json") << meshes_of({{"bunny.obj", 300}, {"igea.ply", 410}});
  const Outcome outcome = shell("lumbrical report results --targets targets.md --json", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(outcome.json()["figures"], 1);
  const std::string plot =
      plot_in(read_file((folder / "report.html").string()), "bunny.obj, 69,451 triangles");
  EXPECT_EQ(names_in(plot).size(), 2u);
  EXPECT_NEAR(read_off(ticks_in(plot, 'y'), marks_in(plot)["bunny.obj, exact"].y) / 900, 1, 0.01);
  const std::string targets = read_file((folder / "targets.md").string());
  for (const char* const row : {"| at most 400 us at p99 | 410 us at p99 | MISSED | meshes/igea.ply/1e-4 |",
                                "the worst segment's | MISSED | meshes/"})
    EXPECT_NE(targets.find(row), std::string::npos) << row << "\n" << targets;
  Json bad = meshes_of({{"bunny.obj", 300}});
  bad["meshes"][1].erase("p99_us");
  std::ofstream(folder / "results" / "meshes.json") << bad;
  const Outcome refused = shell("lumbrical report results", folder);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.error.find("meshes[1].p99_us"), std::string::npos) << refused.error;
}

}  // namespace
}  // namespace lumbrical::test
