// Pictures of the benchmark report beside its points: curves on plain axes, and stacked bars. SVG that needs
// no script.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace lumbrical::tool {

struct Curve {
  std::size_t series = 0;                         ///< index into CurveFigure::series: the colour
  std::vector<std::pair<double, double>> points;  ///< finite; joined in their order
};

struct CurvePanel {
  std::string title, x_label, y_label;
  std::vector<Curve> curves;
};

struct CurveFigure {
  std::string title, note;
  std::vector<std::string> series;
  std::vector<CurvePanel> panels;
};

struct Bar {
  std::string name, label;    ///< beside it; where the pointer rests
  std::vector<double> parts;  ///< not negative, one per BarFigure::parts
};

/// Each bar as long as the sum of its parts, on one scale.
struct BarFigure {
  std::string title, note, unit;
  std::vector<std::string> parts;
  std::vector<Bar> bars;
};

std::string figure_html(const CurveFigure& figure);
std::string figure_html(const BarFigure& figure);

}  // namespace lumbrical::tool
