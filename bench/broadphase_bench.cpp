// The broadphase under a pressed hand: scene A (300 mm wide, ever finer), scene B (5 mm triangles, ever
// wider) and two objects of scene A ever farther apart, by sphere tree, grid, voxel index and brute force.
// Microseconds per query of the whole hand; beside them candidates, contacts, bytes per triangle of the
// search structure and the time it takes to build.
#include "stages/broadphase.h"

#include <benchmark/benchmark.h>

#include <chrono>
#include <string>
#include <vector>

#include "../tests/pressed_hand.h"
#include "index/sphere_grid.h"
#include "index/sphere_tree.h"
#include "index/voxel_index.h"
#include "stages/hand_pose.h"

namespace {

using namespace lumbrical;
using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

constexpr int kPoses = 16;

// The hand at a depth of 1 to 3 mm.
DeviceFrame frame_at(const Hand& hand, int pose) {
  const double time = pose / double{kPoses};
  return test::pressed_frame(hand, 0.001 + 0.002 * time, time);
}

// Scene A with 9,522 triangles, under the hand, and once more `apart` [m] away along x and y.
Scene spread_scene(double apart) {
  Scene scene = test::pressed_scene(test::kWidthA, 69);
  scene.objects.push_back(scene.objects[0]);
  for (Vec3& p : scene.objects[1].mesh.vertices) p += {apart, apart, 0};
  return scene;
}

void run(benchmark::State& state, const Scene& scene, Broadphase broadphase) {
  Execution execution;
  execution.broadphase = broadphase;
  Model model;
  if (!build_model(scene, execution, model).ok()) return state.SkipWithError("the scene can't be built");
  const double triangles = static_cast<double>(model.triangles.size());
  std::size_t bytes = 0;
  const auto start = Clock::now();
  if (broadphase == Broadphase::tree) bytes = byte_count(build_tree(model.triangles, execution));
  if (broadphase == Broadphase::grid) bytes = byte_count(build_grid(model.triangles, execution));
  std::shared_ptr<const VoxelIndex> voxels;
  if (broadphase == Broadphase::voxel && build_voxels(model.triangles, execution, voxels).ok())
    bytes = voxels->report.bytes;
  state.counters["build_ms"] = milliseconds_since(start);

  State engine_state;
  Scratch scratch = make_scratch(model);
  std::vector<Primitives> hands(kPoses);
  double candidates = 0, contacts = 0;
  for (int i = 0; i < kPoses; ++i) {
    const DeviceFrame frame = frame_at(scene.hand, i);
    pose_hand(model.hand, model.settings, frame, hands[static_cast<std::size_t>(i)]);
    contacts += tick(model, engine_state, scratch, frame).contact_count / double{kPoses};
    candidates += scratch.candidate_count / double{kPoses};
  }
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(find_candidates(model, hands[next++ % kPoses], scratch));
  }
  state.counters["triangles"] = triangles;
  state.counters["candidates"] = candidates;
  state.counters["contacts"] = contacts;
  state.counters["bytes_per_triangle"] = static_cast<double>(bytes) / triangles;
}

void add_all() {
  for (const std::uint32_t cells : {9u, 29u, 49u, 69u, 224u, 708u}) {
    for (const Broadphase broadphase :
         {Broadphase::tree, Broadphase::grid, Broadphase::voxel, Broadphase::brute}) {
      if (!available(broadphase) || (broadphase == Broadphase::brute && cells > 100)) continue;
      const std::string how =
          std::string(broadphase_name(broadphase)) + "/" + std::to_string(2 * cells * cells);
      benchmark::RegisterBenchmark(("A/" + how).c_str(), [=](benchmark::State& state) {
        run(state, test::pressed_scene(test::kWidthA, cells), broadphase);
      })->Unit(benchmark::kMicrosecond);
      benchmark::RegisterBenchmark(("B/" + how).c_str(), [=](benchmark::State& state) {
        run(state, test::pressed_scene(test::kCellB * cells, cells), broadphase);
      })->Unit(benchmark::kMicrosecond);
    }
  }
  for (const int metres : {1, 10, 30, 100, 300, 1000, 10000, 100000}) {
    for (const Broadphase broadphase : {Broadphase::tree, Broadphase::grid}) {
      const std::string name =
          "apart/" + std::string(broadphase_name(broadphase)) + "/" + std::to_string(metres) + "_m";
      benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
        run(state, spread_scene(metres), broadphase);
        state.counters["metres"] = metres;
      })->Unit(benchmark::kMicrosecond);
    }
  }
}

const bool added = (add_all(), true);

}  // namespace
