// The whole tick: every law, precision, search and instruction set beside its force error; growing numbers of
// triangles and of contacts; the paper's Table 2; the demo's grasp. Microseconds with percentiles.
//
// Names are FIGURE/HOW/SIZE/WAY. The force error is that of the hand's force in the worst of 16 poses (of
// four where there are 10 million triangles), relative to the exact field law's in the same pose; law point
// has no area, so its force is first scaled by the constant that fits best.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../tools/lumbrical/compare_precision.h"
#include "hand_scenes.h"
#include "kept.h"
#include "lumbrical/motion.h"
#include "timing.h"

namespace {

using namespace lumbrical;
using namespace lumbrical::bench;

constexpr int kPoses = 16;

struct Session {
  Model model;
  std::vector<DeviceFrame> frames;
  bool has_error = true;
  double force_error = 0;
  double contacts = 0;  // triangles and hand parts that touch, by the exact rung: mean over the poses
  double paper_hz = 0;  // the paper's haptic rate, where this is a row of its tables
};

using Make = std::function<void(Session&)>;

// ---- Force error ----

struct Answers {
  std::vector<Vec3> forces;
  double contacts = 0;  // mean; samples list none
};

// A session of its own for each pose: forces alone, whatever came before.
Answers answers_of(const Model& model, const std::vector<DeviceFrame>& frames) {
  Scratch scratch = make_scratch(model);
  scratch.hash_stages = false;
  Answers answers;
  const std::size_t count = model.triangles.size() > 2'000'000 ? 4 : kPoses;  // there, a tick takes a second
  for (std::size_t i = 0; i < count; ++i) {
    State state;
    const std::size_t pose = i * frames.size() / count;
    const ActuatorFrame output = tick(model, state, scratch, frames[pose]);
    Vec3& sum = answers.forces.emplace_back();
    for (const Wrench& wrench : output.segment) sum += wrench.force;
    answers.contacts += scratch.contact_count / static_cast<double>(count);
  }
  return answers;
}

Answers exact_answers_of(const Model& model, const std::vector<DeviceFrame>& frames) {
  Model without_samples = model;
  without_samples.settings.law.fill(Law::field);
  if (model.patches && model.settings.felt_once == FeltOnce::by_samples)
    without_samples.settings.felt_once = FeltOnce::always;
  without_samples.patches = nullptr;
  return answers_of(without_samples, frames);
}

double force_error_of(const std::vector<Vec3>& forces, const std::vector<Vec3>& exact, bool is_scaled) {
  double product = 0, square = 0, worst = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    product += dot(forces[i], exact[i]);
    square += dot(forces[i], forces[i]);
  }
  const double scale = is_scaled && square > 0 ? product / square : 1;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    // Of a pose that hardly touches a share says little.
    const double force = std::max(norm(exact[i]), tool::kLeastForce);
    worst = std::max(worst, norm(scale * forces[i] - exact[i]) / force);
  }
  return worst;
}

// ---- Measurement ----

Session& session_of(const std::string& name, const Make& make) {
  return kept<Session>(name, [&make](Session& session) {
    make(session);
    const Answers exact = exact_answers_of(session.model, session.frames);
    session.contacts = exact.contacts;
    if (session.has_error)
      session.force_error = force_error_of(answers_of(session.model, session.frames).forces, exact.forces,
                                           session.model.settings.law[0] == Law::point);
  });
}

void run(benchmark::State& state, const Session& session) {
  using Clock = std::chrono::steady_clock;
  State engine_state;
  Scratch scratch = make_scratch(session.model);
  scratch.hash_stages = false;  // as in a run that records nothing
  std::vector<double> times, processor_times;
  std::size_t next = 0;
  for (auto _ : state) {
    const DeviceFrame& frame = session.frames[next++ % session.frames.size()];
    const double processor_start = thread_microseconds();
    const auto start = Clock::now();
    const ActuatorFrame output = tick(session.model, engine_state, scratch, frame);
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
    processor_times.push_back(thread_microseconds() - processor_start);
    if ((output.flags & kCandidateOverflow) != 0)
      return state.SkipWithError("more candidates than there is room for");
  }
  state.counters["p50_us"] = percentile(times, 0.5);
  state.counters["p99_us"] = percentile(times, 0.99);
  state.counters["p999_us"] = percentile(times, 0.999);
  state.counters["max_us"] = percentile(times, 1);
  if (session.model.execution.threads == 1) {
    state.counters["processor_p50_us"] = percentile(processor_times, 0.5);
    state.counters["processor_p99_us"] = percentile(processor_times, 0.99);
  }
  state.counters["ticks"] = static_cast<double>(times.size());
  state.counters["contacts"] = session.contacts;
  state.counters["triangles"] = static_cast<double>(session.model.triangles.size());
  if (session.has_error) state.counters["force_error"] = session.force_error;
  if (session.paper_hz <= 0) return;
  state.counters["hz"] = 1e6 / percentile(times, 0.5);
  state.counters["paper_hz"] = session.paper_hz;
}

