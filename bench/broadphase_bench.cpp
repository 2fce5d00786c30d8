// The broadphase under a pressed hand: scene A (300 mm wide, ever finer), scene B (5 mm triangles, ever
// wider) and two objects of scene A ever farther apart, by sphere tree, grid, voxel index and brute force.
// Microseconds per query of the whole hand; beside them candidates, contacts, bytes per triangle of the
// search structure and the time it takes to build.
#include "stages/broadphase.h"

#include <benchmark/benchmark.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "index/sphere_grid.h"
#include "index/sphere_tree.h"
#include "index/voxel_index.h"
#include "kept.h"
#include "pose_hand.h"
#include "pressed_hand.h"

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

struct Session {
  Model model;
  std::vector<Primitives> hands;
  Scratch scratch;
  std::size_t bytes = 0;  // of the search structure
  double build_ms = 0, candidates = 0, contacts = 0;
};

using Make = std::function<Scene()>;

void build_structure(Broadphase broadphase, Session& session) {
  const Model& model = session.model;
  const auto start = Clock::now();
  if (broadphase == Broadphase::tree)
    session.bytes = byte_count(build_tree(model.triangles, model.execution));
  if (broadphase == Broadphase::grid)
    session.bytes = byte_count(build_grid(model.triangles, model.execution));
  std::shared_ptr<const VoxelIndex> voxels;
  if (broadphase == Broadphase::voxel && build_voxels(model.triangles, model.execution, voxels).ok())
    session.bytes = voxels->report.bytes;
  session.build_ms = milliseconds_since(start);
}

void make_session(const Scene& scene, Broadphase broadphase, Session& session) {
  Execution execution;
  execution.broadphase = broadphase;
  if (!build_model(scene, execution, session.model).ok()) std::abort();
  build_structure(broadphase, session);
  State state;
  session.scratch = make_scratch(session.model);
  session.hands.resize(kPoses);
  for (int i = 0; i < kPoses; ++i) {
    const DeviceFrame frame = frame_at(scene.hand, i);
    test::pose_hand(session.model.hand, session.model.settings, frame,
                    session.hands[static_cast<std::size_t>(i)]);
    session.contacts += tick(session.model, state, session.scratch, frame).contact_count / double{kPoses};
    session.candidates += session.scratch.candidate_count / double{kPoses};
  }
}

Session& session_of(const std::string& name, const Make& make, Broadphase broadphase) {
  return bench::kept<Session>(
      name, [&make, broadphase](Session& session) { make_session(make(), broadphase, session); });
}

void add(const std::string& name, const Make& make, Broadphase broadphase, double metres = 0) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    Session& session = session_of(name, make, broadphase);
    std::size_t next = 0;
    for (auto _ : state) {
      benchmark::DoNotOptimize(
          find_candidates(session.model, session.hands[next++ % kPoses], session.scratch));
    }
    const double triangles = static_cast<double>(session.model.triangles.size());
    state.counters["triangles"] = triangles;
    state.counters["candidates"] = session.candidates;
    state.counters["contacts"] = session.contacts;
    state.counters["build_ms"] = session.build_ms;
    state.counters["bytes_per_triangle"] = static_cast<double>(session.bytes) / triangles;
    if (metres > 0) state.counters["metres"] = metres;
  })->Unit(benchmark::kMicrosecond);
}

void add_all() {
  for (const std::uint32_t cells : {9u, 29u, 49u, 69u, 224u, 708u}) {
    for (const Broadphase broadphase :
         {Broadphase::tree, Broadphase::grid, Broadphase::voxel, Broadphase::brute}) {
      if (!available(broadphase) || (broadphase == Broadphase::brute && cells > 100)) continue;
      const std::string how =
          std::string(broadphase_name(broadphase)) + "/" + std::to_string(2 * cells * cells);
      add(
          "A/" + how, [=] { return test::pressed_scene(test::kWidthA, cells); }, broadphase);
      add(
          "B/" + how, [=] { return test::pressed_scene(test::kCellB * cells, cells); }, broadphase);
    }
  }
  for (const int metres : {1, 10, 30, 100, 300, 1000, 10000, 100000}) {
    for (const Broadphase broadphase : {Broadphase::tree, Broadphase::grid}) {
      const std::string name =
          "apart/" + std::string(broadphase_name(broadphase)) + "/" + std::to_string(metres) + "_m";
      add(
          name, [=] { return spread_scene(metres); }, broadphase, metres);
    }
  }
}

const bool added = (add_all(), true);

}  // namespace
