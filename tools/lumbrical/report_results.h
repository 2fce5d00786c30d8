// What the benchmark programs wrote (accuracy, bench_peers, and Google Benchmark's own JSON), as figures and
// tables for the report.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lumbrical/status.h"
#include "report_plot.h"

namespace lumbrical::tool {

struct ResultTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  ///< each as long as the head
};

/// One file of results.
struct Results {
  std::string file;  ///< its name without folders
  std::string title;
  std::vector<std::pair<std::string, std::string>> origin;  ///< machine, compiler, flags ...
  std::string command;                                      ///< repeats them
  std::vector<Figure> figures;
  ResultTable table;
  /// What the targets are held against, by benchmark; of bench_peers, by "SCENE, TRIANGLES triangles | NAME".
  std::map<std::string, std::map<std::string, double>> counters;
};

/// Reads one file. An error says which file, where in it and what to do; `results` is then unspecified.
Status read_results(const std::string& path, Results& results);

}  // namespace lumbrical::tool
