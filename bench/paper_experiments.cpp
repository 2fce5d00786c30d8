// The paper's experiments, under every law: writes one CSV file per experiment and a summary in Markdown.
//
//   paper_experiments FOLDER [triangles] [ridge] [slide] [slope] [fingertip] [poke] [hook] [loop]
//                           [bending_loop] [bend] [figures]
//
// The folder must exist; without names all experiments run. `figures` writes paper.json for the report alone.
// bench/experiments.h says what each of them is.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiments.h"
#include "lumbrical/shapes.h"
#include "paper_figures.h"
#include "print.h"
#include "usage.h"

namespace {

using namespace lumbrical;
using namespace lumbrical::bench;

constexpr double kDegree = std::numbers::pi / 180;

const char* name_of(Law law) { return law_name(law).data(); }  // its names are literals

/// Where an experiment writes: its CSV file, and its part of the summary.
struct Output {
  std::ofstream csv;
  std::string summary;
  void row(const std::string& line) { csv << line << '\n'; }
  void say(const std::string& line) { summary += line + '\n'; }
};

void put_series(const std::string& what, Law law, const Series& series, Output& output) {
  for (const Sample& s : series) {
    output.row(print("%s,%s,%.6g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%u,%u,%.9g", what.c_str(), name_of(law), s.at,
                     s.force.x, s.force.y, s.force.z, norm(s.force), norm(s.theory),
                     std::atan2(s.force.x, s.force.z) / kDegree, s.felt.triangles, s.felt.contacts,
                     s.felt.area));
  }
}

constexpr const char* kSeriesHead =
    ",law,at,force_x_N,force_y_N,force_z_N,force_N,theoretical_N,direction_deg,triangles,contacts,area_m2";

// "1.2 %", and small shares with an exponent.
std::string share(double value) {
  return std::fabs(value) > 5e-5 || value == 0 ? print("%.2f %%", 100 * value) : print("%.1e", value);
}

void run_triangles(Output& output) {
  output.row("tilt_deg,edge_m,law,force_over_undivided");
  output.say("Figure 9: force over that of the undivided plane (`point`: N), mean of 16 places\n");
  for (const double tilt : {90.0, 0.0}) {
    output.say(print("| tilt %g deg, cells of | field | column | max-depth | centroid | point |", tilt));
    output.say("|---|---|---|---|---|---|");
    for (const double edge : {0.0, 0.016, 0.008, 0.004, 0.002, 0.001, 0.0005}) {
      std::string line = edge == 0 ? "| one triangle |" : print("| %g mm |", 1000 * edge);
      for (const Law law : kLaws) {
        const double ratio = divided_over_undivided(law, tilt * kDegree, edge, 16);
        output.row(print("%g,%g,%s,%.12g", tilt, edge, name_of(law), ratio));
        line += print(" %.*f |", law == Law::point ? 1 : 3, ratio);
      }
      output.say(line);
    }
    output.say("");
  }
}

void run_ridge(Output& output) {
  output.row("law,lean_deg");
  output.say(
      "Figure 9: fingertip on a symmetric ridge, large triangles on one side, small ones on the other\n");
  output.say("| law | force leans to the large triangles' side by |\n|---|---|");
  for (const Law law : kLaws) {
    const double lean = lean_on_ridge(law) / kDegree;
    output.row(print("%s,%.12g", name_of(law), lean));
    output.say(print("| %s | %.3g degrees |", name_of(law), lean));
  }
}

void run_slide(Output& output) {
  output.row(std::string("tilt_deg;edge_m;depth_m") + kSeriesHead);
  output.say(
      "Figure 11: 40 mm over an irregular flat mesh. Bias against the undivided plane / peak to peak / "
      "largest step per 0.1 mm\n");
  output.say("| tilt, cells, depth | triangles | field | column | max-depth | centroid | point (no area) |");
  output.say("|---|---|---|---|---|---|---|");
  const Slide slides[] = {{0, 0.0015},         {0, 0.006},         {0, 0.025},        {25, 0.0015},
                          {25, 0.006},         {25, 0.012},        {60, 0.003},       {90, 0.003},
                          {25, 0.006, 0.0003}, {25, 0.006, 0.001}, {25, 0.006, 0.003}};
  for (Slide slide : slides) {
    const std::string what = print("%g;%g;%g", slide.tilt, slide.edge, slide.depth);
    std::string line = print("| %g deg, %g mm, %g mm |", slide.tilt, 1000 * slide.edge, 1000 * slide.depth);
    slide.tilt *= kDegree;
    for (const Law law : kLaws) {
      const Series series = bench::slide(slide, law);
      put_series(what, law, series, output);
      const Evenness e = evenness_of(series);
      if (law == Law::field) line += print(" %u-%u |", e.least, e.most);
      line += law == Law::point ? " -" : " " + share(e.bias);
      line += " / " + share(e.peak_to_peak) + " / " + share(e.largest_step) + " |";
    }
    output.say(line);
  }
}

void run_slope(Output& output) {
  output.row(std::string("angle_deg;edge_m") + kSeriesHead);
  output.say(
      "Figures 12 and 13: fingertip from a plane onto a slope. Largest turn / largest step of the "
      "magnitude per 0.1 mm\n");
  output.say("| slope, cells | triangles | field | column | max-depth | centroid | point |");
  output.say("|---|---|---|---|---|---|---|");
  for (const double angle : {30.0, -30.0}) {
    for (const double edge : {0.0015, 0.006}) {
      const std::string what = print("%g;%g", angle, edge);
      std::string line =
          print("| %s by %g deg, %g mm |", angle > 0 ? "falls" : "rises", std::fabs(angle), 1000 * edge);
      for (const Law law : kLaws) {
        const Series series = follow_slope(angle * kDegree, edge, law);
        put_series(what, law, series, output);
        const Evenness e = evenness_of(series);
        if (law == Law::field) line += print(" %u-%u |", e.least, e.most);
        line += print(" %.2f deg / ", e.largest_turn / kDegree) + share(e.largest_step) + " |";
      }
      output.say(line);
    }
  }
}

void run_fingertip(Output& output) {
  output.row(std::string("cells") + kSeriesHead);
  output.say(
      "Figure 14: fingertip over a bumpy surface. Mean force [N] / largest change of the force vector per "
      "0.1 mm, as a share of the mean\n");
  output.say("| edges | triangles | field | column | max-depth | centroid | point |");
  output.say("|---|---|---|---|---|---|---|");
  for (const std::uint32_t cells : {20u, 40u, 80u, 160u, 320u}) {
    std::string line = print("| %g mm |", 80.0 / cells);
    for (const Law law : kLaws) {
      const Series series = sweep_fingertip(cells, law);
      put_series(std::to_string(cells), law, series, output);
      const Evenness e = evenness_of(series);
      if (law == Law::field) line += print(" %u-%u |", e.least, e.most);
      line += print(" %.4g / ", e.mean) + share(e.largest_jump) + " |";
    }
    output.say(line);
  }
}

void run_poke(Output& output) {
  output.row(std::string("tilt_deg") + kSeriesHead);
  output.say(
      "Figure 15: pushed straight through a plane. Force [N] at depth 2 / 8 / 12 / 20 / 30 mm, largest step "
      "per 0.1 mm [N]\n");
  output.say("| tilt | field | column | max-depth | centroid | point |\n|---|---|---|---|---|---|");
  for (const double tilt : {90.0, 80.0, 0.0}) {
    std::string line = print("| %g deg |", tilt);
    for (const Law law : kLaws) {
      const Series series = poke(tilt * kDegree, 0.0301, law);
      put_series(print("%g", tilt), law, series, output);
      for (const std::size_t i : {20u, 80u, 120u, 200u, 300u})
        line += print("%s%.3g", i == 20 ? " " : " / ", norm(series[i].force));
      double step = 0;
      for (std::size_t i = 1; i < series.size(); ++i)
        step = std::fmax(step, norm(series[i].force - series[i - 1].force));
      line += print(", %.3g |", step);
    }
    output.say(line);
  }
}

void run_hook(Output& output) {
  output.row("law,force_x_N,force_y_N,force_z_N");
  output.say("Finger hooked round a 90 degree edge: the pull is along x\n");
  output.say("| law | F_x [N] | F_z [N] | F_z over F_x |\n|---|---|---|---|");
  for (const Law law : kLaws) {
    const Vec3 force = hook(law);
    output.row(print("%s,%.9g,%.9g,%.9g", name_of(law), force.x, force.y, force.z));
    output.say(print("| %s | %.3f | %.3f | %.3f |", name_of(law), force.x, force.z, force.z / force.x));
  }
}

void run_loop(Output& output) {
  output.row("obstacle,finger,law,work_J,quadrature_error_J,largest_force_N,length_m,ticks");
  output.say("Work round a closed loop, |W| over F_max L (bound of the quadrature's own error)\n");
  output.say(
      "| obstacle, finger | field | column | max-depth | centroid | point |\n|---|---|---|---|---|---|");
  PosedFinger cone = one_phalanx();
  cone.radius = {0.008, 0.006};
  for (const Obstacle obstacle : kObstacles) {
    for (const bool tapered : {false, true}) {
      const char* finger = tapered ? "tapered" : "even";
      std::string line = print("| %s, %s |", obstacle_name(obstacle), finger);
      for (const Law law : kLaws) {
        const bool exact = law == Law::field;
        const LoopWork w =
            work_over(obstacle, tapered ? cone : one_phalanx(), law, exact ? 1e-12 : 1e-5, exact ? 14 : 5);
        output.row(print("%s,%s,%s,%.6e,%.2e,%.6g,%.6g,%d", obstacle_name(obstacle), finger, name_of(law),
                         w.work, w.error, w.largest_force, w.length, w.nodes));
        line += print(" %.1e (%.0e) |", std::fabs(w.relative()), w.relative_error());
      }
      output.say(line);
    }
  }
}

void run_bending_loop(Output& output) {
  output.row("first_deg,second_deg,finger,law,work_J,largest_force_N,length_m");
  output.say(
      "Work of segment forces and torques while the joints bend round a closed loop, |W| over F_max L\n");
  output.say("| joints about, finger | field | column | max-depth |\n|---|---|---|---|");
  for (const double first : {0.0, 40.0, 80.0}) {
    for (const bool tapered : {false, true}) {
      const char* finger = tapered ? "tapered" : "even";
      std::string line = print("| %g and %g deg, %s |", first, 0.9 * first, finger);
      for (const Law law : {Law::field, Law::column, Law::max_depth}) {
        const LoopWork w = work_of_bending(first * kDegree, 0.9 * first * kDegree, tapered, law, 2048);
        output.row(print("%g,%g,%s,%s,%.6e,%.6g,%.6g", first, 0.9 * first, finger, name_of(law), w.work,
                         w.largest_force, w.length));
        line += print(" %.1e |", std::fabs(w.relative()));
      }
      output.say(line);
    }
  }
}

void run_bend(Output& output) {
  output.row(std::string("mesh;roll_deg;ratio") + kSeriesHead);
  output.say(
      "A lying finger bends both joints from -30 to 110 degrees, 0.1 degrees per tick. Largest force / "
      "largest step [N] / share of the field law's bound\n");
  output.say("| mesh, bends | field | column | max-depth | centroid | point |\n|---|---|---|---|---|---|");
  const std::pair<const char*, Mesh> meshes[] = {
      {"flat, 6 mm", graded_plane(0.24, 0.24, 0.006, 71)},
      {"flat, 2 mm", graded_plane(0.24, 0.24, 0.002, 72)},
      {"bumpy, 4 mm", make_height_field(0.24, 60, 0.001, 0.03)},
  };
  for (const auto& [mesh_name, mesh] : meshes) {
    for (const double roll : {0.0, 45.0, 90.0}) {
      for (const double ratio : {0.0, 0.5, 1.0}) {
        std::string line = print("| %s, %s, second joint %g |", mesh_name,
                                 roll == 0    ? "into it"
                                 : roll == 90 ? "within it"
                                              : "obliquely",
                                 ratio);
        for (const Law law : kLaws) {
          Bend plan;
          plan.roll = roll * kDegree;
          plan.ratio = ratio;
          const BendResult result = bend(mesh, plan, law);
          put_series(print("%s;%g;%g", mesh_name, roll, ratio), law, result.series, output);
          line += print(" %.3g / %.3g / %.2f |", result.largest_force, result.largest_step,
                        result.share_of_bound);
        }
        output.say(line);
      }
    }
  }
}

struct Experiment {
  const char* name;
  void (*run)(Output& output);
};

constexpr Experiment kExperiments[] = {
    {"triangles", run_triangles},       {"ridge", run_ridge}, {"slide", run_slide}, {"slope", run_slope},
    {"fingertip", run_fingertip},       {"poke", run_poke},   {"hook", run_hook},   {"loop", run_loop},
    {"bending_loop", run_bending_loop}, {"bend", run_bend},
};

constexpr const char* kFigures = "figures";

bool is_known(const std::string& name) {
  const auto has_name = [&](const Experiment& experiment) { return name == experiment.name; };
  return name == kFigures || std::any_of(std::begin(kExperiments), std::end(kExperiments), has_name);
}

int usage(int count, char** words) {
  std::string names;
  for (const Experiment& experiment : kExperiments) names += print(" [%s]", experiment.name);
  return bench::tell_usage(print("paper_experiments FOLDER%s [%s]", names.c_str(), kFigures).c_str(), count,
                           words);
}

bool is_wanted(const std::string& name, const std::vector<std::string>& wanted) {
  return wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end();
}

bool is_written(std::ofstream& file) {
  file.close();
  return !file.fail();
}

int cannot_write(const std::string& folder) {
  std::fprintf(stderr, "%s: can't be written to; is there such a folder, and room?\n", folder.c_str());
  return 2;
}

int run(const std::string& folder, const std::vector<std::string>& wanted) {
  if (is_wanted(kFigures, wanted)) {
    std::ofstream file(folder + "/paper.json");
    if (file) file << paper_figures_json("build/release/bench/paper_experiments FOLDER figures");
    if (!is_written(file)) return cannot_write(folder);
    if (wanted.size() == 1) return 0;
  }
  std::ofstream summary(folder + "/paper_experiments.md");
  for (const Experiment& experiment : kExperiments) {
    if (!is_wanted(experiment.name, wanted)) continue;
    Output output;
    output.csv.open(folder + "/" + experiment.name + ".csv");
    if (output.csv) experiment.run(output);
    if (!is_written(output.csv)) return cannot_write(folder);
    const std::string part = "## " + std::string(experiment.name) + "\n\n" + output.summary + "\n";
    std::fputs(part.c_str(), stdout);
    std::fflush(stdout);
    summary << part;
  }
  return is_written(summary) ? 0 : cannot_write(folder);
}

}  // namespace

int main(int count, char** arguments) {
  const std::vector<std::string> all(arguments + 1, arguments + count);
  if (all.empty() || has_switch(count, arguments) || !std::all_of(all.begin() + 1, all.end(), is_known))
    return usage(count, arguments);
  try {
    return run(all[0], {all.begin() + 1, all.end()});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
