// See z_width_plot.h.
#include "z_width_plot.h"

#include <algorithm>
#include <cmath>

#include "print.h"

namespace lumbrical::bench {
namespace {

constexpr double kWidth = 720, kHeight = 440, kLeft = 70, kRight = 20, kTop = 20, kBottom = 50;
constexpr int kLowStiffness = -1, kHighStiffness = 2, kLowSwing = -6, kHighSwing = 1;  // powers of ten
constexpr const char* kColours[] = {"#1b6ca8", "#c8553d", "#3a7d44"};

double along(double value, int low, int high) {
  const double exponent = std::log10(std::max(value, 1e-300));
  return (std::clamp(exponent, static_cast<double>(low), static_cast<double>(high)) - low) / (high - low);
}
double x_of(double stiffness) {
  return kLeft + (kWidth - kLeft - kRight) * along(stiffness, kLowStiffness, kHighStiffness);
}
double y_of(double swing) {
  return kHeight - kBottom - (kHeight - kTop - kBottom) * along(swing, kLowSwing, kHighSwing);
}

std::string axes() {
  std::string svg;
  for (int power = kLowStiffness; power <= kHighStiffness; ++power) {
    const double x = x_of(std::pow(10, power));
    svg += print("<path d='M%.1f %.1f V%.1f' stroke='#ddd'/>\n", x, kTop, kHeight - kBottom);
    svg += print("<text x='%.1f' y='%.1f' text-anchor='middle'>%g</text>\n", x, kHeight - 30,
                 std::pow(10, power));
  }
  for (int power = kLowSwing; power <= kHighSwing; ++power) {
    const double y = y_of(std::pow(10, power));
    svg += print("<path d='M%.1f %.1f H%.1f' stroke='#ddd'/>\n", kLeft, y, kWidth - kRight);
    svg +=
        print("<text x='%.1f' y='%.1f' text-anchor='end'>%g</text>\n", kLeft - 6, y + 4, std::pow(10, power));
  }
  svg += print("<text x='%.1f' y='%.1f' text-anchor='middle'>stiffness [N m/rad]</text>\n", kWidth / 2,
               kHeight - 8);
  svg += print("<text transform='translate(16 %.1f) rotate(-90)' text-anchor='middle'>swing [rad]</text>\n",
               kHeight / 2);
  return svg;
}

std::string curve_svg(const SweepCurve& curve, std::size_t number) {
  const char* const colour = kColours[number % std::size(kColours)];
  std::string path;
  for (const SweepPoint& point : curve.points) {
    path += print("%s%.1f %.1f ", path.empty() ? "M" : "L", x_of(point.stiffness), y_of(point.swing));
  }
  const double limit = x_of(curve.limit);
  return print("<path d='M%.1f %.1f V%.1f' stroke='%s' stroke-dasharray='5 4'/>\n", limit, kTop,
               kHeight - kBottom, colour) +
         "<path d='" + path + "' fill='none' stroke-width='2' stroke='" + colour + "'/>\n" +
         print("<text x='%.1f' y='%.1f' fill='%s'>%s</text>\n", kLeft + 12,
               kTop + 18 + 18 * static_cast<double>(number), colour, curve.name.c_str());
}

}  // namespace

std::string plot_sweep(const std::vector<SweepCurve>& curves) {
  std::string svg =
      print(
          "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %g %g' font-family='sans-serif' "
          "font-size='12'>\n<rect width='%g' height='%g' fill='white'/>\n",
          kWidth, kHeight, kWidth, kHeight) +
      axes();
  for (std::size_t i = 0; i < curves.size(); ++i) svg += curve_svg(curves[i], i);
  return svg + "</svg>\n";
}

}  // namespace lumbrical::bench
