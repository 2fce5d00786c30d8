// See report_plot.h.
#include "report_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "output.h"
#include "report_style.h"
#include "report_text.h"

namespace lumbrical::tool {
namespace {

constexpr double kWidth = 400, kHeight = 300, kLeft = 62, kRight = 14, kTop = 28, kBottom = 46;
constexpr double kZeroWidth = 66;  // of the place for x = 0
constexpr std::size_t kColourCount = 8, kShapeCount = 8;

struct Tick {
  double value = 0;
  bool labelled = true;
};

/// A logarithmic axis between two places in the picture.
struct Axis {
  double low = 1, high = 10;  // values at its ends
  double from = 0, to = 0;    // their places
  std::vector<Tick> ticks;
  [[nodiscard]] double place(double value) const {
    return from + (to - from) * (std::log10(value / low) / std::log10(high / low));
  }
};

// Ends at 1, 2 or 5 times a power of ten; ticks at the powers, and at 2 and 5 too where there is room.
Axis make_axis(double least, double most, double from, double to) {
  std::vector<double> steps;
  const int first = static_cast<int>(std::floor(std::log10(least))) - 1;
  const int last = static_cast<int>(std::ceil(std::log10(most))) + 1;
  for (int power = first; power <= last; ++power) {
    for (const double digit : {1.0, 2.0, 5.0}) steps.push_back(digit * std::pow(10.0, power));
  }
  // A point on the frame would be cut in half, hence the strict comparisons.
  const auto low = std::lower_bound(steps.begin(), steps.end(), least * (1 - 1e-9)) - 1;
  const auto high = std::upper_bound(steps.begin(), steps.end(), most * (1 + 1e-9));
  Axis axis{*low, *high, from, to, {}};
  const double decades = std::log10(axis.high / axis.low);
  const int every = std::max(1, static_cast<int>(std::ceil(decades / 6)));
  for (auto step = low; step <= high; ++step) {
    const auto index = step - steps.begin();
    const int power = first + static_cast<int>(index / 3);
    const bool is_power = index % 3 == 0;
    if (decades <= 2.5 || is_power) axis.ticks.push_back({*step, decades <= 2.5 || power % every == 0});
  }
  return axis;
}

std::string tick_text(double value) {
  const bool plain = value > 0.9e-3 && value < 1.1e5;
  std::string text = print(plain ? "%.4g" : "%.0e", value);
  const std::size_t zero = text.find("e-0");
  if (zero != std::string::npos) text.erase(zero + 2, 1);
  const std::size_t plus = text.find("e+");
  if (plus != std::string::npos) text.erase(plus + 1, text[plus + 2] == '0' ? 2 : 1);
  return text;
}

struct Frame {
  Axis x, y;
  bool has_zero = false;
  [[nodiscard]] double x_of(double value) const {
    return value > 0 ? x.place(value) : kLeft + kZeroWidth / 2;
  }
  [[nodiscard]] double y_of(double value) const { return y.place(value); }
};

Frame make_frame(const std::vector<PlotPoint>& points, double deadline, double limit) {
  Frame frame;
  double least_x = limit > 0 ? limit : HUGE_VAL, most_x = limit, least_y = deadline > 0 ? deadline : HUGE_VAL,
         most_y = deadline;
  for (const PlotPoint& point : points) {
    frame.has_zero |= point.x <= 0;
    if (point.x > 0) {
      least_x = std::min(least_x, point.x);
      most_x = std::max(most_x, point.x);
    }
    least_y = std::min(least_y, point.y);
    most_y = std::max(most_y, point.y);
  }
  if (most_x <= 0) least_x = most_x = 1;
  const double left = kLeft + (frame.has_zero ? kZeroWidth : 0);
  frame.x = make_axis(least_x, most_x, left, kWidth - kRight);
  frame.y = make_axis(least_y, most_y, kHeight - kBottom, kTop);
  return frame;
}

std::string axes_svg(const Frame& frame, const Figure& figure) {
  const double bottom = kHeight - kBottom, right = kWidth - kRight;
  std::string svg;
  for (const Tick& tick : frame.x.ticks) {
    const double x = frame.x.place(tick.value);
    svg += print("<path class=\"grid\" d=\"M%.2f %.1fV%.1f\"/>\n", x, kTop, bottom);
    if (tick.labelled)
      svg += print("<text class=\"x\" x=\"%.2f\" y=\"%.1f\">%s</text>\n", x, bottom + 15,
                   tick_text(tick.value).c_str());
  }
  for (const Tick& tick : frame.y.ticks) {
    const double y = frame.y.place(tick.value);
    svg += print("<path class=\"grid\" d=\"M%.1f %.2fH%.1f\"/>\n", frame.x.from, y, right);
    if (tick.labelled)
      svg += print("<text class=\"y\" x=\"%.1f\" y=\"%.2f\" dy=\"4\">%s</text>\n", kLeft - 5, y,
                   tick_text(tick.value).c_str());
  }
  if (frame.has_zero) {
    svg += print("<path class=\"zero\" d=\"M%.1f %.1fV%.1f\"/>\n", frame.x_of(0), kTop, bottom);
    svg += print("<text class=\"x\" x=\"%.2f\" y=\"%.1f\">", frame.x_of(0), bottom + 15) +
           escaped(figure.zero) + "</text>\n";
  }
  svg += print("<text class=\"x\" x=\"%.1f\" y=\"%.1f\">", (kLeft + right) / 2, kHeight - 10) +
         escaped(figure.x_label) + "</text>\n";
  svg += print("<text class=\"x\" transform=\"translate(12 %.1f) rotate(-90)\">", (kTop + bottom) / 2) +
         escaped(figure.y_label) + "</text>\n";
  return svg;
}

// A shape round the origin: which precision a point stands for is not told by its colour alone.
std::string shape_svg(std::size_t marker) {
  constexpr std::array<const char*, kShapeCount> kShapes = {
      "<circle r=\"4\"/>",
      "<path d=\"M-3.6 -3.6H3.6V3.6H-3.6Z\"/>",
      "<path d=\"M0 -4.6L4.6 3.6H-4.6Z\"/>",
      "<path d=\"M0 -5.2L4.2 0L0 5.2L-4.2 0Z\"/>",
      "<path d=\"M0 4.6L4.6 -3.6H-4.6Z\"/>",
      "<path d=\"M-1.4 -4.6H1.4V-1.4H4.6V1.4H1.4V4.6H-1.4V1.4H-4.6V-1.4H-1.4Z\"/>",
      "<path d=\"M-4.6 -2H4.6V2H-4.6Z\"/>",
      "<path d=\"M-2 -4.6H2V4.6H-2Z\"/>"};
  return kShapes[marker % kShapeCount];
}

std::string point_svg(const Frame& frame, const PlotPoint& point, bool on_front) {
  std::string svg =
      print("<g class=\"point s%zu%s\" transform=\"translate(%.2f %.2f)\">", point.series % kColourCount,
            on_front ? " front" : "", frame.x_of(point.x), frame.y_of(point.y));
  if (on_front) svg += "<circle class=\"ring\" r=\"7.5\"/>";
  return svg + shape_svg(point.marker) + "<title>" + escaped(point.label) + "</title></g>\n";
}

// Right of it and above it everything is beaten.
std::string front_svg(const Frame& frame, const std::vector<PlotPoint>& points,
                      const std::vector<std::size_t>& front) {
  std::string path;
  for (const std::size_t i : front) {
    const double x = frame.x_of(points[i].x), y = frame.y_of(points[i].y);
    path += path.empty() ? print("M%.2f %.1fV%.2f", x, kTop, y) : print("H%.2fV%.2f", x, y);
  }
  return print("<path class=\"staircase\" d=\"%sH%.1f\"/>\n", path.c_str(), kWidth - kRight);
}

std::string lines_svg(const Frame& frame, const std::vector<PlotPoint>& points) {
  std::string svg;
  std::vector<const PlotPoint*> order;
  for (const PlotPoint& point : points) {
    if (point.joined) order.push_back(&point);
  }
  std::stable_sort(order.begin(), order.end(), [](const PlotPoint* a, const PlotPoint* b) {
    return std::pair(a->series, a->x) < std::pair(b->series, b->x);
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const PlotPoint& point = *order[i];
    const bool first = i == 0 || order[i - 1]->series != point.series;
    if (first && i > 0) svg += "\"/>\n";
    if (first) svg += print("<path class=\"line s%zu\" d=\"", point.series % kColourCount);
    svg += print("%c%.2f %.2f", first ? 'M' : 'L', frame.x_of(point.x), frame.y_of(point.y));
  }
  return order.empty() ? svg : svg + "\"/>\n";
}

std::string deadline_svg(const Frame& frame, const Figure& figure) {
  if (figure.deadline <= 0) return {};
  const double y = frame.y_of(figure.deadline);
  return print("<path class=\"deadline\" d=\"M%.1f %.2fH%.1f\"/>\n", kLeft, y, kWidth - kRight) +
         print("<text class=\"deadline\" x=\"%.1f\" y=\"%.2f\">", kLeft + 4, y - 4) +
         escaped(figure.deadline_name) + "</text>\n";
}

std::string limit_svg(const Frame& frame, const Figure& figure) {
  if (figure.limit <= 0) return {};
  const double x = frame.x_of(figure.limit);
  return print("<path class=\"deadline\" d=\"M%.2f %.1fV%.1f\"/>\n", x, kTop, kHeight - kBottom) +
         print("<text class=\"deadline left\" x=\"%.2f\" y=\"%.1f\">", x + 20, kTop - 2) +
         escaped(figure.limit_name) + "</text>\n";
}

// ---- Names beside marks ----

constexpr double kLetter = 5.4, kLine = 11;  // a name's width per byte, at most, and its height

struct Box {
  double left, right, middle, half;  // half its height
  [[nodiscard]] bool meets(const Box& other) const {
    return left < other.right && other.left < right && std::fabs(middle - other.middle) < half + other.half;
  }
};

// On the side of the mark that has more room, as near to its height as marks and earlier names leave place.
Box place_for(const PlotPoint& point, const Frame& frame, const std::vector<Box>& taken) {
  const double x = frame.x_of(point.x), y = frame.y_of(point.y);
  const double width = kLetter * static_cast<double>(point.name.size());
  const bool to_left = x > 0.6 * kWidth;
  Box box{to_left ? x - 9 - width : x + 9, to_left ? x - 9 : x + 9 + width, y, kLine / 2};
  for (int step = 0; step < 40; ++step) {
    const double away = 0.5 * kLine * ((step + 1) / 2);
    box.middle = step % 2 == 0 ? y + away : y - away;
    const bool inside = box.middle > kTop + kLine / 2 && box.middle < kHeight - kBottom - kLine / 2;
    if (inside && std::none_of(taken.begin(), taken.end(), [&](const Box& b) { return b.meets(box); })) break;
  }
  return box;
}

std::string names_svg(const Frame& frame, const Figure& figure, const std::vector<PlotPoint>& points) {
  std::vector<Box> taken;
  for (const PlotPoint& point : points) {
    const double x = frame.x_of(point.x);
    taken.push_back({x - 7, x + 7, frame.y_of(point.y), 5});
  }
  if (figure.deadline > 0) taken.push_back({kLeft, kWidth, frame.y_of(figure.deadline), 1});
  std::string svg;
  for (const PlotPoint& point : points) {
    if (point.name.empty()) continue;
    const Box box = taken.emplace_back(place_for(point, frame, taken));
    const double x = frame.x_of(point.x), y = frame.y_of(point.y);
    const bool to_left = box.right < x;
    const double at = to_left ? box.right : box.left;
    if (std::fabs(box.middle - y) > kLine / 2)
      svg += print("<path class=\"leader\" d=\"M%.2f %.2fL%.2f %.2f\"/>\n", x, y, at, box.middle);
    svg += print("<text class=\"name%s\" x=\"%.2f\" y=\"%.2f\" dy=\"3.5\">", to_left ? " left" : "", at,
                 box.middle) +
           escaped(point.name) + "</text>\n";
  }
  return svg;
}

std::string opening_tag(const Figure& figure, const Plot& plot, double height, const char* space) {
  return print("<svg%s viewBox=\"0 0 %g %g\" role=\"img\" aria-label=\"", space, kWidth, height) +
         escaped(plot.title + ": " + figure.y_label + " against " + figure.x_label) + "\">\n";
}

std::string plot_svg(const Figure& figure, const Plot& plot) {
  const Frame frame = make_frame(plot.points, figure.deadline, figure.limit);
  std::string svg = print("<text class=\"title\" x=\"%.1f\" y=\"16\">", kLeft) + escaped(plot.title) +
                    "</text>\n" + axes_svg(frame, figure);
  std::vector<std::size_t> front;
  if (figure.front) front = pareto_front(plot.points);
  svg += deadline_svg(frame, figure) + limit_svg(frame, figure);
  if (figure.front) svg += front_svg(frame, plot.points, front);
  if (figure.joined) svg += lines_svg(frame, plot.points);
  for (std::size_t i = 0; i < plot.points.size(); ++i) {
    const bool on_front = std::find(front.begin(), front.end(), i) != front.end();
    svg += point_svg(frame, plot.points[i], on_front);
  }
  return svg + names_svg(frame, figure, plot.points);
}

std::string legend_html(const Figure& figure) {
  std::string html = "<p class=\"legend\">\n";
  for (std::size_t i = 0; i < figure.series.size(); ++i)
    html += key_html(print("<g class=\"point s%zu\">", i % kColourCount) + shape_svg(0) + "</g>",
                     figure.series[i]);
  for (std::size_t i = 0; i < figure.markers.size() && figure.markers.size() > 1; ++i)
    html += key_html("<g class=\"point plain\">" + shape_svg(i) + "</g>", figure.markers[i]);
  if (figure.front)
    html += key_html("<g class=\"point plain\"><circle class=\"ring\" r=\"7.5\"/></g>", "Pareto front");
  return html + "</p>\n";
}

}  // namespace

std::string key_html(const std::string& drawing, const std::string& name) {
  return "<span><svg class=\"key\" viewBox=\"-9 -9 18 18\" aria-hidden=\"true\">" + drawing + "</svg>" +
         escaped(name) + "</span>\n";
}

std::size_t index_of(std::vector<std::string>& names, const std::string& name) {
  const auto place = std::find(names.begin(), names.end(), name);
  const auto index = static_cast<std::size_t>(place - names.begin());
  if (place == names.end()) names.push_back(name);
  return index;
}

Plot& plot_of(Figure& figure, const std::string& title) {
  for (Plot& plot : figure.plots) {
    if (plot.title == title) return plot;
  }
  return figure.plots.emplace_back(Plot{title, {}});
}

std::vector<std::size_t> pareto_front(const std::vector<PlotPoint>& points) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].compared) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(points[a].x, points[a].y) < std::pair(points[b].x, points[b].y);
  });
  std::vector<std::size_t> front;
  for (const std::size_t i : order) {
    // Only an equal of the last one on the front may be as high as it.
    const PlotPoint* const last = front.empty() ? nullptr : &points[front.back()];
    const bool equal = last != nullptr && points[i].x <= last->x && points[i].y <= last->y;
    if (last == nullptr || equal || points[i].y < last->y) front.push_back(i);
  }
  return front;
}

