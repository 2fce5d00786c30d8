// Building a model: seconds for scenes A (300 mm wide, ever finer) and B (5 mm triangles, ever wider), by
// tree and grid for the exact rung, and for samples; on one thread and two; beside them bytes per triangle,
// all that stays in memory included.
#include <benchmark/benchmark.h>

#include <string>

#include "index/patches.h"
#include "index/sphere_grid.h"
#include "index/sphere_tree.h"
#include "pressed_hand.h"

namespace {

using namespace lumbrical;

std::size_t byte_count(const Patches& patches) {
  return byte_count(patches.tree) + patches.block.size() * sizeof(PatchBlock) +
         patches.shape.size() * sizeof(PatchShape) + patches.samples.size() * sizeof(BlockSamples) +
         byte_count(patches.large_tree) + patches.large.size() * sizeof(std::uint32_t);
}

double bytes_of(const Model& model) {
  const Triangles& world = model.triangles;
  return static_cast<double>(world.x.size() * 3 * sizeof(double) + world.size() * 3 * sizeof(std::uint32_t) +
                             byte_count(model.tree) + byte_count(model.grid) +
                             (model.patches ? byte_count(*model.patches) : 0));
}

// Scenes take longer to make than models: the last one is kept.
Scene& scene_of_cells(bool fine, std::uint32_t cells) {
  static Scene scene;
  static std::string made;
  const std::string wanted = std::to_string(fine) + "/" + std::to_string(cells);
  if (made != wanted) scene = test::pressed_scene(fine ? test::kWidthA : test::kCellB * cells, cells);
  made = wanted;
  return scene;
}

/// A way to build.
struct Way {
  const char* name;
  Broadphase broadphase;
  double precision;
};
constexpr Way kWays[] = {
    {"tree", Broadphase::tree, 0}, {"grid", Broadphase::grid, 0}, {"tree_1e-4", Broadphase::tree, 1e-4}};

void run(benchmark::State& state, bool fine, std::uint32_t cells, const Way& way, std::uint32_t threads) {
  Scene& scene = scene_of_cells(fine, cells);
  scene.settings.precision.fill(way.precision);
  Execution execution;
  execution.broadphase = way.broadphase;
  execution.threads = threads;
  double bytes = 0;
  for (auto _ : state) {
    Model model;
    if (!build_model(scene, execution, model).ok()) return state.SkipWithError("the scene can't be built");
    state.PauseTiming();
    bytes = bytes_of(model);
    model = {};
    state.ResumeTiming();
  }
  const double triangles = 2.0 * cells * cells;
  state.counters["triangles"] = triangles;
  state.counters["bytes_per_triangle"] = bytes / triangles;
}

void add_all() {
  for (const std::uint32_t cells : {69u, 224u, 708u, 2236u}) {
    for (const bool fine : {true, false}) {
      for (const Way& way : kWays) {
        for (const std::uint32_t threads : {1u, 2u}) {
          const std::string name = std::string("build_") + (fine ? "A/" : "B/") + way.name + "/" +
                                   std::to_string(2 * cells * cells) + "/threads_" + std::to_string(threads);
          benchmark::RegisterBenchmark(
              name.c_str(), [=](benchmark::State& state) { run(state, fine, cells, way, threads); })
              ->UseRealTime()
              ->Unit(benchmark::kMillisecond);
        }
      }
    }
  }
}

const bool added = (add_all(), true);

}  // namespace
