// A grasp and a slope in our engine and in others, in one run: what creeps, where it slips, how the force
// jumps, how many ticks a second of processor time has. Writes a table in Markdown.
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <numbers>

#include "hold.h"
#include "usage.h"

namespace {

using namespace lumbrical;
using namespace lumbrical::bench;

constexpr double kGravity = 9.81, kFriction = 0.6, kPi = std::numbers::pi;

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// [mm] of what is held, or was.
std::string way(double millimetres) {
  if (!(std::fabs(millimetres) < 100)) return "lost";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4f", std::fabs(millimetres));
  return text.data();
}

double degrees_of(Quat q) { return 360 / kPi * std::atan2(norm(Vec3{q.x, q.y, q.z}), std::fabs(q.w)); }

// ---- A cylinder of a mug's size, 0.2 kg, between three fingertips ----

constexpr Vec3 kMug{0.037, 0.037, 0.0475};

// Pressed in by `depth` [m], the springs between engine and tracked hand included.
std::array<Vec3, 3> grasp(double depth) {
  std::array<Vec3, 3> tips;
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = 2 * kPi * static_cast<double>(i) / 3 + 0.3, reach = kMug.x + kTipRadius - depth;
    tips[i] = {reach * std::cos(angle), reach * std::sin(angle), 0.0};
  }
  return tips;
}

// [N] along the normals, of all three.
double pressed(const Holder& holder, std::span<const Vec3> tips) {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += dot(holder.felt(i), unit_or({tips[i].x, tips[i].y, 0.0}, {}));
  return sum;
}

struct GraspFigures {
  double drift = 0, turn = 0;  // [mm], [degrees] in 20 s
  double slips_at = 0;         // the weight as a share of mu times the normal forces, where it begins to fall
  double jump = 0;             // [N] of a finger's force from one tick to the next, while it lets go
  double rate = 0;             // [1/s]
};

constexpr double kGrip = 6;  // [N] of all three

// How far the fingertips have to be pressed in, to grip so firmly.
double grip_depth(const HoldEngine& engine) {
  double low = 0, high = 0.005;
  for (int k = 0; k < 14; ++k) {
    const double middle = 0.5 * (low + high);
    const Holder holder = engine.make({true, kMug, 0.2, kFriction, {}}, grasp(0));
    const std::array<Vec3, 3> tips = grasp(middle);
    for (int i = 0; i < 300; ++i) holder.step(tips);
    (pressed(holder, tips) < kGrip ? low : high) = middle;
  }
  return high;
}

// It is put into the grasp within 5 ms, and settles for two seconds.
GraspFigures run_grasp(const HoldEngine& engine) {
  GraspFigures figures;
  const double depth = grip_depth(engine);
  const HeldBody mug{true, kMug, 0.2, kFriction, {0, 0, -kGravity}};
  std::array<Vec3, 3> tips = grasp(depth);
  const Holder holder = engine.make(mug, grasp(0));
  for (int i = 0; i < 2000; ++i) holder.step(tips = grasp(depth * std::min(1.0, i / 5.0)));
  const Pose before = holder.pose();
  const double start = processor_seconds();
  for (int i = 0; i < 20000; ++i) holder.step(tips);
  figures.rate = 20000 / (processor_seconds() - start);
  const Pose after = holder.pose();
  figures.drift = 1000 * norm(after.position - before.position);
  figures.turn = degrees_of(after.orientation * conjugate(before.orientation));
  // The fingers let go by 0.1 mm/s.
  std::array<Vec3, 3> felt{};
  for (std::size_t k = 0; k < 3; ++k) felt[k] = holder.felt(k);
  for (int i = 0; i < 60000; ++i) {
    tips = grasp(depth - 1e-7 * i);
    holder.step(tips);
    for (std::size_t k = 0; k < 3; ++k) {
      figures.jump = std::max(figures.jump, norm(holder.felt(k) - felt[k]));
      felt[k] = holder.felt(k);
    }
    const double fallen = after.position.z - holder.pose().position.z;
    if (!(fallen < 0.003)) break;  // skin and springs give way by less
    figures.slips_at = 0.2 * kGravity / (kFriction * pressed(holder, tips));
  }
  return figures;
}

