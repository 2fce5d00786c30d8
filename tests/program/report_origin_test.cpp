// What lumbrical report says of where results come from: builds that differ, runs that only try out, files
// that say the same twice, repetitions, and what was left out.
#include <fstream>
#include <string>

#include "report_pages.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

const std::string kTarget = "A_drape/1e-4/162";  // at most 45 us

Json ticks_of(double time, const char* arithmetic, const char* commit = "11112222") {
  Json json = google_of({{kTarget.c_str(), {{"p50_us", time}, {"force_error", 1e-5}, {"triangles", 162}}}});
  if (arithmetic != nullptr) json["context"].update({{"arithmetic", arithmetic}, {"commit", commit}});
  return json;
}

Json peers_by(const char* arithmetic) {
  Json json = peers_of({{"A drape", "ours, 1e-4", 200, 10, 0}, {"A drape", "theirs", 200, 40, 0.3}});
  json["arithmetic"] = arithmetic;
  return json;
}

void put(const fs::path& file, const Json& json) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << json;
}

std::string arithmetic_now(const fs::path& folder) {
  const std::string version = shell("lumbrical --version", folder).output;
  const std::string before = "arithmetic ";
  return version.substr(version.find(before) + before.size(), 8);
}

// The report's warnings, each on a line; it must not fail.
std::string warnings_of(const std::string& folders, const fs::path& folder) {
  const Outcome outcome = shell("lumbrical report " + folders + " -o page.html", folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  return outcome.error;
}

TEST(ReportOrigin, CommitArithmeticAndLoadStandInTheReportAndAreUnknownInOldFiles) {
  const fs::path folder = fresh_folder();
  Json stages = {{"cpu", "c"},
                 {"isa", "avx2"},
                 {"compiler", "c"},
                 {"flags", ""},
                 {"command", "x"},
                 {"commit", "1a2b3c4d+"},
                 {"arithmetic", arithmetic_now(folder)},
                 {"load_avg", {0.25, 1.5, 2}},
                 {"note", "n"},
                 {"stages", {"one"}},
                 {"scenes", {{{"scene", "s"}, {"stage_us", {1}}}}}};
  put(folder / "new/stages.json", stages);
  EXPECT_EQ(warnings_of("new", folder), "");
  const std::string page = read_file((folder / "page.html").string());
  for (const std::string& said :
       {std::string("<tr><th>commit</th><td>1a2b3c4d+</td></tr>"),
        "<th>arithmetic</th><td>" + stages["arithmetic"].get<std::string>(),
        std::string("<th>load</th><td>0.250, 1.50, 2.00 (over 1, 5 and 15 minutes")})
    EXPECT_NE(page.find(said), std::string::npos) << said;
  put(folder / "old/tick.json", ticks_of(10, nullptr));
  EXPECT_NE(warnings_of("old", folder).find("old: is of arithmetic unknown"), std::string::npos);
  EXPECT_NE(read_file((folder / "page.html").string()).find("<th>commit</th><td>unknown</td>"),
            std::string::npos);
}

TEST(ReportOrigin, FilesAndFoldersOfDifferentArithmeticAreWarnedOf) {
  const fs::path folder = fresh_folder();
  const std::string now = arithmetic_now(folder);
  put(folder / "mixed/tick.json", ticks_of(10, "00000001"));
  put(folder / "mixed/peers.json", peers_by(now.c_str()));
  const std::string warned = warnings_of("mixed", folder);
  for (const std::string& said : {std::string("mixed: its files are of different arithmetic"),
                                  std::string("00000001 (tick.json)"), now + " (peers.json)"})
    EXPECT_NE(warned.find(said), std::string::npos) << said << "\n" << warned;
  EXPECT_NE(read_file((folder / "page.html").string()).find("mixed: its files are of different arithmetic"),
            std::string::npos);
  put(folder / "one/tick.json", ticks_of(10, "00000001"));
  put(folder / "other/tick.json", ticks_of(10, now.c_str()));
  EXPECT_NE(warnings_of("one other", folder)
                .find("one and other are of different arithmetic (00000001 and " + now + ")"),
            std::string::npos);
  EXPECT_EQ(warnings_of("other", folder), "");
}

TEST(ReportOrigin, TargetsAreNeitherMetNorMissedByARunToTryItOut) {
  const fs::path folder = fresh_folder();
  const std::string now = arithmetic_now(folder);
  Json by_program = ticks_of(1000, now.c_str()), by_command = by_program;
  by_program["context"]["quick"] = "yes";
  by_command["context"]["command"] = "tools/bench build/try --quick";
  for (const Json& json : {by_program, by_command}) {
    put(folder / "tried/tick.json", json);
    const Outcome outcome = shell("lumbrical report tried --targets targets.md --json", folder);
    EXPECT_NE(outcome.json()["warnings"].dump().find("tick.json: no target is met or missed"),
              std::string::npos);
    const std::string targets = read_file((folder / "targets.md").string());
    EXPECT_NE(targets.find("| 1000 us | quick | " + kTarget), std::string::npos) << targets;
    EXPECT_EQ(targets.find("MISSED"), std::string::npos);
    EXPECT_NE(targets.find("\n\nOf commit 11112222, arithmetic " + now + ".\n\n"), std::string::npos);
    EXPECT_NE(read_file((folder / "report.html").string())
                  .find("0 of 0 are met; of --quick, and so neither met nor missed: 1"),
              std::string::npos);
  }
}

TEST(ReportOrigin, TheSameBenchmarksInTwoFilesAreWarnedOf) {
  const fs::path folder = fresh_folder();
  const std::string now = arithmetic_now(folder);
  put(folder / "results/tick.json", ticks_of(10, now.c_str()));
  put(folder / "results/tick_old.json", ticks_of(20, now.c_str()));
  EXPECT_NE(warnings_of("results", folder).find("tick.json and tick_old.json have the same benchmarks"),
            std::string::npos);
  const Outcome twice = shell("lumbrical report results ./results/", folder);
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_NE(twice.error.find("./results/: is named twice"), std::string::npos) << twice.error;
}

// Ticks of two benchmarks and a peer's row, so that the machine is told apart.
void put_ticks(const fs::path& results, double quick, double slow, double theirs) {
  put(results / "tick.json", google_of({{"quick/1e-4/2", {{"p50_us", quick}, {"force_error", 1e-5}}},
                                        {"slow/1e-4/2", {{"p50_us", slow}, {"force_error", 2e-5}}}}));
  if (theirs > 0)
    put(results / "peers.json",
        peers_of({{"A drape", "ours, 1e-4", 200, theirs / 10, 0}, {"A drape", "theirs", 200, theirs, 0.3}}));
}

TEST(ReportOrigin, ChangesAreAListForScriptsAndWhatIsSlowerBesideTheMachineFails) {
  const fs::path folder = fresh_folder();
  put_ticks(folder / "before", 10, 10, 100);
  put_ticks(folder / "after", 20, 31, 200);  // on a machine half as fast
  const std::string judged = "lumbrical report before after --changes changes.json --fail-on-slower ";
  EXPECT_EQ(shell(judged + "1.6", folder).exit_code, 0);
  const Outcome slower = shell(judged + "1.2", folder);
  EXPECT_EQ(slower.exit_code, 3);
  EXPECT_NE(slower.output.find("slower: slow/1e-4/2 takes 1.55 times as long (from before to after)"),
            std::string::npos)
      << slower.output;
  EXPECT_EQ(slower.output.find("slower: quick"), std::string::npos);
  const Json step = Json::parse(read_file((folder / "changes.json").string()))["steps"][0];
  EXPECT_EQ(step["machine_factor"], 2);
  EXPECT_EQ(step["machine_rows"], 1);
  const Json& slow = step["benchmarks"][0];
  EXPECT_EQ(slow["benchmark"], "slow/1e-4/2");
  EXPECT_NEAR(slow["times"].get<double>(), 3.1, 1e-12);
  EXPECT_NEAR(slow["times_beside_machine"].get<double>(), 1.55, 1e-12);
  EXPECT_TRUE(slow["slower"]);
  EXPECT_FALSE(step["benchmarks"][1]["slower"]);
  EXPECT_NE(read_file((folder / "report.html").string())
                .find("What is not our code, 1 row of bench_peers, takes 2.00 times as long"),
            std::string::npos);
  const Outcome json = shell(judged + "1.2 --json", folder);
  EXPECT_EQ(json.exit_code, 3);
  EXPECT_EQ(json.json()["slower"].size(), 1u);
}

TEST(ReportOrigin, NothingPassesThatIsHeldAgainstNothing) {
  const fs::path folder = fresh_folder();
  put_ticks(folder / "results", 10, 10, 0);
  put(folder / "else/tick.json", ticks_of(10, nullptr));
  for (const char* const option : {"--changes c.json", "--fail-on-slower 1.5"}) {
    const Outcome alone = shell("lumbrical report results " + std::string(option), folder);
    EXPECT_EQ(alone.exit_code, 2);
    EXPECT_NE(alone.error.find("needs two folders"), std::string::npos) << alone.error;
  }
  const Outcome apart = shell("lumbrical report results else --fail-on-slower 1.5", folder);
  EXPECT_EQ(apart.exit_code, 2);
  EXPECT_NE(apart.error.find("results and else have no benchmark in common"), std::string::npos);
  EXPECT_EQ(shell("lumbrical report results else --fail-on-slower 0.5", folder).exit_code, 2);
}

// The part that is none keeps it from measuring, should it take them.
TEST(ReportOrigin, BenchRefusesTwoFoldersAndListsItsOptions) {
  const fs::path folder = fresh_folder();
  const std::string bench = "'" LUMBRICAL_SOURCE_DIR "/tools/bench' ";
  const Outcome two = shell(bench + "one other --only nothing", folder);
  EXPECT_EQ(two.exit_code, 2);
  EXPECT_NE(two.error.find("two are named: one and other"), std::string::npos) << two.error;
  const Outcome help = shell(bench + "--only nothing --help", folder);
  EXPECT_EQ(help.exit_code, 0) << help.error;
  for (const char* const option : {"--meshes", "--only", "--repetitions", "--quick", "near_pairs"})
    EXPECT_NE(help.output.find(option), std::string::npos) << option;
  EXPECT_NE(shell(bench + "--repetitions 0", folder).error.find("--repetitions 0: is not"),
            std::string::npos);
}

TEST(ReportOrigin, ResultsWithoutATargetAreSaidToHaveNone) {
  const fs::path folder = fresh_folder();
  put(folder / "results/tick.json", google_of({{"new/1e-4/2", {{"p50_us", 3}}}}));
  ASSERT_EQ(shell("lumbrical report results --targets targets.md", folder).exit_code, 0);
  EXPECT_EQ(read_file((folder / "targets.md").string()),
            "## Targets: results\n\nNothing measured here has a target.\n\n");
}

TEST(ReportOrigin, RepetitionsAreShownByTheirMedianAndSpread) {
  const fs::path folder = fresh_folder();
  const auto row = [](const char* type, const char* aggregate, double time) {
    Json json = {{"name", kTarget},       {"run_name", kTarget}, {"run_type", type}, {"repetitions", 3},
                 {"real_time", 2 * time}, {"time_unit", "us"},   {"p50_us", time},   {"triangles", 162}};
    if (aggregate[0] != 0) json["aggregate_name"] = aggregate;
    return json;
  };
  Json json = ticks_of(10, "00000001");
  json["benchmarks"] = {row("iteration", "", 10),       row("iteration", "", 12),
                        row("iteration", "", 50),       row("aggregate", "mean", 24),
                        row("aggregate", "median", 12), row("aggregate", "stddev", 3),
                        row("aggregate", "cv", 0.125)};
  json["benchmarks"].back()["force_error"] = "not a number";  // 0 over 0, as the library writes it
  std::string text = json.dump(1);
  text.replace(text.find("\"not a number\""), 14, "NaN");
  fs::create_directory(folder / "results");
  std::ofstream(folder / "results/tick.json") << text;
  const Outcome outcome = shell("lumbrical report results", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const std::string page = read_file((folder / "report.html").string());
  EXPECT_NE(page.find("<th>repetitions</th><th>spread</th>"), std::string::npos);
  EXPECT_NE(page.find("<td>24.0</td><td>3</td><td>25 %</td>"), std::string::npos);
}

TEST(ReportOrigin, MeshesThatWereLeftOutAndBothExactTimesAreShown) {
  const fs::path folder = fresh_folder();
  const auto row = [](const char* rung, double time, double exact, double once) {
    return Json{{"mesh", "tray.stl"}, {"triangles", 4520},     {"contacts", 149},
                {"moments", 80},      {"rung", rung},          {"median_us", time},
                {"p99_us", time},     {"times_exact", exact},  {"times_exact_felt_once", once},
                {"hand_error", 0.26}, {"worst_hand_error", 0}, {"segment_error", 0}};
  };
  put(folder / "results/meshes.json",
      {{"cpu", "x"},
       {"isa", "avx2"},
       {"compiler", "c"},
       {"flags", ""},
       {"command", "x"},
       {"left_out", {"notes.txt: is <no> mesh"}},
       {"meshes", {row("1e-4", 40, 1.5, 375), row("exact for each", 60, 1, 250)}}});
  ASSERT_EQ(shell("lumbrical report results", folder).exit_code, 0);
  const std::string page = read_file((folder / "report.html").string());
  EXPECT_NE(page.find("<li>Left out: notes.txt: is &lt;no&gt; mesh</li>"), std::string::npos);
  EXPECT_NE(page.find("<th>times exact</th><th>times exact, felt once</th>"), std::string::npos);
  EXPECT_NE(page.find("<td>1.50</td><td>375</td>"), std::string::npos);
  EXPECT_EQ(marks_in(plot_in(page, "tray.stl, 4,520 triangles")).size(), 1u)
      << "each part by itself is no error";
}

}  // namespace
}  // namespace lumbrical::test
