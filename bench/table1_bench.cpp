// The paper's Table 1: microseconds for one pair of hand part and triangle, beside the paper's on a Pentium 4
// of 1.7 GHz. "test" asks whether they can touch at all; "contact" computes the whole contact: section, area,
// depth and force, by the paper's law and by the exact field law.
#include <benchmark/benchmark.h>

#include <string>

#include "borders/pair_contact.h"
#include "lumbrical/tick.h"
#include "mesh_world.h"
#include "random.h"
#include "stages/broadphase.h"
#include "stages/narrowphase.h"

namespace {

using namespace lumbrical;

constexpr double kRadius = 0.008, kLength = 0.025;  // [m]
constexpr std::uint32_t kPairs = 4096;

struct Pairs {
  Model model;
  Primitives hand;
  std::vector<std::uint64_t> candidates;
};

// Triangles with sides of about the part's radius, in any attitude, every one in contact with it.
Pairs make_pairs(bool is_sphere, Law law) {
  Pairs pairs;
  test::Random random(7);
  pairs.model.build = 1;  // put together here, by no build_model
  pairs.model.execution.broadphase = Broadphase::brute;
  pairs.model.execution.isa = widest_isa();
  pairs.model.settings.max_candidates = kPairs;
  Primitive& part = pairs.hand.primitive[0];
  pairs.hand.count = 1;
  part.shape = is_sphere ? Shape::round : Shape::flat;
  part.law = law;
  part.radius1 = part.radius2 = kRadius;
  if (!is_sphere) part.end2 = kLength * random.direction();
  Mesh mesh;
  while (pairs.candidates.size() < kPairs) {
    const Vec3 at = random.between(0, 1) * part.end2 + random.between(0, 1) * kRadius * random.direction();
    const Vec3 corner[3] = {at + kRadius * random.direction(), at + kRadius * random.direction(),
                            at + kRadius * random.direction()};
    Contact contact;
    if (!collide(part, {}, {corner[0], corner[1], corner[2]}, contact)) continue;
    pairs.candidates.push_back(mesh.triangles.size());
    add_triangle(corner[0], corner[1], corner[2], mesh);
  }
  pairs.model.triangles = world_of(mesh);
  return pairs;
}

void report(benchmark::State& state, double paper_us) {
  state.counters["ns_per_pair"] = benchmark::Counter(
      kPairs * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["paper_ns_per_pair"] = 1000 * paper_us;
}

void time_test(benchmark::State& state, bool is_sphere) {
  const Pairs pairs = make_pairs(is_sphere, Law::field);
  Scratch scratch = make_scratch(pairs.model);
  for (auto _ : state) benchmark::DoNotOptimize(find_candidates(pairs.model, pairs.hand, scratch));
  if (scratch.candidate_count != kPairs) state.SkipWithError("a pair in contact was taken for a miss");
  report(state, is_sphere ? 6.2 : 7.1);
}

void time_contact(benchmark::State& state, bool is_sphere, Law law) {
  const Pairs pairs = make_pairs(is_sphere, law);
  std::vector<Contact> contacts(kPairs);
  std::uint32_t count = 0;
  for (auto _ : state) count = collide_pairs(pairs.model, pairs.hand, pairs.candidates, contacts);
  if (count != kPairs) state.SkipWithError("a pair in contact was lost");
  report(state, is_sphere ? 9.7 : 16.3);
}

void add_all() {
  for (const bool is_sphere : {true, false}) {
    const std::string part = is_sphere ? "table1/sphere/" : "table1/cylinder/";
    benchmark::RegisterBenchmark((part + "test").c_str(), [=](benchmark::State& state) {
      time_test(state, is_sphere);
    })->Unit(benchmark::kMicrosecond);
    for (const Law law : {Law::max_depth, Law::field}) {
      benchmark::RegisterBenchmark((part + "contact_" + std::string(law_name(law))).c_str(),
                                   [=](benchmark::State& state) { time_contact(state, is_sphere, law); })
          ->Unit(benchmark::kMicrosecond);
    }
  }
}

const bool added = (add_all(), true);

}  // namespace
