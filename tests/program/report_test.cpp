// The page that lumbrical report draws: points at their places on the axes, the Pareto front of small
// results, and what happens to files that are no results.
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "report_pages.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

struct Alternative {
  const char* law;
  const char* precision;
  double nanoseconds, error;
};

Json accuracy_of(const std::vector<Alternative>& alternatives) {
  Json json = {{"cpu", "a <b>processor</b>"},
               {"isa", "none"},
               {"compiler", "cc 1"},
               {"flags", "-O2"},
               {"pairs", 100},
               {"command", "bench/accuracy --pairs 100"},
               {"speeds", Json::array()},
               {"errors", Json::array()}};
  for (const Alternative& one : alternatives) {
    json["speeds"].push_back({{"law", one.law},
                              {"precision", one.precision},
                              {"shape", "sphere"},
                              {"angle", "any"},
                              {"ns_per_pair", one.nanoseconds}});
    json["errors"].push_back(
        {{"law", one.law},
         {"precision", one.precision},
         {"shape", "sphere"},
         {"angle", "all"},
         {"quantity", "volume"},
         {"unit", "R^3"},
         {"absolute", {{"median", one.error / 10}, {"p98", one.error}, {"worst", 10 * one.error}}}});
  }
  return json;
}

fs::path folder_with(const Json& json) {
  const fs::path folder = fresh_folder();
  fs::create_directory(folder / "results");
  std::ofstream(folder / "results" / "accuracy.json") << json.dump(1);
  return folder;
}

