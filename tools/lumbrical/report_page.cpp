// See report_page.h.
#include "report_page.h"

#include "report_compare.h"
#include "report_front.h"
#include "report_style.h"
#include "report_targets.h"

namespace lumbrical::tool {
namespace {

// The policy forbids whatever a name in a file of results might try to fetch or run.
constexpr const char* kBeforeColours = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>Lumbrical: benchmark results</title>
<style>
)";

constexpr const char* kBeforeMarks =
    R"(body { background: var(--back); color: var(--text); font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto;
  max-width: 84rem; padding: 0 1rem; }
h1, h2, h3 { line-height: 1.2; }
h2 { border-bottom: 1px solid var(--grid); margin-top: 3rem; }
figure { margin: 1.5rem 0; }
figcaption p { margin: 0.3rem 0; max-width: 60rem; color: var(--weak); }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(22rem, 1fr)); gap: 1rem; }
.plots.large { grid-template-columns: repeat(auto-fit, minmax(min(100%, 34rem), 1fr)); }
.plots svg { width: 100%; height: auto; }
.large svg { max-width: 46rem; min-width: 28rem; }
.large { overflow-x: auto; }
.legend span { display: inline-block; margin-right: 1.2rem; color: var(--text); }
.key { width: 18px; height: 18px; vertical-align: -4px; margin-right: 4px; }
)";

constexpr const char* kAfterMarks = R"(.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: 0.2rem 0.7rem 0.2rem 0; border-bottom: 1px solid var(--grid); vertical-align: top; }
pre { overflow-x: auto; border: 1px solid var(--grid); padding: 0.6rem; }
summary { cursor: pointer; }
</style>
</head>
<body>
<h1>Lumbrical: benchmark results</h1>
<p>Times and errors as the benchmark programs wrote them. Where marks stand, both axes are logarithmic, and what is exactly
0 stands left of the axis. Rest the pointer on a mark for its figures; the tables hold all of them.</p>
)";

std::string cells(const std::vector<std::string>& texts, const char* element) {
  std::string html = "<tr>";
  for (const std::string& text : texts)
    html += std::string("<") + element + ">" + escaped(text) + "</" + element + ">";
  return html + "</tr>\n";
}

std::string origin_html(const Results& results) {
  std::string html = "<div class=\"wide\"><table>\n";
  for (const auto& [name, value] : results.origin)
    html += "<tr><th>" + escaped(name) + "</th><td>" + escaped(value) + "</td></tr>\n";
  return html + "</table></div>\n<p>Repeat it with</p>\n<pre>" + escaped(results.command) + "</pre>\n";
}

std::string plain_table_html(const ResultTable& table) {
  std::string html = "<div class=\"wide\"><table>\n<thead>" + cells(table.head, "th") + "</thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : table.rows) html += cells(row, "td");
  return html + "</tbody></table></div>\n";
}

std::string folded_html(const std::string& summary, const ResultTable& table) {
  return "<details><summary>" + summary + "</summary>\n" + plain_table_html(table) + "</details>\n";
}

std::string table_html(const ResultTable& table) {
  return folded_html(std::to_string(table.rows.size()) + " rows of figures", table);
}

std::string list_html(const std::vector<std::string>& sentences) {
  std::string html = "<ul>\n";
  for (const std::string& sentence : sentences) html += "<li>" + escaped(sentence) + "</li>\n";
  return html + "</ul>\n";
}

std::string targets_html(const ResultTable& targets) {
  const std::size_t met = met_targets(targets), all = judged_targets(targets);
  const std::string quick = all < targets.rows.size() ? "; of --quick, and so neither met nor missed: " +
                                                            std::to_string(targets.rows.size() - all)
                                                      : "";
  return folded_html(std::to_string(met) + " of " + std::to_string(all) + " are met" + quick, targets);
}

std::string comparison_html(const ResultFolder& before, const ResultFolder& after) {
  const Comparison comparison = compare_results(before.results, after.results);
  return "<section>\n<h2>From " + escaped(before.name) + " to " + escaped(after.name) + "</h2>\n" +
         list_html(comparison.words) + table_html(comparison.table) + "</section>\n";
}

}  // namespace

std::string page_html(const std::vector<ResultFolder>& folders) {
  std::string html = std::string(kBeforeColours) + kPlotColours + kBeforeMarks + kPlotMarks + kAfterMarks;
  if (const auto warnings = origin_warnings(folders); !warnings.empty())
    html += "<section>\n<h2>Mind</h2>\n" + list_html(warnings) + "</section>\n";
  for (std::size_t i = 1; i < folders.size(); ++i) html += comparison_html(folders[i - 1], folders[i]);
  for (const ResultFolder& folder : folders) {
    if (const Figure front = front_figure(folder.results); !front.plots.empty())
      html += "<section>\n<h2>How fast, at which error</h2>\n<p>" +
              escaped(folder.name + ", " + builds_of(folder.results)) + "</p>\n" +
              list_html(front_words(folder.results)) + figure_html(front) + "</section>\n";
    if (const ResultTable targets = targets_of(folder.results); !targets.rows.empty())
      html += "<section>\n<h2>Targets</h2>\n<p>" + escaped(folder.name) + "</p>\n" + targets_html(targets) +
              "</section>\n";
    for (const Results& results : folder.results) {
      html += "<section>\n<h2>" + escaped(results.title) + "</h2>\n<p>" +
              escaped(folder.name + "/" + results.file) + "</p>\n" + origin_html(results);
      if (!results.notes.empty()) html += list_html(results.notes);
      for (const Figure& figure : results.figures) html += figure_html(figure);
      for (const CurveFigure& figure : results.curves) html += figure_html(figure);
      for (const BarFigure& figure : results.bars) html += figure_html(figure);
      html += table_html(results.table) + "</section>\n";
    }
  }
  return html + "</body>\n</html>\n";
}

}  // namespace lumbrical::tool
