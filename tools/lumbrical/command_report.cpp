// lumbrical report: results of the benchmark programs as one self-contained HTML page.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "commands.h"
#include "output.h"
#include "replace_file.h"
#include "report_changes.h"
#include "report_front.h"
#include "report_page.h"
#include "report_targets.h"
#include "switches.h"

namespace lumbrical::tool {
namespace {

namespace fs = std::filesystem;

struct ReportSwitches {
  std::vector<std::string> folders;
  std::string out = "report.html", targets, picture, changes;
  std::optional<double> fail_on_slower;
  bool json = false;
};

Status read_folder(const std::string& path, ResultFolder& folder) {
  std::error_code error;
  std::vector<std::string> files;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() == ".json") files.push_back(entry->path().string());
  }
  if (error)
    return Status::error(path + ": cannot be read: " + error.message() + "; name a folder of results");
  if (files.empty())
    return Status::error(path + ": holds no .json file; let the benchmarks write there first (tools/bench)");
  std::sort(files.begin(), files.end());
  const fs::path whole = fs::absolute(path).lexically_normal();
  folder.name = (whole.has_filename() ? whole : whole.parent_path()).filename().string();
  for (const std::string& file : files) {
    if (Status status = read_results(file, folder.results.emplace_back()); !status.ok()) return status;
  }
  return {};
}

Status check_folders(const std::vector<std::string>& paths) {
  for (std::size_t i = 0; i < paths.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      std::error_code error;
      if (fs::equivalent(paths[i], paths[k], error))
        return Status::error(paths[i] + ": is named twice; name another folder to hold it against");
    }
  }
  return {};
}

Status write_page(const std::string& path, const std::string& page) {
  return replace_file(path, page, "page of a report", "<title>Lumbrical: benchmark results</title>");
}

Status write_targets(const std::string& path, const std::vector<ResultFolder>& folders) {
  std::string targets;
  for (const ResultFolder& folder : folders) {
    const std::string title = "Targets: " + folder.name;
    const std::string table = table_markdown(title, builds_of(folder.results), targets_of(folder.results));
    targets += table.empty() ? "## " + title + "\n\nNothing measured here has a target.\n\n" : table;
  }
  return replace_file(path, targets, "table of targets", "## Targets: ");
}

Status write_picture(const std::string& path, const ResultFolder& folder, const std::string& named) {
  const Figure front = front_figure(folder.results);
  if (front.plots.empty())
    return Status::error(named + ": holds no times against errors to draw; add those of bench_peers");
  return replace_file(path, picture_svg(front, front.plots[0]), "picture of a report",
                      "svg text { fill: var(--weak)");
}

Status write_changes(const std::string& path, const std::vector<Step>& steps, double slower_from) {
  return replace_file(path, changes_json(steps, slower_from).dump(1) + "\n", "list of changes",
                      "\"changes_of\": \"lumbrical report\"");
}

// A script that holds nothing against anything must not pass.
Status check_comparable(const std::vector<Step>& steps) {
  for (const Step& step : steps)
    if (step.comparison.changes.empty())
      return Status::error("--fail-on-slower: " + step.from + " and " + step.to +
                           " have no benchmark in common; measure the same parts (tools/bench --only)");
  return {};
}

Status read_folders(const std::vector<std::string>& paths, std::vector<ResultFolder>& folders) {
  if (Status status = check_folders(paths); !status.ok()) return status;
  for (const std::string& path : paths)
    if (Status status = read_folder(path, folders.emplace_back()); !status.ok()) return status;
  return {};
}

// All but the page, as far as they are asked for.
Status write_others(const ReportSwitches& switches, const std::vector<ResultFolder>& folders,
                    const std::vector<Step>& steps) {
  if (!switches.targets.empty())
    if (Status status = write_targets(switches.targets, folders); !status.ok()) return status;
  if (!switches.picture.empty())
    if (Status status = write_picture(switches.picture, folders.back(), switches.folders.back());
        !status.ok())
      return status;
  if (switches.changes.empty()) return {};
  return write_changes(switches.changes, steps, switches.fail_on_slower.value_or(kTimeNoise));
}