TEST(Report, PointsStandWhereTheAxesSayTheyDo) {
  const std::vector<Alternative> alternatives = {
      {"field", "exact", 3051, 7.77e-16}, {"field", "1e-2", 2613, 5e-7}, {"point", "exact", 516, 0}};
  const fs::path folder = folder_with(accuracy_of(alternatives));
  const Outcome outcome = shell("lumbrical report results --output page.html", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const std::string page = read_file((folder / "page.html").string());
  for (const auto& [title, factor] :
       {std::pair{"sphere, 98 % of the pairs", 1.0}, std::pair{"sphere, worst pair", 10.0}}) {
    const std::string plot = plot_in(page, title);
    const auto x = ticks_in(plot, 'x'), y = ticks_in(plot, 'y');
    auto marks = marks_in(plot);
    ASSERT_EQ(marks.size(), alternatives.size()) << title;
    for (const Alternative& one : alternatives) {
      const Mark mark = marks[std::string(one.law) + ", " + one.precision + ", sphere"];
      EXPECT_NEAR(read_off(y, mark.y) / one.nanoseconds, 1, 0.01) << one.law;
      if (one.error > 0) {
        EXPECT_NEAR(read_off(x, mark.x) / (factor * one.error), 1, 0.01) << one.law;
      } else {
        EXPECT_NEAR(mark.x, x.at(0), 0.01) << "what is exactly 0 stands above the 0";
      }
    }
  }
  EXPECT_NE(page.find("time [ns per pair]"), std::string::npos);
  EXPECT_NE(page.find("error [R^3; law point: R]"), std::string::npos);
}

TEST(Report, TheParetoFrontIsWhatNothingElseBeats) {
  // c is beaten by b in both, e ties with d in error and is slower, f equals b, g ties with a in time.
  const fs::path folder = folder_with(accuracy_of({{"a", "exact", 100, 1e-3},
                                                   {"b", "exact", 200, 1e-6},
                                                   {"c", "exact", 300, 1e-5},
                                                   {"d", "exact", 900, 0},
                                                   {"e", "exact", 950, 0},
                                                   {"f", "exact", 200, 1e-6},
                                                   {"g", "exact", 100, 1e-2}}));
  ASSERT_EQ(shell("lumbrical report results --output page.html", folder).exit_code, 0);
  const std::string page = read_file((folder / "page.html").string());
  EXPECT_EQ(front_of(page, "sphere, 98 % of the pairs"),
            (std::set<std::string>{"a, exact, sphere", "b, exact, sphere", "d, exact, sphere",
                                   "f, exact, sphere"}));
}

TEST(Report, ThePageStandsAloneAndTakesNamesLiterally) {
  const fs::path folder = folder_with(accuracy_of({{"<script>alert(1)</script>", "'\"&", 100, 1e-3}}));
  ASSERT_EQ(shell("lumbrical report results", folder).exit_code, 0);
  const std::string page = read_file((folder / "report.html").string());
  for (const char* const foreign :
       {"<script", "<b>", "src=", "href=", "http://", "https://", "@import", "url("})
    EXPECT_EQ(page.find(foreign), std::string::npos) << foreign;
  for (const char* const said : {"a &lt;b&gt;processor", "cc 1", "-O2", "bench/accuracy --pairs 100",
                                 "&lt;script&gt;", "&#39;&quot;&amp;", "prefers-color-scheme: dark"})
    EXPECT_NE(page.find(said), std::string::npos) << said;
}

TEST(Report, PeersAndGoogleBenchmarkAreDrawnOverTriangles) {
  const fs::path folder = fresh_folder();
  fs::create_directory(folder / "results");
  std::ofstream(folder / "results" / "peers.json") << peers_of({{"A drape", "ours, 1e-4", 200, 10.0, 0.0},
                                                                {"A drape", "theirs", 200, 40.0, 0.3},
                                                                {"A drape", "ours, 1e-4", 80000, 30.0, 0.0},
                                                                {"A drape", "theirs", 80000, 700.0, 0.2}});
  Json benchmarks = Json::array();
  for (const auto& [name, triangles, time] :
       {std::tuple{"grasp/field/mug_16", 400, 20.0}, std::tuple{"grasp/field/mug_64", 6400, 90.0}})
    benchmarks.push_back({{"name", name},
                          {"run_name", name},
                          {"run_type", "iteration"},
                          {"real_time", 1e3},
                          {"time_unit", "ns"},
                          {"p50_us", time},
                          {"triangles", triangles}});
  benchmarks.push_back({{"name", "pair/cone/edge_1R/exact/avx2"},
                        {"real_time", 5},
                        {"time_unit", "us"},
                        {"ns_per_pair", 150},
                        {"error_R3", 0}});
  benchmarks.push_back({{"name", "pair/cone/edge_1R/1e-2/avx2"},
                        {"real_time", 5},
                        {"time_unit", "us"},
                        {"ns_per_pair", 50},
                        {"error_R3", 1e-5}});
  benchmarks.push_back({{"name", "A/tree/162"},
                        {"real_time", 4e3},
                        {"time_unit", "ns"},
                        {"candidates", 9},
                        {"triangles", 162}});
  std::ofstream(folder / "results" / "tick.json")
      << Json{{"context", {{"executable", "bench/tick_bench"}, {"num_cpus", 2}, {"mhz_per_cpu", 2000}}},
              {"benchmarks", benchmarks}};
  const Outcome outcome = shell("lumbrical report results --json", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(outcome.json()["figures"], 5);
  const std::string page = read_file((folder / "report.html").string());
  EXPECT_EQ(front_of(page, "A drape, 200 triangles").size(), 1u);
  EXPECT_EQ(front_of(page, "cone, edge_1R").size(), 2u);
  const struct {
    const char *plot, *mark;
    double triangles, microseconds;
  } known[] = {{"A drape", "theirs, A drape, 80,000 triangles", 80000, 700},
               {"A drape", "ours, 1e-4, A drape, 200 triangles", 200, 10},
               {"grasp", "grasp/field/mug_64, 6400 triangles", 6400, 90},
               {"A", "A/tree/162, 162 triangles", 162, 4}};
  for (const auto& one : known) {
    const std::string plot = plot_in(page, one.plot);
    auto marks = marks_in(plot);
    ASSERT_TRUE(marks.contains(one.mark)) << one.mark << "\n" << plot;
    EXPECT_NEAR(read_off(ticks_in(plot, 'x'), marks[one.mark].x) / one.triangles, 1, 0.01) << one.mark;
    EXPECT_NEAR(read_off(ticks_in(plot, 'y'), marks[one.mark].y) / one.microseconds, 1, 0.01) << one.mark;
  }
}

TEST(Report, TicksAreDrawnOverForceErrorAndHeldAgainstTheTargets) {
  const fs::path folder = fresh_folder();
  fs::create_directory(folder / "results");
  std::vector<std::pair<const char*, Json>> benchmarks;
  // Of four, one is slower and no better than the first, and one is beaten in both.
  for (const auto& [name, time, error] : {std::tuple{"error_A/field/exact/tree_avx2", 90.0, 0.0},
                                          std::tuple{"error_A/field/exact/grid_avx2", 95.0, 0.0},
                                          std::tuple{"error_A/field/1e-3/tree_avx2", 40.0, 2e-4},
                                          std::tuple{"error_A/point/exact/tree_avx2", 60.0, 0.3}})
    benchmarks.emplace_back(
        name, Json{{"p50_us", time}, {"force_error", error}, {"triangles", 9522}, {"contacts", 900}});
  benchmarks.emplace_back("A_drape/1e-4/9522", Json{{"p50_us", 50},
                                                    {"processor_p50_us", 40},
                                                    {"processor_p99_us", 100},
                                                    {"triangles", 9522},
                                                    {"contacts", 900}});
  benchmarks.emplace_back("A_drape/1e-4/162",
                          Json{{"p50_us", 200}, {"p99_us", 210}, {"triangles", 162}, {"contacts", 90}});
  benchmarks.emplace_back("A_drape/1e-4/9522/2_threads",
                          Json{{"p50_us", 40}, {"triangles", 9522}, {"contacts", 900}});
  benchmarks.emplace_back("contacts/exact/1000",
                          Json{{"p50_us", 70}, {"triangles", 9522}, {"contacts", 1003}});
  benchmarks.emplace_back("build_A/tree/1002528/threads_2",
                          Json{{"triangles", 1002528}, {"bytes_per_triangle", 45.1}});
  benchmarks.emplace_back("search/threads:2/9522", Json{{"triangles", 9522}, {"candidates", 1700}});
  benchmarks.emplace_back("hands/threads:2/100", Json{{"hands", 100}});
  std::ofstream(folder / "results" / "tick.json") << google_of(benchmarks);
  const Outcome outcome = shell("lumbrical report results --targets targets.md --json", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(outcome.json()["figures"], 7);
  const std::string page = read_file((folder / "report.html").string());
  EXPECT_EQ(front_of(page, "A"),
            (std::set<std::string>{"error_A/field/exact/tree_avx2", "error_A/field/1e-3/tree_avx2"}));
  EXPECT_EQ(marks_in(plot_in(page, "contacts")).size(), 1u);
  EXPECT_EQ(marks_in(plot_in(page, "A_drape")).size(), 3u);
  EXPECT_EQ(marks_in(plot_in(page, "build_A")).size(), 1u);
  EXPECT_EQ(marks_in(plot_in(page, "search")).size(), 1u);
  EXPECT_EQ(marks_in(plot_in(page, "hands")).size(), 1u);
  for (const char* const title : {"Memory of a model", "What threads bring", "hands in one call"})
    EXPECT_NE(page.find(title), std::string::npos) << title;
  EXPECT_NE(page.find("<h2>Targets</h2>"), std::string::npos);
  const std::string targets = read_file((folder / "targets.md").string());
  for (const char* const row :
       {"| at most 60.0 us | 50.0 us | yes | A_drape/1e-4/9522 |",
        "| at most 1.50 times the median at p99 (processor time) | 2.50 times the median "
        "at p99 (processor time) | MISSED | A_drape/1e-4/9522 |",
        "| at most 45.0 us | 200 us | MISSED | A_drape/1e-4/162 |",
        "| at least 1.00 times | 1.25 times | yes | A_drape/1e-4/9522/2_threads |",
        "| at most 0.200 s | 0.150 s | yes | build_A/tree/1002528/threads_2 |",
        "| at most 50.0 bytes per triangle | 45.1 bytes per triangle | yes |"})
    EXPECT_NE(targets.find(row), std::string::npos) << row << "\n" << targets;
  std::ofstream(folder / "results" / "tick.json") << google_of(benchmarks, "avx512");
  ASSERT_EQ(shell("lumbrical report results --targets targets.md", folder).exit_code, 0);
  EXPECT_NE(read_file((folder / "targets.md").string())
                .find("| at most 45.0 us | 50.0 us | MISSED | A_drape/1e-4/9522 |"),
            std::string::npos)
      << "AVX-512 should be faster";
}

TEST(Report, ForeignFilesAreRefusedAndAGoodPageStays) {
  const Json good = accuracy_of({{"field", "exact", 100, 1e-3}});
  Json no_time = good, negative = good, text = good, slow = good, huge = good;
  no_time["speeds"] = Json::array();
  negative["errors"][0]["absolute"]["p98"] = -1;
  text["errors"][0]["absolute"]["worst"] = "small";
  slow["speeds"][0]["ns_per_pair"] = 0;
  huge["errors"][0]["absolute"]["worst"] = 1e300;
  const Json google = {{"context", {{"executable", "x"}, {"cpu", "c"}}}, {"benchmarks", {7}}};
  const std::pair<std::string, std::string> cases[] = {
      {"", "bad.json"},
      {"{\n \"cpu\": x}", "bad.json:2:9:"},
      {"{\"a\": NaN}", "bad.json:1:"},
      {"{\"a\": \"\xff\"}", "bad.json:1:"},
      {std::string(200000, '['), "bad.json:1:200001:"},
      {"7", "is no result"},
      {"{\"ticks\": 3}", "is no result"},
      {"{\"speeds\": 1, \"errors\": 2}", "is missing"},
      {no_time.dump(), "speeds: has no time for field, exact, sphere"},
      {negative.dump(), "errors[0].absolute.p98"},
      {text.dump(), "errors[0].absolute.worst"},
      {slow.dump(), "speeds[0].ns_per_pair"},
      {huge.dump(), "errors[0].absolute.worst"},
      {google.dump(), "benchmarks[0]"},
  };
  const fs::path folder = folder_with(good);
  ASSERT_EQ(shell("lumbrical report results --output page.html", folder).exit_code, 0);
  const std::string page = read_file((folder / "page.html").string());
  for (const auto& [content, named] : cases) {
    std::ofstream(folder / "results" / "bad.json", std::ios::binary) << content;
    for (const char* const out : {"page.html", "new.html"}) {
      const Outcome outcome = shell("lumbrical report results --output " + std::string(out), folder);
      EXPECT_EQ(outcome.exit_code, 2) << content.substr(0, 100);
      EXPECT_NE(outcome.error.find("bad.json"), std::string::npos) << outcome.error;
      EXPECT_NE(outcome.error.find(named), std::string::npos) << named << "\n" << outcome.error;
      EXPECT_NE(outcome.error.find("repeat the benchmark"), std::string::npos) << outcome.error;
    }
  }
  EXPECT_EQ(read_file((folder / "page.html").string()), page);
  EXPECT_FALSE(fs::exists(folder / "new.html"));
  EXPECT_FALSE(fs::exists(folder / "new.html.part"));
}

TEST(Report, FoldersWithoutResultsAndPagesThatCannotBeWrittenAreNamed) {
  const fs::path folder = folder_with(accuracy_of({{"field", "exact", 100, 1e-3}}));
  fs::create_directory(folder / "empty");
  fs::create_directory(folder / "pipes");
  const std::pair<std::string, std::string> cases[] = {
      {"report", "folder"},
      {"report gone", "gone"},
      {"report empty", "empty: holds no .json"},
      {"report results/accuracy.json", "accuracy.json"},
      {"report pipes", "pipes/p.json"},
      {"report results --output gone/page.html", "gone/page.html"},
      {"report results --output empty", "empty: is not a file"},
      {"report results --output /dev/full", "/dev/full: is not a file"},
  };
  for (const auto& [arguments, named] : cases) {
    const Outcome outcome =
        shell("{ [ -e pipes/p.json ] || mkfifo pipes/p.json; } && lumbrical " + arguments, folder);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_NE(outcome.error.find(named), std::string::npos) << arguments << "\n" << outcome.error;
  }
  const Outcome limited = shell("ulimit -f 1; lumbrical report results --output page.html", folder);
  EXPECT_EQ(limited.exit_code, 2);
  EXPECT_FALSE(fs::exists(folder / "page.html"));
  EXPECT_FALSE(fs::exists(folder / "page.html.part"));
}

// A page, table and picture of an earlier run may go; nothing else, whatever the command line says.
TEST(Report, OnlyFilesOfItsOwnKindAreWrittenAnew) {
  const fs::path folder = folder_with(accuracy_of({{"field", "exact", 100, 1e-3}}));
  fs::copy_file(LUMBRICAL_SOURCE_DIR "/bench/results/zen4_avx512_gcc12/peers.json",
                folder / "results/peers.json");
  const std::string own = "lumbrical report results -o page --targets table --picture picture";
  for (int times = 0; times < 2; ++times) {
    const Outcome outcome = shell(own, folder);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  }
  std::ofstream(folder / "notes") << "what took a year";
  for (const char* const name : {"-o notes", "--targets notes", "--picture notes", "--targets page",
                                 "-o picture", "--picture results/peers.json"}) {
    const Outcome outcome = shell("lumbrical report results " + std::string(name), folder);
    EXPECT_EQ(outcome.exit_code, 2) << name;
    EXPECT_NE(outcome.error.find("exists and is no "), std::string::npos) << outcome.error;
  }
  EXPECT_EQ(read_file((folder / "notes").string()), "what took a year");
  for (const char* const name : {"-o new --targets new", "-o new --targets ./new",
                                 "--targets new --picture results/../new", "--picture report.html"}) {
    const Outcome outcome = shell("rm -f report.html; lumbrical report results " + std::string(name), folder);
    EXPECT_EQ(outcome.exit_code, 2) << name;
    EXPECT_NE(outcome.error.find("is named twice"), std::string::npos) << outcome.error;
    EXPECT_FALSE(fs::exists(folder / "new"));
  }
}

TEST(Report, APartThatIsThereIsNeitherFollowedNorRemoved) {
  const fs::path folder = folder_with(accuracy_of({{"field", "exact", 100, 1e-3}}));
  std::ofstream(folder / "notes") << "what took a year";
  fs::create_symlink("notes", folder / "page.part");
  const Outcome outcome = shell("lumbrical report results -o page", folder);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.error.find("page.part: exists"), std::string::npos) << outcome.error;
  EXPECT_EQ(read_file((folder / "notes").string()), "what took a year");
  EXPECT_TRUE(fs::is_symlink(folder / "page.part"));
  EXPECT_FALSE(fs::exists(folder / "page"));
}

TEST(Report, TheCommittedResultsMakeAPage) {
  const fs::path folder = fresh_folder();
  int count = 0;
  for (const auto& entry : fs::directory_iterator(LUMBRICAL_SOURCE_DIR "/bench/results")) {
    if (!entry.is_directory()) continue;
    ++count;
    const Outcome outcome = shell("lumbrical report '" + entry.path().string() + "' --json", folder);
    ASSERT_EQ(outcome.exit_code, 0) << entry.path() << "\n" << outcome.error;
    EXPECT_GE(outcome.json()["figures"], 3);
    EXPECT_NE(
        read_file((folder / "report.html").string()).find(entry.path().filename().string() + "/peers.json"),
        std::string::npos);
  }
  EXPECT_GE(count, 1);
}

}  // namespace
}  // namespace lumbrical::test
