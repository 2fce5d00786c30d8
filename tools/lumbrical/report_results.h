// What the benchmark programs wrote (accuracy, bench_peers, mesh_grasps, paper_experiments, stage_times, and
// Google Benchmark's own JSON), as figures and tables for the report.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "lumbrical/status.h"
#include "report_curves.h"
#include "report_plot.h"

namespace lumbrical::tool {

struct ResultTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  ///< each as long as the head
};

/// One contender on one scene of bench_peers.
struct PeerResult {
  std::string scene, contender, leaves_out;  ///< of what our tick does
  double triangles = 0;                      ///< of the scene
  double median_us = 0, force_error = 0;     ///< of a tick; of the hand's force, relative
  double times_ours = 0;  ///< its median over that of our tick at 1e-4; 0: the file doesn't say
  bool has_area = false;  ///< finds areas; otherwise contacts alone
  [[nodiscard]] bool is_ours() const { return contender.starts_with("ours"); }
  /// Of the paper's related work, by its references, and no library: it touches the world in a few points.
  [[nodiscard]] bool is_method() const { return contender.ends_with(']'); }
  [[nodiscard]] bool is_library() const { return !is_ours() && !is_method(); }
};

/// One file of results.
struct Results {
  std::string file;  ///< its name without folders
  std::string title;
  std::vector<std::pair<std::string, std::string>> origin;  ///< machine, compiler, flags ...
  std::string command;                                      ///< repeats them
  std::vector<std::string> notes;                           ///< sentences on what the figures hold
  bool is_quick = false;                                    ///< only tried out (tools/bench --quick)
  std::vector<Figure> figures;
  std::vector<CurveFigure> curves;
  std::vector<BarFigure> bars;
  ResultTable table;
  std::map<std::string, std::map<std::string, double>> counters;  ///< by benchmark
  std::vector<PeerResult> peers;
};

/// What the file says of its origin under that name; empty: nothing.
std::string origin_value(const Results& results, std::string_view name);

/// Reads one file. An error says which file, where in it and what to do; `results` is then unspecified.
Status read_results(const std::string& path, Results& results);

}  // namespace lumbrical::tool
