// See delay_plot.h.
#include "delay_plot.h"

#include <algorithm>
#include <cmath>

#include "print.h"

namespace lumbrical::bench {
namespace {

constexpr double kWidth = 860, kHeight = 520, kLeft = 70, kRight = 20, kTop = 130, kBottom = 110;
constexpr int kLow = -6, kHigh = 2;  // powers of ten
constexpr const char* kColours[] = {"#1b6ca8", "#c8553d", "#3a7d44", "#8e5ea2", "#b8860b", "#555555"};

double y_of(double energy) {
  const double exponent = std::log10(std::max(energy, 1e-300));
  const double along =
      (std::clamp(exponent, static_cast<double>(kLow), static_cast<double>(kHigh)) - kLow) / (kHigh - kLow);
  return kHeight - kBottom - (kHeight - kTop - kBottom) * along;
}

double x_of(std::size_t bus, std::size_t bus_count, std::size_t curve, std::size_t curve_count) {
  const double column = (kWidth - kLeft - kRight) / static_cast<double>(bus_count);
  return kLeft + column * (static_cast<double>(bus) +
                           (static_cast<double>(curve) + 1) / (static_cast<double>(curve_count) + 1));
}

std::string axes(const std::vector<DelayPoint>& buses, double limit) {
  std::string svg;
  for (int power = kLow; power <= kHigh; ++power) {
    const double y = y_of(std::pow(10, power));
    svg += print("<path d='M%.1f %.1f H%.1f' stroke='#ddd'/>\n", kLeft, y, kWidth - kRight);
    svg += print("<text x='%.1f' y='%.1f' text-anchor='end'>%g</text>\n", kLeft - 6, y + 4,
                 1e3 * std::pow(10, power));
  }
  svg += print("<path d='M%.1f %.1f H%.1f' stroke='black' stroke-dasharray='5 4'/>\n", kLeft, y_of(limit),
               kWidth - kRight);
  svg += print(
      "<text transform='translate(16 %.1f) rotate(-90)' text-anchor='middle'>energy into the hand [mJ], "
      "worst cell</text>\n",
      0.5 * (kTop + kHeight - kBottom));
  for (std::size_t b = 0; b < buses.size(); ++b) {
    const double x = x_of(b, buses.size(), 0, 1);
    svg += print("<text transform='translate(%.1f %.1f) rotate(-40)' text-anchor='end'>%s</text>\n", x + 4,
                 kHeight - kBottom + 16, buses[b].bus.c_str());
  }
  return svg;
}

}  // namespace

std::string plot_delays(const std::vector<DelayCurve>& curves, double limit) {
  std::string svg = print(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %g %g' font-family='sans-serif' font-size='12'>\n"
      "<rect width='%g' height='%g' fill='white'/>\n",
      kWidth, kHeight, kWidth, kHeight);
  if (!curves.empty()) svg += axes(curves[0].points, limit);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const char* const colour = kColours[i % std::size(kColours)];
    for (std::size_t b = 0; b < curves[i].points.size(); ++b) {
      const DelayPoint& point = curves[i].points[b];
      const double x = x_of(b, curves[i].points.size(), i, curves.size()), y = y_of(point.given);
      svg += print("<circle cx='%.1f' cy='%.1f' r='4' stroke='%s' fill='%s'/>\n", x, y, colour,
                   point.shakes > 0 ? colour : "white");
      if (point.shakes > 0)
        svg += print("<text x='%.1f' y='%.1f' font-size='9' text-anchor='middle' fill='%s'>%llu</text>\n", x,
                     y - 6, colour, static_cast<unsigned long long>(point.shakes));
    }
    svg += print("<text x='%.1f' y='%.1f' fill='%s'>&#9679; %s</text>\n", kLeft,
                 18 + 16 * static_cast<double>(i), colour, curves[i].name.c_str());
  }
  svg +=
      print("<text x='%.1f' y='%.1f' fill='#555'>filled: shakes, with their number; dashed: 10 mJ</text>\n",
            kLeft + 300.0, 18.0);
  return svg + "</svg>\n";
}

}  // namespace lumbrical::bench