benchmark::internal::Benchmark* add(const std::string& name, const Make& make) {
  return benchmark::RegisterBenchmark(name.c_str(),
                                      [=](benchmark::State& state) { run(state, session_of(name, make)); })
      ->UseRealTime();
}

// ---- Scenes ----

struct Field {
  bool fine = true;
  std::uint32_t cells = 69;
  Touch touch = Touch::drape;
  double precision = 0;
  Law law = Law::field;
  double wanted = 0;  // triangles to touch; 0: 1 to 3 mm deep whatever that touches
  bool has_palm = true;
  Execution execution{};
};

void make_field(const Field& field, Session& session) {
  Scene scene =
      field_scene(field.has_palm ? default_hand(Side::right) : plain_hand(), field.fine, field.cells);
  scene.settings.precision.fill(field.precision);
  scene.settings.law.fill(field.law);
  const double extent = field.fine ? test::kWidthA : test::kCellB * field.cells;
  if (!build_model(scene, field.execution, session.model).ok()) std::abort();
  const int count = field.touch == Touch::jump ? 4096 : kPoses;
  const double depth =
      field.wanted > 0 ? depth_touching(session.model, field.touch, extent, count, field.wanted) : 0.001;
  session.frames = touching_frames(scene.hand, field.touch, extent, count, depth);
}

void add_field(const std::string& name, const Field& field) {
  add(name, [field](Session& session) { make_field(field, session); });
}

std::string triangles_of(std::uint32_t cells) { return std::to_string(2 * cells * cells); }

const char* precision_name(double precision) {
  return precision == 0 ? "exact" : precision < 5e-5 ? "1e-5" : precision < 5e-4 ? "1e-4" : "1e-3";
}

constexpr double kPrecisions[] = {0, 1e-5, 1e-4, 1e-3};

// ---- Time against force error ----

// Every way to search and every instruction set, one at a time.
std::vector<std::pair<std::string, Execution>> all_ways() {
  std::vector<std::pair<std::string, Execution>> ways;
  for (const Broadphase broadphase :
       {Broadphase::tree, Broadphase::grid, Broadphase::voxel, Broadphase::brute}) {
    for (const Isa isa : {Isa::scalar, Isa::sse2, Isa::avx2, Isa::avx512, Isa::neon}) {
      if (!available(broadphase) || !available(isa)) continue;
      if (broadphase != Broadphase::tree && isa != widest_isa()) continue;
      Execution execution;
      execution.broadphase = broadphase;
      execution.isa = isa;
      ways.emplace_back(std::string(broadphase_name(broadphase)) + "_" + std::string(isa_name(isa)),
                        execution);
    }
  }
  return ways;
}

void add_errors() {
  for (const Touch touch : {Touch::drape, Touch::tips}) {
    const std::string scene = touch == Touch::drape ? "error_A_drape_9522" : "error_A_tips_9522";
    for (const auto& [way, execution] : all_ways()) {
      for (const double precision : kPrecisions) {
        Field field{.touch = touch, .precision = precision, .execution = execution};
        add_field(scene + "/field/" + precision_name(precision) + "/" + way, field);
      }
      for (const Law law : {Law::column, Law::max_depth, Law::centroid, Law::point}) {
        Field field{.touch = touch, .law = law, .execution = execution};
        add_field(scene + "/" + std::string(law_name(law)) + "/exact/" + way, field);
      }
    }
  }
}

// ---- Time against triangles and contacts ----

void add_sizes() {
  for (const double precision : kPrecisions) {  // a table of two triangles
    const std::string rung = std::string("/") + precision_name(precision) + "/2";
    add_field("A_drape" + rung, {.cells = 1, .precision = precision});
    add_field("A_tips" + rung, {.cells = 1, .touch = Touch::tips, .precision = precision});
  }
  for (const std::uint32_t cells : {9u, 29u, 49u, 69u, 224u, 708u, 2236u}) {
    const std::string size = triangles_of(cells);
    for (const double precision : kPrecisions) {
      const std::string how = std::string("/") + precision_name(precision) + "/";
      add_field("A_drape" + how + size, {.cells = cells, .precision = precision});
      add_field("B_drape" + how + size, {.fine = false, .cells = cells, .precision = precision});
    }
    for (const double precision : {0.0, 1e-4}) {
      const std::string rung = std::string("/") + precision_name(precision) + "/" + size;
      add_field("A_drape_fingers" + rung, {.cells = cells, .precision = precision, .has_palm = false});
      add_field("A_tips" + rung, {.cells = cells, .touch = Touch::tips, .precision = precision});
      add_field("A_one_finger" + rung, {.cells = cells, .touch = Touch::finger, .precision = precision});
      add_field("B_empty_space" + rung,
                {.fine = false, .cells = cells, .touch = Touch::none, .precision = precision});
      add_field("B_jumping" + rung,
                {.fine = false, .cells = cells, .touch = Touch::jump, .precision = precision});
    }
    for (const double precision : {1e-3, 1e-5})
      add_field(std::string("A_tips/") + precision_name(precision) + "/" + size,
                {.cells = cells, .touch = Touch::tips, .precision = precision});
    if (cells < 69) continue;
    for (const double precision : {0.0, 1e-4})
      add_field(std::string("A_drape/") + precision_name(precision) + "/" + size + "/2_threads",
                {.cells = cells, .precision = precision, .execution = {.threads = 2}});
  }
}

