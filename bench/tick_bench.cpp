// The whole tick on the demo's grasp and on a flat hand pressed into a plane: every law, microseconds per
// tick with percentiles. Beside each time stand the contacts it was spent on.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "lumbrical/motion.h"
#include "lumbrical/shapes.h"
#include "lumbrical/tick.h"
#include "pressed_hand.h"

namespace {

using namespace lumbrical;

struct Session {
  Model model;
  std::vector<DeviceFrame> frames;
};

// The grasp round a mug of `segments`, sampled where the hand touches it.
Session grasp_session(Law law, std::uint32_t segments, const Execution& execution) {
  Session session;
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.settings.law.fill(law);
  MugShape mug;
  mug.segments = segments;
  scene.objects.push_back({"mug", make_mug(mug)});
  if (!build_model(scene, execution, session.model).ok()) return session;
  const Motion motion = make_grasp(scene.hand, mug.radius, mug.height, 10);
  for (double time = 3; time < 7; time += 0.01) session.frames.push_back(resample(motion, time));
  return session;
}

void run(benchmark::State& state, const Session& session) {
  using Clock = std::chrono::steady_clock;
  State engine_state;
  Scratch scratch = make_scratch(session.model);
  std::vector<double> times;
  double contacts = 0;
  std::size_t next = 0;
  for (auto _ : state) {
    const DeviceFrame& frame = session.frames[next++ % session.frames.size()];
    const auto start = Clock::now();
    benchmark::DoNotOptimize(tick(session.model, engine_state, scratch, frame));
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
    contacts += scratch.contact_count;
  }
  std::sort(times.begin(), times.end());
  const auto percentile = [&](double share) {
    return times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
  };
  state.counters["p50_us"] = percentile(0.5);
  state.counters["p99_us"] = percentile(0.99);
  state.counters["max_us"] = times.back();
  state.counters["contacts"] = contacts / static_cast<double>(times.size());
  state.counters["triangles"] = static_cast<double>(session.model.triangles.size());
}

// Clusters: the hand pressed into scene A, ever finer, at several tolerances; beside the times stands how far
// the worst segment's force is from the exact one, as a share of the largest force of a segment.
Session pressed_session(std::uint32_t cells, double tolerance) {
  Session session;
  Scene scene = test::pressed_scene(test::kWidthA, cells);
  scene.settings.tolerance = tolerance;
  scene.settings.max_candidates = 1u << 21;
  scene.settings.max_force = 1e6;
  scene.settings.fade_time = 0;
  if (!build_model(scene, {}, session.model).ok()) return session;
  for (int i = 0; i < 16; ++i)
    session.frames.push_back(test::pressed_frame(scene.hand, 0.001 + 0.002 * i / 16, i / 16.0));
  return session;
}

std::vector<ActuatorFrame> outputs_of(const Session& session) {
  std::vector<ActuatorFrame> outputs;
  State state;
  Scratch scratch = make_scratch(session.model);
  for (const DeviceFrame& frame : session.frames)
    outputs.push_back(tick(session.model, state, scratch, frame));
  return outputs;
}

double worst_force_error(const std::vector<ActuatorFrame>& got, const std::vector<ActuatorFrame>& wanted) {
  double worst = 0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    double largest = 0, off = 0;
    for (std::size_t s = 0; s < kSegmentCount; ++s) {
      largest = std::max(largest, norm(wanted[i].segment[s].force));
      off = std::max(off, norm(got[i].segment[s].force - wanted[i].segment[s].force));
    }
    worst = std::max(worst, off / largest);
  }
  return worst;
}

void run_clusters(benchmark::State& state, std::uint32_t cells, double tolerance) {
  static std::map<std::uint32_t, std::vector<ActuatorFrame>> exact;
  if (exact[cells].empty()) exact[cells] = outputs_of(pressed_session(cells, 0));
  const Session session = pressed_session(cells, tolerance);
  run(state, session);
  state.counters["force_error"] = worst_force_error(outputs_of(session), exact[cells]);
}

void add_clusters() {
  for (const std::uint32_t cells : {224u, 708u, 2236u}) {
    for (const char* const tolerance : {"0", "0.001", "0.01", "0.03", "0.1"}) {
      const std::string name = "clusters/A_" + std::to_string(2 * cells * cells) + "/tolerance_" + tolerance;
      benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
        run_clusters(state, cells, std::stod(tolerance));
      })->Unit(benchmark::kMicrosecond);
    }
  }
}

void add_all() {
  add_clusters();
  for (const std::uint32_t segments : {16u, 32u, 64u}) {
    for (const Law law : {Law::field, Law::column, Law::max_depth, Law::centroid, Law::point}) {
      const std::string name = "grasp/" + std::string(law_name(law)) + "/mug_" + std::to_string(segments);
      benchmark::RegisterBenchmark(name.c_str(), [law, segments](benchmark::State& state) {
        run(state, grasp_session(law, segments, {}));
      });
    }
  }
  for (const std::uint32_t threads : {1u, 2u}) {
    const std::string name = "grasp/field/mug_64/threads_" + std::to_string(threads);
    benchmark::RegisterBenchmark(name.c_str(), [threads](benchmark::State& state) {
      Execution execution;
      execution.threads = threads;
      run(state, grasp_session(Law::field, 64, execution));
    })->UseRealTime();
  }
}

const bool added = (add_all(), true);

}  // namespace