int tell(const ReportSwitches& switches, const std::vector<ResultFolder>& folders, std::size_t page_size,
         const std::vector<std::string>& slower) {
  std::size_t files = 0, figures = 0;
  for (const ResultFolder& folder : folders) {
    files += folder.results.size();
    for (const Results& results : folder.results)
      figures += results.figures.size() + results.curves.size() + results.bars.size();
  }
  const std::vector<std::string> warnings = origin_warnings(folders);
  if (switches.json) {
    Json summary = {{"page", switches.out}, {"files", files}, {"figures", figures}, {"warnings", warnings}};
    if (switches.fail_on_slower) summary["slower"] = slower;
    return print_json(summary);
  }
  for (const std::string& warning : warnings) warn(warning);
  std::string text = switches.out + ": " + grouped(figures) + " figures from " + grouped(files) + " files, " +
                     brief(1e-3 * static_cast<double>(page_size)) + " kB\n";
  for (const std::string& one : slower) text += "slower: " + one + "\n";
  return print_text(text);
}

int report(const ReportSwitches& switches) {
  if (Status status = check_apart({switches.out, switches.targets, switches.picture, switches.changes});
      !status.ok())
    return fail(status);
  std::vector<ResultFolder> folders;
  if (Status status = read_folders(switches.folders, folders); !status.ok()) return fail(status);
  const std::string page = page_html(folders);
  if (Status status = write_page(switches.out, page); !status.ok()) return fail(status);
  const std::vector<Step> steps = steps_between(folders);
  if (Status status = write_others(switches, folders, steps); !status.ok()) return fail(status);
  std::vector<std::string> slower;
  if (switches.fail_on_slower) {
    if (Status status = check_comparable(steps); !status.ok()) return fail(status);
    slower = slower_benchmarks(steps, *switches.fail_on_slower);
  }
  const int code = tell(switches, folders, page.size(), slower);
  return code == kDone && !slower.empty() ? kDiverged : code;
}

}  // namespace

void add_report(Command& app, int& exit_code) {
  const auto switches = std::make_shared<ReportSwitches>();
  Command* const command =
      app.add_subcommand("report", "Draw results of the benchmarks as one self-contained HTML page");
  command->add_option("folder", switches->folders, "Folder whose .json files benchmarks wrote")
      ->required()
      ->expected(-1)
      ->type_name("FOLDER");
  command->add_option("--output,-o", switches->out, "Page to write")
      ->check(is_file())
      ->type_name("PAGE.html")
      ->capture_default_str();
  command->add_option("--targets", switches->targets, "Also write the table of targets, as Markdown")
      ->check(is_file())
      ->type_name("FILE.md");
  command
      ->add_option("--picture", switches->picture, "Also write the first picture, time against error, as SVG")
      ->check(is_file())
      ->type_name("FILE.svg");
  command
      ->add_option("--changes", switches->changes,
                   "Also write what changed from each folder to the next, benchmark by benchmark, as JSON")
      ->check(is_file())
      ->type_name("FILE.json");
  command
      ->add_option(
          "--fail-on-slower", switches->fail_on_slower,
          "Exit with 3 where a benchmark takes more than so many times as long as in the folder before, "
          "beside what others' code takes on both machines")
      ->check(number_in(1, 1000))
      ->type_name("TIMES");
  command->add_flag("--json", switches->json, "Print one JSON object");
  command->callback([switches, &exit_code] {
    if (switches->folders.size() < 2) {
      if (!switches->changes.empty())
        refuse_option("--changes", "needs two folders to hold against each other");
      if (switches->fail_on_slower)
        refuse_option("--fail-on-slower", "needs two folders to hold against each other");
    }
    exit_code = report(*switches);
  });
}

}  // namespace lumbrical::tool
