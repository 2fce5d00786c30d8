// lumbrical report: results of the benchmark programs as one self-contained HTML page.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "commands.h"
#include "output.h"
#include "replace_file.h"
#include "report_front.h"
#include "report_page.h"
#include "report_targets.h"
#include "switches.h"

namespace lumbrical::tool {
namespace {

namespace fs = std::filesystem;

struct ReportSwitches {
  std::vector<std::string> folders;
  std::string out = "report.html", targets, picture;
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

Status write_page(const std::string& path, const std::string& page) {
  return replace_file(path, page, "page of a report", "<title>Lumbrical: benchmark results</title>");
}

Status write_targets(const std::string& path, const std::vector<ResultFolder>& folders) {
  std::string targets;
  for (const ResultFolder& folder : folders)
    targets += table_markdown("Targets: " + folder.name, targets_of(folder.results));
  return replace_file(path, targets, "table of targets", "## Targets: ");
}

Status write_picture(const std::string& path, const ResultFolder& folder, const std::string& named) {
  const Figure front = front_figure(folder.results);
  if (front.plots.empty())
    return Status::error(named + ": holds no times against errors to draw; add those of bench_peers");
  return replace_file(path, picture_svg(front, front.plots[0]), "picture of a report",
                      "svg text { fill: var(--weak)");
}

int report(const ReportSwitches& switches) {
  if (Status status = check_apart({switches.out, switches.targets, switches.picture}); !status.ok())
    return fail(status);
  std::vector<ResultFolder> folders(switches.folders.size());
  std::size_t files = 0, figures = 0;
  for (std::size_t i = 0; i < folders.size(); ++i) {
    if (Status status = read_folder(switches.folders[i], folders[i]); !status.ok()) return fail(status);
    files += folders[i].results.size();
    for (const Results& results : folders[i].results)
      figures += results.figures.size() + results.curves.size() + results.bars.size();
  }
  const std::string page = page_html(folders);
  if (Status status = write_page(switches.out, page); !status.ok()) return fail(status);
  if (!switches.targets.empty())
    if (Status status = write_targets(switches.targets, folders); !status.ok()) return fail(status);
  if (!switches.picture.empty())
    if (Status status = write_picture(switches.picture, folders.back(), switches.folders.back());
        !status.ok())
      return fail(status);
  if (switches.json) return print_json({{"page", switches.out}, {"files", files}, {"figures", figures}});
  return print_text(switches.out + ": " + grouped(figures) + " figures from " + grouped(files) + " files, " +
                    brief(1e-3 * static_cast<double>(page.size())) + " kB\n");
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
  command->add_flag("--json", switches->json, "Print one JSON object");
  command->callback([switches, &exit_code] { exit_code = report(*switches); });
}

}  // namespace lumbrical::tool
