// See report_curves.h.
#include "report_curves.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "output.h"
#include "report_plot.h"
#include "report_text.h"

namespace lumbrical::tool {
namespace {

constexpr double kPanelWidth = 400, kPanelHeight = 240, kPanelLeft = 62, kPanelRight = 14, kPanelTop = 28,
                 kPanelBottom = 46;
constexpr double kBarWidth = 900, kBarLeft = 240, kBarRight = 90, kBarHeight = 20, kBarPitch = 28;
constexpr std::size_t kSeriesColours = 8;

/// An even axis between two places in the picture.
struct PlainAxis {
  double low = 0, high = 1, step = 1;  // values at its ends, and from tick to tick
  double from = 0, to = 0;             // places of the ends
  [[nodiscard]] double place(double value) const {
    return from + (to - from) * ((value - low) / (high - low));
  }
};

// Five ticks or so, at multiples of 1, 2 or 5 times a power of ten.
PlainAxis make_plain_axis(double least, double most, double from, double to) {
  const double range = most > least ? most - least : std::max(std::fabs(most), 1.0);
  const double power = std::pow(10.0, std::floor(std::log10(range / 5)));
  PlainAxis axis{least, most, 10 * power, from, to};
  for (const double digit : {5.0, 2.0, 1.0})
    if (range / (digit * power) <= 7) axis.step = digit * power;
  axis.low = axis.step * std::floor(least / axis.step);
  axis.high = axis.step * std::ceil(most / axis.step);
  if (!(axis.high > axis.low)) axis.high = axis.low + axis.step;
  return axis;
}

struct PlainFrame {
  PlainAxis x, y;
};

// Zero is on the upright axis: half of a change should not look like all of it.
PlainFrame make_plain_frame(const CurvePanel& panel) {
  double least_x = HUGE_VAL, most_x = -HUGE_VAL, least_y = 0, most_y = 0;
  for (const Curve& curve : panel.curves) {
    for (const auto& [x, y] : curve.points) {
      least_x = std::min(least_x, x);
      most_x = std::max(most_x, x);
      least_y = std::min(least_y, y);
      most_y = std::max(most_y, y);
    }
  }
  if (!(least_x <= most_x)) least_x = most_x = 0;
  return {make_plain_axis(least_x, most_x, kPanelLeft, kPanelWidth - kPanelRight),
          make_plain_axis(least_y, most_y, kPanelHeight - kPanelBottom, kPanelTop)};
}

std::string tick_text(double value, double step) {
  return print("%.6g", std::fabs(value) < 1e-9 * step ? 0.0 : value);
}

std::string axes_svg(const PlainFrame& frame, const CurvePanel& panel) {
  const double bottom = kPanelHeight - kPanelBottom, right = kPanelWidth - kPanelRight;
  std::string svg;
  const auto count = [](const PlainAxis& axis) {
    return static_cast<int>(std::lround((axis.high - axis.low) / axis.step));
  };
  for (int i = 0; i <= count(frame.x); ++i) {
    const double value = frame.x.low + i * frame.x.step, x = frame.x.place(value);
    svg += print("<path class=\"grid\" d=\"M%.2f %.1fV%.1f\"/>\n", x, kPanelTop, bottom) +
           print("<text class=\"x\" x=\"%.2f\" y=\"%.1f\">%s</text>\n", x, bottom + 15,
                 tick_text(value, frame.x.step).c_str());
  }
  for (int i = 0; i <= count(frame.y); ++i) {
    const double value = frame.y.low + i * frame.y.step, y = frame.y.place(value);
    svg += print("<path class=\"grid\" d=\"M%.1f %.2fH%.1f\"/>\n", kPanelLeft, y, right) +
           print("<text class=\"y\" x=\"%.1f\" y=\"%.2f\" dy=\"4\">%s</text>\n", kPanelLeft - 5, y,
                 tick_text(value, frame.y.step).c_str());
  }
  svg += print("<text class=\"x\" x=\"%.1f\" y=\"%.1f\">", (kPanelLeft + right) / 2, kPanelHeight - 10) +
         escaped(panel.x_label) + "</text>\n";
  return svg +
         print("<text class=\"x\" transform=\"translate(12 %.1f) rotate(-90)\">", (kPanelTop + bottom) / 2) +
         escaped(panel.y_label) + "</text>\n";
}

std::string curve_svg(const PlainFrame& frame, const Curve& curve, const std::string& name) {
  if (curve.points.empty()) return {};
  std::string svg = print("<path class=\"line s%zu\" d=\"", curve.series % kSeriesColours);
  char letter = 'M';
  for (const auto& [x, y] : curve.points) {
    svg += print("%c%.1f %.1f", letter, frame.x.place(x), frame.y.place(y));
    letter = 'L';
  }
  return svg + "\"><title>" + escaped(name) + "</title></path>\n";
}

std::string panel_svg(const CurveFigure& figure, const CurvePanel& panel) {
  const PlainFrame frame = make_plain_frame(panel);
  std::string svg =
      print("<svg viewBox=\"0 0 %g %g\" role=\"img\" aria-label=\"", kPanelWidth, kPanelHeight) +
      escaped(panel.title + ": " + panel.y_label + " against " + panel.x_label) + "\">\n" +
      print("<text class=\"title\" x=\"%.1f\" y=\"16\">", kPanelLeft) + escaped(panel.title) + "</text>\n" +
      axes_svg(frame, panel);
  for (const Curve& curve : panel.curves) svg += curve_svg(frame, curve, figure.series[curve.series]);
  return svg + "</svg>\n";
}

std::string legend_html(const std::vector<std::string>& names) {
  std::string html = "<p class=\"legend\">\n";
  for (std::size_t i = 0; i < names.size(); ++i)
    html +=
        key_html(print("<path class=\"point s%zu\" d=\"M-8 -4H8V4H-8Z\"/>", i % kSeriesColours), names[i]);
  return html + "</p>\n";
}

std::string bar_svg(const BarFigure& figure, const Bar& bar, double longest, double top) {
  const double scale = (kBarWidth - kBarLeft - kBarRight) / longest;
  std::string svg = print("<text class=\"y\" x=\"%.1f\" y=\"%.1f\">", kBarLeft - 8, top + 14) +
                    escaped(bar.name) + "</text>\n";
  double left = kBarLeft, whole = 0;
  for (std::size_t i = 0; i < bar.parts.size(); ++i) {
    whole += bar.parts[i];
    svg += print("<rect class=\"point s%zu\" x=\"%.2f\" y=\"%.1f\" width=\"%.2f\" height=\"%.1f\">",
                 i % kSeriesColours, left, top, scale * bar.parts[i], kBarHeight) +
           "<title>" +
           escaped(bar.label + ", " + figure.parts[i] + ": " + brief(bar.parts[i]) + " " + figure.unit) +
           "</title></rect>\n";
    left += scale * bar.parts[i];
  }
  return svg + print("<text x=\"%.2f\" y=\"%.1f\">%s ", left + 6, top + 14, brief(whole).c_str()) +
         escaped(figure.unit) + "</text>\n";
}

std::string figure_html(const std::string& title, const std::string& note,
                        const std::vector<std::string>& names, const std::string& pictures) {
  return "<figure>\n<h3>" + escaped(title) + "</h3>\n" + legend_html(names) + pictures + "<figcaption><p>" +
         escaped(note) + "</p></figcaption>\n</figure>\n";
}

}  // namespace

std::string figure_html(const CurveFigure& figure) {
  std::string panels = "<div class=\"plots\">\n";
  for (const CurvePanel& panel : figure.panels) panels += panel_svg(figure, panel);
  return figure_html(figure.title, figure.note, figure.series, panels + "</div>\n");
}

std::string figure_html(const BarFigure& figure) {
  double longest = 1e-300;
  for (const Bar& bar : figure.bars)
    longest = std::max(longest, std::accumulate(bar.parts.begin(), bar.parts.end(), 0.0));
  const double height = kBarPitch * static_cast<double>(figure.bars.size()) + 6;
  std::string svg =
      print("<div class=\"wide\"><svg class=\"bars\" viewBox=\"0 0 %g %g\" role=\"img\" aria-label=\"",
            kBarWidth, height) +
      escaped(figure.title) + "\">\n";
  double top = 3;
  for (const Bar& bar : figure.bars) {
    svg += bar_svg(figure, bar, longest, top);
    top += kBarPitch;
  }
  return figure_html(figure.title, figure.note, figure.parts, svg + "</svg></div>\n");
}

}  // namespace lumbrical::tool