// A floor of two triangles, a hundred metres wide: samples cut it where it is touched. Jumping, a hand comes
// to another place every time.
void make_floor(Touch touch, double precision, Session& session) {
  constexpr double kFloor = 100;  // [m]
  Scene scene = field_scene(default_hand(Side::right), true, 1);
  scene.settings.precision.fill(precision);
  scene.objects = {{"floor", make_plane(kFloor, 1)}};
  if (!build_model(scene, {}, session.model).ok()) std::abort();
  const bool jumps = touch == Touch::jump;
  session.frames = touching_frames(scene.hand, touch, jumps ? kFloor : test::kWidthA, jumps ? 1024 : kPoses);
}

void add_floors() {
  for (const double precision : {0.0, 1e-4}) {
    const std::string rung = std::string("/") + precision_name(precision) + "/2";
    const auto add_floor = [&](const std::string& name, Touch touch) {
      add(name + rung, [=](Session& session) { make_floor(touch, precision, session); });
    };
    add_floor("floor_drape", Touch::drape);
    add_floor("floor_tips", Touch::tips);
    add_floor("floor_jumping", Touch::jump);
  }
}

void add_contacts() {
  struct Count {
    Touch touch;
    std::uint32_t cells;
    double wanted;
  };
  for (const Count& count : {Count{Touch::finger, 69, 1},
                             {Touch::finger, 69, 3},
                             {Touch::finger, 69, 10},
                             {Touch::tips, 69, 30},
                             {Touch::tips, 69, 100},
                             {Touch::drape, 69, 300},
                             {Touch::drape, 69, 1000},
                             {Touch::drape, 141, 3000},
                             {Touch::drape, 224, 10000}}) {
    for (const double precision : {0.0, 1e-4})
      add_field(std::string("contacts/") + precision_name(precision) + "/" +
                    std::to_string(static_cast<int>(count.wanted)),
                {.cells = count.cells, .touch = count.touch, .precision = precision, .wanted = count.wanted});
  }
}

// ---- The paper's Table 2, row by row ----

// Level 0 is no tree at all. Ours have sixteen branches, so all the levels that there are with these sizes
// are three; 5 and 6 change nothing.
void add_table2() {
  struct Row {
    std::uint32_t cells, levels;
    double touched, hz;
  };
  int number = 0;
  for (const Row& row : {Row{9, 0, 2, 650},
                         {9, 6, 2, 3554},
                         {29, 0, 9, 66},
                         {29, 3, 9, 1263},
                         {29, 5, 11, 2034},
                         {49, 5, 24, 893},
                         {49, 6, 23, 2512},
                         {49, 6, 48, 909},
                         {69, 6, 15, 2086},
                         {69, 6, 52, 714}}) {
    ++number;
    for (const Law law : {Law::field, Law::max_depth}) {
      Field field{.cells = row.cells,
                  .touch = Touch::tips,
                  .precision = law == Law::field ? 1e-4 : 0,
                  .law = law,
                  .wanted = row.touched};
      field.execution.tree_levels = row.levels;
      field.execution.broadphase = row.levels == 0 ? Broadphase::brute : Broadphase::tree;
      const std::string name = "table2_row_" + std::to_string(number) + "/" + std::string(law_name(law)) +
                               "/" + triangles_of(row.cells) + "/levels_" + std::to_string(row.levels);
      add(name, [field, hz = row.hz](Session& session) {
        make_field(field, session);
        session.paper_hz = hz;
      });
    }
  }
}

// ---- The demo's grasp ----

// The ticks between two times [s], `step` apart, of the ten seconds.
void make_grasp_session(Law law, std::uint32_t segments, double from, double to, double step,
                        Session& session) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.settings.law.fill(law);
  MugShape mug;
  mug.segments = segments;
  scene.objects.push_back({"mug", make_mug(mug)});
  if (!build_model(scene, {}, session.model).ok()) std::abort();
  const Motion motion = make_grasp(scene.hand, mug.radius, mug.height, 10);
  for (double time = from; time < to; time += step) session.frames.push_back(resample(motion, time));
  session.has_error = false;
}

void add_grasps() {
  for (const std::uint32_t segments : {16u, 32u, 64u}) {
    for (const Law law : {Law::field, Law::column, Law::max_depth, Law::centroid, Law::point}) {
      add("grasp/" + std::string(law_name(law)) + "/mug_" + std::to_string(segments),
          [=](Session& session) { make_grasp_session(law, segments, 3, 7, 0.01, session); });
    }
  }
  // Every tick of examples/demo.json, once each; its settings are the default ones.
  add("demo/1e-4/mug_24", [](Session& session) {
    make_grasp_session(Law::field, 24, 0, 10, 0.001, session);
  })->Iterations(10000);
}

void add_context() { benchmark::AddCustomContext("isa", std::string(isa_name(widest_isa()))); }

const bool added = (add_context(), add_sizes(), add_floors(), add_contacts(), add_table2(), add_grasps(),
                    add_errors(), true);

}  // namespace
