// The search for candidates of a hand that slides over scene A or B: afresh in every tick, and with the lists
// that outlive a tick, at speeds from rest to a millimetre a tick. Microseconds per tick, mean and
// percentiles of the thread's own time; beside them searches and unclear pairs per tick.
//
//   near_pairs_bench [--benchmark_filter=A/9522]
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>
#include <vector>

#include "pose_hand.h"
#include "pressed_hand.h"
#include "search/near_pairs.h"
#include "stages/broadphase.h"
#include "timing.h"

namespace {

using namespace lumbrical;
using bench::percentile, bench::thread_microseconds;

constexpr double kCircle = 0.0628;  // [m] round which pressed_frame goes in a time of 1
constexpr int kTicks = 1000;

std::vector<Primitives> poses(const Model& model, double step) {
  std::vector<Primitives> hands(kTicks);
  for (int i = 0; i < kTicks; ++i) {
    const double time = i * step / kCircle, depth = 0.002 + 0.001 * std::sin(6.28 * time);
    test::pose_hand(model.hand, model.settings, test::pressed_frame(model.hand, depth, time),
                    hands[static_cast<std::size_t>(i)]);
  }
  return hands;
}

void run(benchmark::State& state, double extent, std::uint32_t cells, double step, bool keep) {
  Model model;
  if (!build_model(test::pressed_scene(extent, cells), {}, model).ok())
    return state.SkipWithError("the scene can't be built");
  const std::vector<Primitives> hands = poses(model, step);
  Scratch scratch = make_scratch(model);
  scratch.keep_near = keep;
  std::vector<double> times;
  double searches = 0, asked = 0, sum = 0;
  std::size_t next = 0;
  for (auto _ : state) {
    const double start = thread_microseconds();
    benchmark::DoNotOptimize(find_candidates(model, hands[next++ % kTicks], scratch));
    times.push_back(thread_microseconds() - start);
    sum += times.back();
    searches += scratch.near->searches;
    asked += scratch.near->asked;
  }
  const auto count = static_cast<double>(times.size());
  state.counters["mean_us"] = sum / count;
  state.counters["p50_us"] = percentile(times, 0.5);
  state.counters["p99_us"] = percentile(times, 0.99);
  state.counters["searches"] = searches / count;
  state.counters["asked"] = asked / count;
  state.counters["candidates"] = scratch.candidate_count;
}

void add_all() {
  for (const std::uint32_t cells : {69u, 224u, 708u}) {
    for (const bool growing : {false, true}) {
      for (const double step : {0.0, 1e-5, 5e-5, 1e-4, 2e-4, 1e-3}) {
        for (const bool keep : {false, true}) {
          const std::string name = std::string(growing ? "B/" : "A/") + std::to_string(2 * cells * cells) +
                                   "/um_per_tick:" + std::to_string(std::lround(1e6 * step)) +
                                   (keep ? "/kept" : "/afresh");
          benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
            run(state, growing ? test::kCellB * cells : test::kWidthA, cells, step, keep);
          })->Iterations(kTicks);
        }
      }
    }
  }
}

const bool added = (add_all(), true);

}  // namespace
