// One pair of hand part and triangle: nanoseconds for area, centroid, volume, first moments and depth, by
// shape, triangle size, precision and instruction set. Beside each time stands its error against the exact
// rung, and the bound the engine states.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "borders/pair_contact.h"
#include "mesh_world.h"
#include "random.h"
#include "stages/narrowphase.h"

namespace {

using namespace lumbrical;

constexpr double kRadius = 0.008;
constexpr std::uint32_t kPairs = 4096;

enum class Kind { sphere, capsule, cone };
constexpr const char* kKindNames[] = {"sphere", "capsule", "cone"};

struct PairScene {
  Model model;
  Primitives hand;
  std::vector<std::uint64_t> candidates;
  std::vector<Contact> contacts;
};

// Triangles of about `size` that all touch one primitive, lying every way; `inside`: wholly within it.
PairScene make_pairs(Kind kind, double size, bool inside, Isa isa) {
  PairScene scene;
  test::Random random(3);
  Primitive& part = scene.hand.primitive[0];
  scene.hand.count = 1;
  part.law = Law::field;
  part.radius1 = kRadius;
  part.radius2 = kind == Kind::cone ? 0.9 * kRadius : kRadius;
  part.end2 = part.end1 = random.in_box(0.1);
  if (kind != Kind::sphere) part.end2 += 0.025 * random.direction();
  scene.model.execution.isa = isa;
  Mesh mesh;
  while (scene.candidates.size() < kPairs) {
    const Vec3 on_axis = part.end1 + random.between(0, 1) * (part.end2 - part.end1);
    const double reach = inside ? 0.7 : 1.0;
    const Vec3 at = on_axis + random.between(inside ? 0.2 : 0.4, reach) * kRadius * random.direction();
    const Vec3 corner[3] = {at + size * random.direction(), at + size * random.direction(),
                            at + size * random.direction()};
    Contact contact;
    if (!collide(part, {}, {corner[0], corner[1], corner[2]}, contact)) continue;
    const double area = 0.5 * norm(cross(corner[1] - corner[0], corner[2] - corner[0]));
    if (inside != (contact.area > 0.999999 * area)) continue;
    scene.candidates.push_back(mesh.triangles.size());
    add_triangle(corner[0], corner[1], corner[2], mesh);
  }
  scene.model.triangles = world_of(mesh);
  scene.contacts.resize(kPairs);
  return scene;
}

void time_pairs(benchmark::State& state, Kind kind, double size, bool inside, Isa isa) {
  PairScene scene = make_pairs(kind, size, inside, isa);
  for (auto _ : state) {
    benchmark::DoNotOptimize(collide_pairs(scene.model, scene.hand, scene.candidates, scene.contacts));
  }
  state.counters["ns_per_pair"] = benchmark::Counter(
      kPairs * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

struct SizeClass {
  const char* name;
  double size;
  bool inside;
};
constexpr SizeClass kSizes[] = {{"inside_0.01R", 0.01 * kRadius, true},
                                {"inside_0.03R", 0.03 * kRadius, true},
                                {"inside_0.1R", 0.1 * kRadius, true},
                                {"edge_0.1R", 0.1 * kRadius, false},
                                {"edge_1R", kRadius, false},
                                {"edge_10R", 10 * kRadius, false}};

void add_all() {
  for (const Kind kind : {Kind::sphere, Kind::capsule, Kind::cone}) {
    for (const SizeClass& shape : kSizes) {
      for (const Isa isa : {Isa::scalar, Isa::sse2, Isa::avx2, Isa::avx512, Isa::neon}) {
        if (!available(isa)) continue;
        const std::string name = std::string("pair/") + kKindNames[static_cast<int>(kind)] + "/" +
                                 shape.name + "/exact/" + std::string(isa_name(isa));
        benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
          time_pairs(state, kind, shape.size, shape.inside, isa);
        });
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  add_all();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
