// Prints how stiff a joint may be rendered: predicted passive limits against where the simulated loop starts
// to shake, what the limiter makes of a touch of the real engine, and what a local model gains on a slow bus.
#include <cstdio>

#include "print.h"
#include "simulated_loop.h"
#include "usage.h"
#include "z_width_plot.h"

namespace {

using namespace lumbrical;
using namespace lumbrical::bench;

constexpr double kFast = 0.001;  // [s] period of a fast bus
// FC16 at 115200 baud, 8N1: 17 registers with feedback of 22, and 62 with the local model's.
constexpr double kPlainCycle = (9 + 2 * 17 + 8 + 7 + 8 + 5 + 2 * 22 + 7) * 10 / 115200.0;
constexpr double kLocalCycle = (9 + 2 * 62 + 8 + 7 + 8 + 5 + 2 * 22 + 7) * 10 / 115200.0;

void print_limits() {
  std::printf("## Passive limit and onset of shaking\n\n");
  std::printf(
      "b = 0.01 N m s/rad, inertia 4e-5 kg m^2, linear one-sided wall, period 1 ms, nothing holds the "
      "joint\n");
  std::printf("but a constant push of 20 N mm. K in N m/rad.\n\n");
  std::printf(
      "| delay [ms] | predicted 2b/T | predicted with delay | shakes from | ratio | with friction 8 N mm, "
      "step 0.3 mrad: "
      "predicted | shakes from |\n|---|---|---|---|---|---|---|\n");
  for (const double delay : {0.001, 0.004, 0.009}) {
    SimulatedLoop loop;
    loop.period = kFast;
    loop.delay = delay;
    loop.seconds = 4;
    const StiffnessBound bound = stiffness_bound({kFast, 0, delay}, loop.dynamics);
    const double onset = shaking_stiffness(loop);
    loop.dynamics.friction = 0.008;
    loop.dynamics.encoder_step = 3e-4;
    const StiffnessBound rubbed = stiffness_bound({kFast, 0, delay}, loop.dynamics);
    std::printf("| %.0f | %.1f | %.2f | %.2f | %.2f | %.2f | %.2f |\n", 1e3 * delay, bound.sampled,
                bound.largest, onset, onset / bound.largest, rubbed.largest, shaking_stiffness(loop));
  }
}

void print_limiter() {
  std::printf("\n## The engine's own touch, with and without limiter\n\n");
  std::printf(
      "Index fingertip on a plane, law `field`; swing of the joint in mrad, * shakes; energy generated in "
      "mJ.\n\n");
  std::printf(
      "| delay [ms] | K_s [N/m^3] | without | energy | account only | energy | limiter | energy | least "
      "factor |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const double delay : {0.001, 0.004, 0.009}) {
    for (const double stiffness : {5e6, 2e7, 1e8}) {
      std::printf("| %.0f | %.0e |", 1e3 * delay, stiffness);
      const Touch touch = engine_touch(stiffness);
      LoopOutcome last;
      for (const int kind : {0, 1, 2}) {
        SimulatedLoop loop;
        loop.delay = delay;
        loop.push = 0.05;
        loop.account = kind > 0;
        loop.limiter = kind == 2;
        last = simulate(loop, touch);
        std::printf(" %.2f%s | %.4f |", 1e3 * last.swing, last.shakes ? " *" : "", 1e3 * last.generated);
      }
      std::printf(" %.3f |\n", last.least_factor);
    }
  }
}

void print_local() {
  std::printf("\n## Local model on a serial line of 115200 baud\n\n");
  std::printf(
      "A hand of 1 N m/rad and 0.02 N m s/rad strokes a round wall twice a second; felt error is the root "
      "mean\n"
      "square of acting less ideal torque. K in N m/rad at 0.1 rad; plain hold sends 17 registers, the local "
      "model\n"
      "62. `in touch`: between about 0.05 and 0.15 rad deep; `tapping`: out of the wall and 0.1 rad into "
      "it.\n\n");
  std::printf(
      "| | commands [Hz] | device's loop | shakes from | in touch, K = 0.2 | 0.5 | 1 | 2 | tapping, K = 0.2 "
      "| 0.5 | 1 | 2 |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  struct Way {
    const char* name;
    double cycle, local;
  };
  for (const Way& way : {Way{"plain hold", kPlainCycle, 0}, Way{"local model", kLocalCycle, 0.001},
                         Way{"local model", kLocalCycle, 0.0001}}) {
    SimulatedLoop loop;
    loop.period = way.cycle;
    loop.delay = way.cycle;
    loop.local_period = way.local;
    loop.seconds = 4;
    std::printf("| %s | %.0f | %s | %.2f |", way.name, 1 / way.cycle,
                way.local == 0     ? "-"
                : way.local > 5e-4 ? "1 kHz"
                                   : "10 kHz",
                shaking_stiffness(loop));
    loop.human = {1, 0.02};
    for (const bool touching : {true, false}) {
      loop.sweep = touching ? 0.05 : 0.1;
      loop.middle = loop.start = touching ? 0.1 : 0;
      for (const double stiffness : {0.2, 0.5, 1.0, 2.0}) {
        // Pushes back on average, so that the joint is where the hand means it to be.
        loop.push = touching ? round_wall(stiffness)(0.1).torque : 0;
        std::printf(" %.1f %% |", 100 * simulate(loop, round_wall(stiffness)).felt_error);
      }
    }
    std::printf("\n");
  }
}

SweepCurve sweep(double delay) {
  SimulatedLoop loop;
  loop.delay = delay;
  SweepCurve curve;
  curve.name = print("%.0f ms of delay; dashed: predicted limit", 1e3 * delay);
  curve.limit = stiffness_bound({kFast, 0, delay}, loop.dynamics).largest;
  for (double stiffness = 0.2; stiffness < 100; stiffness *= 1.08) {
    loop.start = 1.2 * loop.push / stiffness;
    curve.points.push_back({stiffness, simulate(loop, linear_wall(stiffness)).swing});
  }
  return curve;
}

int draw(const char* path) {
  std::FILE* const file = std::fopen(path, "w");
  if (file == nullptr) return std::fprintf(stderr, "%s: can't be written\n", path), 2;
  const std::string svg = plot_sweep({sweep(0.001), sweep(0.004), sweep(0.009)});
  const bool written = std::fwrite(svg.data(), 1, svg.size(), file) == svg.size();
  return std::fclose(file) == 0 && written ? 0 : 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2 || has_switch(argc, argv)) return tell_usage("z_width [PICTURE.svg]", argc, argv);
  std::printf(
      "# How stiff a joint may be rendered\n\nSimulated time: repeat with "
      "`build/release/bench/z_width z_width.svg`.\n\n![sweep](z_width.svg)\n\n");
  print_limits();
  print_limiter();
  print_local();
  return argc > 1 ? draw(argv[1]) : 0;
}