// ---- A block of 0.3 kg on four fingertips whose tops are a slope ----

struct SlopeFigures {
  double creep = 0;         // [mm] in 20 s at 0.3 rad
  double slips_at = 0;      // [degrees]
  double acceleration = 0;  // at 40 degrees, over what Coulomb says
};

Holder on_slope(const HoldEngine& engine, double angle, std::array<Vec3, 4>& tips) {
  // As seen from the slope: gravity is turned.
  const HeldBody block{false,
                       {0.4, 0.03, 0.025},
                       0.3,
                       kFriction,
                       {kGravity * std::sin(angle), 0, -kGravity * std::cos(angle)}};
  std::size_t i = 0;
  for (const double x : {-0.2, 0.2})
    for (const double y : {-0.02, 0.02}) tips[i++] = {x, y, -0.025 - kTipRadius + 2e-4};
  return engine.make(block, tips);
}

double slid(const HoldEngine& engine, double angle, int settle, int ticks) {
  std::array<Vec3, 4> tips;
  const Holder holder = on_slope(engine, angle, tips);
  for (int i = 0; i < settle; ++i) holder.step(tips);
  const double from = holder.pose().position.x;
  for (int i = 0; i < ticks; ++i) holder.step(tips);
  return holder.pose().position.x - from;
}

SlopeFigures run_slope(const HoldEngine& engine) {
  SlopeFigures figures;
  figures.creep = 1000 * slid(engine, 0.3, 3000, 20000);
  double holds = 20, slips = 45;
  while (slips - holds > 0.05) {
    const double middle = 0.5 * (holds + slips);
    (slid(engine, middle * kPi / 180, 1500, 500) > 2e-3 ? slips : holds) = middle;
  }
  figures.slips_at = 0.5 * (holds + slips);
  const double angle = 40 * kPi / 180, expected = kGravity * (std::sin(angle) - kFriction * std::cos(angle));
  // x = a t^2 / 2: from the ways of three equal times after the start.
  const double first = slid(engine, angle, 100, 100), second = slid(engine, angle, 200, 100);
  figures.acceleration = (second - first) / 0.01 / expected;
  return figures;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) return bench::tell_usage("bench_holds    takes no words", argc, argv);
  std::vector<HoldEngine> engines = {our_holder()};
#ifdef LUMBRICAL_BULLET
  add_bullet_holders(engines);
#endif
#ifdef LUMBRICAL_MUJOCO
  add_mujoco_holders(engines);
#endif
  std::printf(
      "| engine | drift of the mug in 20 s [mm] | turn [degrees] | weight / mu N where it slips | "
      "largest force jump [N] | ticks per s |\n|---|---|---|---|---|---|\n");
  for (const HoldEngine& engine : engines) {
    const GraspFigures g = run_grasp(engine);
    if (way(g.drift) == "lost")
      std::printf("| %s | lost | | | | %.0f |\n", engine.name.c_str(), g.rate);
    else
      std::printf("| %s | %s | %.4f | %.3f | %.4f | %.0f |\n", engine.name.c_str(), way(g.drift).c_str(),
                  g.turn, g.slips_at, g.jump, g.rate);
    std::fflush(stdout);
  }
  std::printf(
      "\n| engine | creep on 17.2 degrees in 20 s [mm] | slips at [degrees] (%.2f) | acceleration at 40 "
      "degrees / Coulomb's |\n|---|---|---|---|\n",
      180 / kPi * std::atan(kFriction));
  for (const HoldEngine& engine : engines) {
    const SlopeFigures s = run_slope(engine);
    std::printf("| %s | %s | %.2f | %.3f |\n", engine.name.c_str(), way(s.creep).c_str(), s.slips_at,
                s.acceleration);
    std::fflush(stdout);
  }
  return 0;
}