std::string escaped(std::string_view text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      case '\'':
        html += "&#39;";
        break;
      default:
        // HTML has no control characters but these.
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') html += c;
    }
  }
  return html;
}

std::string figure_html(const Figure& figure) {
  std::string html = "<figure>\n<h3>" + escaped(figure.title) + "</h3>\n" + legend_html(figure) +
                     "<div class=\"plots" + (figure.deadline > 0 ? " large" : "") + "\">\n";
  for (const Plot& plot : figure.plots)
    html += opening_tag(figure, plot, kHeight, "") + plot_svg(figure, plot) + "</svg>\n";
  return html + "</div>\n<figcaption><p>" + escaped(figure.note) + "</p></figcaption>\n</figure>\n";
}

std::string picture_svg(const Figure& figure, const Plot& plot) {
  constexpr double kRow = 15;
  std::vector<std::size_t> shown;  // series that have a point here
  for (std::size_t i = 0; i < figure.series.size(); ++i)
    if (std::any_of(plot.points.begin(), plot.points.end(),
                    [i](const PlotPoint& p) { return p.series == i; }))
      shown.push_back(i);
  const double height = kHeight + 6 + kRow * static_cast<double>(shown.size());
  std::string svg = opening_tag(figure, plot, height, " xmlns=\"http://www.w3.org/2000/svg\"") + "<style>\n" +
                    kPlotColours + "svg { font-family: system-ui, sans-serif; }\n" + kPlotMarks +
                    "</style>\n" +
                    print("<rect width=\"%g\" height=\"%g\" fill=\"var(--back)\"/>\n", kWidth, height) +
                    plot_svg(figure, plot);
  for (std::size_t row = 0; row < shown.size(); ++row) {
    const std::size_t i = shown[row];
    const double y = kHeight + 4 + kRow * static_cast<double>(row);
    svg += print("<g class=\"point s%zu\" transform=\"translate(%.1f %.1f)\">", i % kColourCount, kLeft, y) +
           shape_svg(0) + "</g>" + print("<text x=\"%.1f\" y=\"%.1f\">", kLeft + 10, y + 4) +
           escaped(figure.series[i]) + "</text>\n";
  }
  return svg + "</svg>\n";
}

}  // namespace lumbrical::tool
