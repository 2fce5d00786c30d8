// See paper_figures.h.
#include "paper_figures.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "experiments.h"
#include "origin.h"
#include "print.h"

namespace lumbrical::bench {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

struct CurveLaw {
  Law law;
  const char* name;
};
constexpr CurveLaw kCurveLaws[] = {{Law::max_depth, "the paper's law"}, {Law::field, "the exact law"}};

std::string list(const std::vector<std::string>& texts) {
  std::string json = "[";
  for (const std::string& text : texts) json += (json.size() > 1 ? ", " : "") + text;
  return json + "]";
}

std::string curve(const char* name, const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<std::string> across, up;
  for (const double value : x) across.push_back(print("%.6g", value));
  for (const double value : y) up.push_back(print("%.6g", value));
  return "{\"series\": " + quoted(name) + ",\n \"x\": " + list(across) + ",\n \"y\": " + list(up) + "}";
}

std::string panel(const std::string& title, const std::string& x_label, const std::string& y_label,
                  const std::vector<std::string>& curves) {
  return "{\"title\": " + quoted(title) + ", \"x_label\": " + quoted(x_label) +
         ", \"y_label\": " + quoted(y_label) + ", \"curves\": " + list(curves) + "}";
}

std::string figure(const std::string& title, const std::string& note,
                   const std::vector<std::string>& panels) {
  return "{\"title\": " + quoted(title) + ",\n\"note\": " + quoted(note) + ",\n\"panels\": " + list(panels) +
         "}";
}

/// What of a tick a curve shows.
using Shown = std::function<double(const Sample&)>;

double magnitude(const Sample& sample) { return norm(sample.force); }
double direction(const Sample& sample) { return std::atan2(sample.force.x, sample.force.z) / kDegree; }

/// The same experiment under both laws.
std::string series_panel(const std::string& title, const std::string& x_label, const std::string& y_label,
                         const std::function<Series(Law)>& run, const Shown& shown) {
  std::vector<std::string> curves;
  for (const auto& [law, name] : kCurveLaws) {
    std::vector<double> x, y;
    for (const Sample& sample : run(law)) {
      x.push_back(1e3 * sample.at);
      y.push_back(shown(sample));
    }
    curves.push_back(curve(name, x, y));
  }
  return panel(title, x_label, y_label, curves);
}

std::string triangle_sizes() {
  std::vector<std::string> panels;
  for (const auto& [tilt, title] : {std::pair(90.0, "Fingertip, upright"), std::pair(0.0, "Finger, lying")}) {
    std::vector<std::string> curves;
    for (const auto& [law, name] : kCurveLaws) {
      std::vector<double> x, y;
      for (const double edge : {0.0005, 0.001, 0.002, 0.004, 0.008, 0.016}) {
        x.push_back(1e3 * edge);
        y.push_back(divided_over_undivided(law, tilt * kDegree, edge, 16));
      }
      curves.push_back(curve(name, x, y));
    }
    panels.push_back(panel(title, "triangle size [mm]", "force over that of the undivided plane", curves));
  }
  return figure("Figure 9: large and small triangles",
                "The same plane cut into triangles of different sizes: mean force of 16 places, over the "
                "integral of the law's own depth. 1 is right.",
                panels);
}

std::string slides() {
  std::vector<std::string> panels;
  for (const auto& [tilt, edge] : {std::pair(0.0, 0.006), std::pair(25.0, 0.0015), std::pair(25.0, 0.006)})
    panels.push_back(series_panel(
        print("Tilted by %g degrees, cells of %g mm", tilt, 1e3 * edge), "way [mm]", "force [N]",
        [plan = Slide{tilt * kDegree, edge}](Law law) { return slide(plan, law); }, magnitude));
  return figure("Figure 11: a slide over a flat mesh",
                "The plane is the same everywhere, so the force should be. Triangles are irregular.", panels);
}

std::string slopes() {
  std::vector<std::string> panels;
  for (const auto& [angle, title] : {std::pair(30.0, "Onto a slope that falls by 30 degrees"),
                                     std::pair(-30.0, "Onto a slope that rises by 30 degrees")}) {
    const auto run = [angle = angle](Law law) { return follow_slope(angle * kDegree, 0.006, law); };
    panels.push_back(series_panel(title, "way [mm], the edge at 0", "force [N]", run, magnitude));
    panels.push_back(series_panel(std::string(title) + ": direction", "way [mm], the edge at 0",
                                  "direction [degrees]", run, direction));
  }
  return figure("Figures 12 and 13: from a plane onto a slope",
                "A fingertip follows plane and slope at the same distance; triangles of 6 mm.", panels);
}

std::string fingertips() {
  std::vector<std::string> panels;
  for (const std::uint32_t cells : {20u, 80u, 320u})
    panels.push_back(series_panel(
        print("Triangles of %g mm", 80.0 / cells), "way [mm]", "force [N]",
        [cells](Law law) { return sweep_fingertip(cells, law); }, magnitude));
  return figure(
      "Figure 14: a fingertip on a bumpy surface",
      "The same surface, cut ever finer. Under the exact law the curve changes with the surface alone.",
      panels);
}

std::string pokes() {
  std::vector<std::string> panels;
  for (const double tilt : {90.0, 80.0, 0.0})
    panels.push_back(series_panel(
        tilt == 0 ? std::string("A lying finger") : print("A finger at %g degrees", tilt), "depth [mm]",
        "force [N]", [tilt](Law law) { return poke(tilt * kDegree, 0.0301, law); }, magnitude));
  return figure("Figure 15: pushed through a plane",
                "A finger of radius 8 mm, pushed straight through a plane of 3 mm triangles.", panels);
}

}  // namespace

std::string paper_figures_json(const std::string& command) {
  return "{" + origin_members() + "\"title\": \"The paper's experiments\",\n\"command\": " + quoted(command) +
         ",\n\"figures\": " + list({triangle_sizes(), slides(), slopes(), fingertips(), pokes()}) + "}\n";
}

}  // namespace lumbrical::bench
