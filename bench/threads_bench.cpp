// What threads bring: the stages of a tick and the whole of it, for a hand pressed into scene A, by number of
// triangles and threads; and up to ten thousand independent hands in one call. Microseconds of wall time:
// nothing else should run.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "lumbrical/batch.h"
#include "pose_hand.h"
#include "pressed_hand.h"
#include "session.h"
#include "stages/broadphase.h"
#include "stages/narrowphase.h"

namespace {

using namespace lumbrical;

struct Work {
  Model model;
  Scratch scratch;
  DeviceFrame frame;
  Primitives hand;
};

Work work_of(std::uint32_t cells, std::uint32_t threads) {
  Work work;
  const Scene scene = test::pressed_scene(test::kWidthA, cells);
  Execution execution;
  execution.threads = threads;
  work.model = test::model_of(scene, execution);
  work.scratch = make_scratch(work.model);
  work.scratch.keep_near = false;
  work.frame = test::pressed_frame(scene.hand, 0.002, 0.1);
  test::pose_hand(work.model.hand, work.model.settings, work.frame, work.hand);
  find_candidates(work.model, work.hand, work.scratch);
  return work;
}

void count_work(const Work& work, benchmark::State& state) {
  state.counters["candidates"] = work.scratch.candidate_count;
  state.counters["triangles"] = static_cast<double>(work.model.triangles.size());
}

void search(benchmark::State& state, std::uint32_t cells, std::uint32_t threads, bool keep) {
  Work work = work_of(cells, threads);
  work.scratch.keep_near = keep;
  for (int i = 0; i < 3; ++i) find_candidates(work.model, work.hand, work.scratch);
  for (auto _ : state) benchmark::DoNotOptimize(find_candidates(work.model, work.hand, work.scratch));
  count_work(work, state);
}

void contacts(benchmark::State& state, std::uint32_t cells, std::uint32_t threads) {
  Work work = work_of(cells, threads);
  const std::span<const std::uint64_t> candidates(work.scratch.candidates.data(),
                                                  work.scratch.candidate_count);
  std::vector<Contact> found(candidates.size());
  for (auto _ : state) benchmark::DoNotOptimize(collide_pairs(work.model, work.hand, candidates, found));
  count_work(work, state);
}

void whole_tick(benchmark::State& state, std::uint32_t cells, std::uint32_t threads) {
  Work work = work_of(cells, threads);
  State engine_state;
  for (auto _ : state) benchmark::DoNotOptimize(tick(work.model, engine_state, work.scratch, work.frame));
  count_work(work, state);
}

// Hands that close round a mug, each at another moment of its grasp.
void hands(benchmark::State& state, std::size_t count, std::uint32_t threads) {
  constexpr std::size_t kFrames = 400, kHolding = 200, kStep = 7;
  const Scene scene = test::mug_scene(Law::field);
  const Model model = test::model_of(scene);
  const std::vector<DeviceFrame> grasp = test::grasp_frames(scene.hand, kFrames);
  std::vector<DeviceFrame> frames;
  for (std::size_t i = 0; i < count; ++i) frames.push_back(grasp[(kHolding + kStep * i) % kFrames]);
  std::vector<ActuatorFrame> output(count);
  std::vector<State> states(count);
  std::vector<Scratch> scratch;
  for (auto _ : state) tick_each(model, frames, states, output, threads, scratch);
  state.counters["hands"] = static_cast<double>(count);
}

void add_all() {
  for (const std::uint32_t threads : {1u, 2u, 4u}) {
    const auto add = [&](const std::string& name, std::size_t size, auto function) {
      const std::string full = name + "/threads:" + std::to_string(threads) + "/" + std::to_string(size);
      benchmark::RegisterBenchmark(full.c_str(), function)->Unit(benchmark::kMicrosecond)->UseRealTime();
    };
    for (const std::uint32_t cells : {9u, 20u, 29u, 40u, 69u, 140u, 224u, 708u}) {
      const std::size_t size = 2 * cells * cells;
      add("search", size, [=](benchmark::State& state) { search(state, cells, threads, false); });
      add("lists", size, [=](benchmark::State& state) { search(state, cells, threads, true); });
      add("contacts", size, [=](benchmark::State& state) { contacts(state, cells, threads); });
      add("tick", size, [=](benchmark::State& state) { whole_tick(state, cells, threads); });
    }
    for (const std::size_t count : {1u, 10u, 100u, 1000u, 10000u})
      add("hands", count, [=](benchmark::State& state) { hands(state, count, threads); });
  }
}

const bool added = (add_all(), true);

}  // namespace
