// Figures of the benchmark report: points on two logarithmic axes, drawn as SVG that needs no script.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace lumbrical::tool {

struct PlotPoint {
  double x = 0;            ///< finite, not negative; 0 stands in a place of its own left of the axis
  double y = 0;            ///< finite, positive
  std::size_t series = 0;  ///< index into Figure::series: the colour
  std::size_t marker = 0;  ///< index into Figure::markers: the shape
  std::string label;       ///< shown where the pointer rests
  std::string name{};      ///< written beside the mark; empty: nothing
  bool compared = true;    ///< may be on the front and beat others: it does the plot's own job
  bool joined = true;      ///< with others of its series, where the figure joins any
};

/// One pair of axes: alternatives for one and the same job.
struct Plot {
  std::string title;
  std::vector<PlotPoint> points;
};

struct Figure {
  std::string title, note, x_label, y_label;
  std::vector<std::string> series, markers;
  std::vector<Plot> plots;
  bool front = false;      ///< marks the Pareto front of what is compared
  bool joined = false;     ///< lines join the points of a series, by x
  std::string zero = "0";  ///< what x = 0 is called
  double deadline = 0;     ///< a line at this y with its name; 0: none
  std::string deadline_name{};
  double limit = 0;  ///< a line at this x with its name; 0: none
  std::string limit_name{};
};

/// Index of `name` in `names`, where it is added if it is new.
std::size_t index_of(std::vector<std::string>& names, const std::string& name);

/// The plot of that title, added if it is new.
Plot& plot_of(Figure& figure, const std::string& title);

/// Which of the points that are compared no other of them beats: at most as large in both x and y, and
/// smaller in one. Indices by ascending x; points that are equal stand or fall together.
std::vector<std::size_t> pareto_front(const std::vector<PlotPoint>& points);

/// Text that HTML takes literally, in elements and in quoted attributes.
std::string escaped(std::string_view text);

/// One entry of a legend: `drawing` is SVG about (0, 0), within 9 of it.
std::string key_html(const std::string& drawing, const std::string& name);

/// The figure with its title, note, legend and plots.
std::string figure_html(const Figure& figure);

/// One of its plots with the legend as an SVG file of its own, light and dark.
std::string picture_svg(const Figure& figure, const Plot& plot);

}  // namespace lumbrical::tool
