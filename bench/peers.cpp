// bench_peers: every rung of our tick beside Bullet, FCL, ODE, Embree and what the paper's related work does,
// on the same meshes and poses, interleaved in one run, with each one's contacts checked against brute force
// and its force against the exact rung's.
//
// Debian: libbullet-dev libfcl-dev libode-dev libembree-dev; what is not there is left out. --most 1100000
// adds a million triangles, --scenes B the growing scene alone. --clock processor leaves out what other
// programs take of a busy machine.
//
//   bench_peers [--scenes A,B] [--most TRIANGLES] [--poses N] [--seconds S] [--clock wall|processor] [--out
//   FOLDER]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "hand_scenes.h"
#include "machine.h"
#include "model/corner_normals.h"
#include "origin.h"
#include "peer.h"
#include "peer_table.h"
#include "peer_truth.h"
#include "pose_hand.h"
#include "read_number.h"
#include "timing.h"
#include "usage.h"

namespace lumbrical::bench {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  std::string scenes = "A,B", out;
  std::size_t most = 110'000;  // triangles
  int poses = 16;
  double seconds = 3;  // for the measurements of one scene
  bool processor_time = false;
};

// What is measured: posed once, the same for all.
struct Task {
  Scene scene;
  std::vector<DeviceFrame> frames;
  std::vector<std::vector<Primitive>> capsules, tiles;  // whole phalanges; their shares of the fingers
};

// ---- Contenders ----

struct Outcome {
  std::vector<std::uint32_t> triangles;  // ascending, each once
  std::size_t contacts = 0;
  Vec3 force;       // [m^3] K_s = 1; of what has no area [m], up to a constant
  double area = 0;  // [m^2]
};

struct Contender {
  std::string name, leaves_out;
  double build_ms = 0;
  bool has_area = false;  // and so a force of its own
  bool has_list = true;   // of triangles that are touched; our rungs of samples only count them
  std::function<void(std::size_t pose)> run;
  std::function<Outcome()> outcome;  // of the last run
  std::vector<double> times;         // [us]
  std::vector<Outcome> outcomes;     // by pose
};

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

void sort_out(std::vector<std::uint32_t>& triangles) {
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
}

struct Rung {
  const char* name;
  double precision;
};
// The first is what all others are held against.
constexpr Rung kRungs[] = {{"ours, exact", 0}, {kOurs, 1e-4}, {"ours, 1e-3", 1e-3}, {"ours, 1e-5", 1e-5}};

struct Session {
  Model model;
  State state;
  Scratch scratch;
  ActuatorFrame output;
};

Outcome outcome_of(Session& session, bool has_list) {
  Outcome outcome;
  outcome.contacts = session.output.contact_count;
  for (const Wrench& wrench : session.output.segment)
    outcome.force += 1 / session.model.settings.stiffness * wrench.force;
  if (!has_list) return outcome;
  for (const Contact& contact : find_contacts(session.model, session.scratch)) {
    outcome.triangles.push_back(contact.triangle);
    outcome.area += contact.area;
  }
  sort_out(outcome.triangles);
  return outcome;
}

Contender ours(const Task& task, const Rung& rung) {
  const auto session = std::make_shared<Session>();
  Scene scene = task.scene;
  scene.settings.precision.fill(rung.precision);
  scene.settings.felt_once = FeltOnce::never;  // others know nothing of it
  const auto start = Clock::now();
  if (!build_model(scene, {}, session->model).ok()) std::abort();
  Contender contender;
  contender.build_ms = milliseconds_since(start);
  session->scratch = make_scratch(session->model);
  session->scratch.hash_stages = false;
  contender.name = rung.name;
  contender.has_area = true;
  contender.has_list = rung.precision == 0;
  contender.run = [&task, session](std::size_t pose) {
    session->output = tick(session->model, session->state, session->scratch, task.frames[pose]);
  };
  contender.outcome = [session, has_list = contender.has_list] { return outcome_of(*session, has_list); };
  return contender;
}

Contender theirs(const Task& task, const Mesh& mesh, Peer (*make)(const Mesh&)) {
  const auto start = Clock::now();
  const auto peer = std::make_shared<Peer>(make(mesh));
  const auto contacts = std::make_shared<std::vector<PeerContact>>();
  Contender contender;
  contender.build_ms = milliseconds_since(start);
  contender.name = peer->name;
  contender.has_area = peer->has_area;
  contender.leaves_out = peer->leaves_out;
  contender.run = [&task, peer, contacts](std::size_t pose) {
    contacts->clear();
    peer->find(peer->has_area ? task.tiles[pose] : task.capsules[pose], *contacts);
  };
  contender.outcome = [&mesh, peer, contacts] {
    Outcome outcome;
    outcome.contacts = contacts->size();
    for (const PeerContact& contact : *contacts) {
      const auto triangle = static_cast<std::uint32_t>(contact.pair);
      outcome.triangles.push_back(triangle);
      outcome.force += contact.depth * (peer->has_area ? contact.area : 1) *
                       triangle_normal(mesh, mesh.triangles[triangle]);
      outcome.area += contact.area;
    }
    sort_out(outcome.triangles);
    return outcome;
  };
  return contender;
}

using Makers = std::vector<Peer (*)(const Mesh&)>;
Makers all_peers() {
  Makers makers = {make_point_probes, make_point_meshes, make_sphere_hand, make_point_shell};
#ifdef LUMBRICAL_BULLET
  makers.push_back(make_bullet);
  makers.push_back(make_bullet_tree);
#endif
#ifdef LUMBRICAL_FCL
  makers.push_back(make_fcl);
#endif
#ifdef LUMBRICAL_ODE
  makers.push_back(make_ode);
#endif
#ifdef LUMBRICAL_EMBREE
  makers.push_back(make_embree);
#endif
  return makers;
}

// ---- One scene ----

std::size_t count_missing(const std::vector<std::uint32_t>& from, const std::vector<std::uint32_t>& in) {
  std::vector<std::uint32_t> missing;
  std::set_difference(from.begin(), from.end(), in.begin(), in.end(), std::back_inserter(missing));
  return missing.size();
}

// The constant by which forces without a unit come nearest to the true ones.
double best_scale(const std::vector<Outcome>& outcomes, const std::vector<Truth>& truths) {
  double product = 0, square = 0;
  for (std::size_t i = 0; i < truths.size(); ++i) {
    product += dot(outcomes[i].force, truths[i].force);
    square += dot(outcomes[i].force, outcomes[i].force);
  }
  return square > 0 ? product / square : 0;
}

// Means over the poses, and what the contact lists miss or have too many.
void add_contacts(const Contender& contender, const std::vector<Truth>& truths, PeerRow& row) {
  const auto poses = static_cast<double>(truths.size());
  double missed = 0, extra = 0;
  for (std::size_t i = 0; i < truths.size(); ++i) {
    const Outcome& outcome = contender.outcomes[i];
    const Truth& truth = truths[i];
    std::vector<std::uint32_t> allowed;
    std::set_union(truth.touched.begin(), truth.touched.end(), truth.doubtful.begin(), truth.doubtful.end(),
                   std::back_inserter(allowed));
    row.touched += static_cast<double>(truth.touched.size()) / poses;
    row.contacts += static_cast<double>(outcome.contacts) / poses;
    missed += static_cast<double>(count_missing(truth.touched, outcome.triangles)) / poses;
    extra += static_cast<double>(count_missing(outcome.triangles, allowed)) / poses;
  }
  if (!contender.has_list) return;
  row.missed = missed / max(row.touched, 1);
  row.extra = extra / max(row.touched, 1);
}

PeerRow row_of(Contender& contender, const std::vector<Truth>& truths) {
  PeerRow row;
  row.contender = contender.name;
  row.leaves_out = contender.leaves_out;
  row.build_ms = contender.build_ms;
  row.median_us = percentile(contender.times, 0.5);
  row.p99_us = percentile(contender.times, 0.99);
  row.samples = contender.times.size();
  row.fitted = !contender.has_area;
  add_contacts(contender, truths, row);
  const double scale = contender.has_area ? 1 : best_scale(contender.outcomes, truths);
  for (std::size_t i = 0; i < truths.size(); ++i) {
    const Outcome& outcome = contender.outcomes[i];
    const Truth& truth = truths[i];
    row.force_error = max(row.force_error, norm(scale * outcome.force - truth.force) / norm(truth.force));
    if (contender.has_area && contender.has_list)
      row.area_error = max(row.area_error, std::fabs(outcome.area / truth.area - 1));
  }
  return row;
}

Task make_task(Touch touch, bool fine, std::uint32_t cells, int poses) {
  Task task;
  task.scene = field_scene(plain_hand(), fine, cells);
  task.frames = touching_frames(task.scene.hand, touch, fine ? test::kWidthA : test::kCellB * cells, poses);
  Primitives hand;
  for (const DeviceFrame& frame : task.frames) {
    test::pose_hand(task.scene.hand, task.scene.settings, frame, hand);
    std::vector<Primitive>& capsules = task.capsules.emplace_back();
    for (std::size_t k = 0; k < kPhalanxCount; ++k) {
      if (hand.present[k]) capsules.push_back(hand.capsule[k]);
    }
    task.tiles.emplace_back(hand.primitive.begin(), hand.primitive.begin() + hand.count);
  }
  return task;
}

// All take turns, so that what disturbs the machine disturbs all alike. A turn is every pose once: a hand
// that ticks finds its own data in the caches, not what others left there.
void measure(std::vector<Contender>& contenders, std::size_t poses, const Options& options) {
  const clockid_t clock = options.processor_time ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC;
  const auto start = Clock::now();
  for (int round = 0; round < 400; ++round) {
    for (Contender& contender : contenders) {
      for (std::size_t pose = 0; pose < poses; ++pose) {
        const double from = microseconds(clock);
        contender.run(pose);
        const double time = microseconds(clock) - from;
        if (round == 0) contender.outcomes.push_back(contender.outcome());  // and warms the caches up
        if (round > 0) contender.times.push_back(time);
      }
    }
    if (round > 0 && milliseconds_since(start) > 1e3 * options.seconds) break;
  }
}

void add_rows(const std::string& scene, std::size_t triangles, std::vector<Contender>& contenders,
              const std::vector<Truth>& truths, PeerReport& report) {
  double exact = 0, ours = 0;
  std::vector<PeerRow> rows;
  for (Contender& contender : contenders) {
    PeerRow& row = rows.emplace_back(row_of(contender, truths));
    row.scene = scene;
    row.triangles = triangles;
    if (row.contender == kRungs[0].name) exact = row.median_us;
    if (row.contender == kOurs) ours = row.median_us;
  }
  for (PeerRow& row : rows) {
    row.times_exact = row.median_us / exact;
    row.times_ours = row.median_us / ours;
    report.rows.push_back(row);
  }
}

void run_scene(const std::string& name, Touch touch, bool fine, std::uint32_t cells, const Options& options,
               PeerReport& report) {
  std::fprintf(stderr, "%s, %u triangles ...\n", name.c_str(), 2 * cells * cells);
  const Task task = make_task(touch, fine, cells, options.poses);
  const Mesh& mesh = task.scene.objects[0].mesh;
  std::vector<Contender> contenders;
  for (const Rung& rung : kRungs) contenders.push_back(ours(task, rung));
  for (const auto make : all_peers()) contenders.push_back(theirs(task, mesh, make));
  measure(contenders, task.frames.size(), options);
  std::vector<Truth> truths;
  for (std::size_t pose = 0; pose < task.frames.size(); ++pose) {
    Truth& truth = truths.emplace_back(touched_by(task.capsules[pose], mesh));
    truth.force = contenders[0].outcomes[pose].force;
    truth.area = contenders[0].outcomes[pose].area;
  }
  add_rows(name, mesh.triangles.size(), contenders, truths, report);
}

bool parse(int count, char** words, Options& options) {
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string name = words[i];
    const char* const value = words[i + 1];
    if (name == "--scenes") {
      options.scenes = value;
    } else if (name == "--most") {
      if (!bench::read_number(value, std::size_t{1} << 31, options.most)) return false;
    } else if (name == "--poses") {
      if (!bench::read_number(value, 100000, options.poses)) return false;
    } else if (name == "--seconds") {
      if (!bench::read_number(value, 1e6, options.seconds)) return false;
    } else if (name == "--clock") {
      options.processor_time = std::string(value) == "processor";
    } else if (name == "--out") {
      options.out = value;
    } else {
      return false;
    }
  }
  return count % 2 == 1;
}

void run_all(const Options& options, PeerReport& report) {
  const auto wanted = [&](char scene) { return options.scenes.find(scene) != std::string::npos; };
  const std::pair<Touch, const char*> touches[] = {
      {Touch::drape, " drape"}, {Touch::tips, " tips"}, {Touch::finger, " one finger"}};
  for (const std::uint32_t cells : {9u, 29u, 49u, 69u, 224u, 708u, 2236u}) {
    if (2ull * cells * cells > options.most) continue;
    for (const auto& [touch, how] : touches) {
      if (wanted('A')) run_scene(std::string("A") + how, touch, true, cells, options, report);
      // Scene B is A at 69 cells, nearly, and smaller than the hand below.
      if (wanted('B') && cells > 69 && touch != Touch::finger)
        run_scene(std::string("B") + how, touch, false, cells, options, report);
    }
  }
}

}  // namespace
}  // namespace lumbrical::bench

int main(int count, char** words) {
  using namespace lumbrical::bench;
  Options options;
  if (!parse(count, words, options)) {
    return tell_usage(
        "bench_peers [--scenes A,B] [--most TRIANGLES] [--poses N] [--seconds S] "
        "[--clock wall|processor] [--out FOLDER]",
        count, words);
  }
  PeerReport report;
  report.origin = origin_members();
  report.cpu = cpu_name();
  report.compiler = LUMBRICAL_COMPILER;
  report.flags = LUMBRICAL_COMPILER_FLAGS;
  report.isa = lumbrical::isa_name(lumbrical::widest_isa());
  report.poses = options.poses;
  report.processor_time = options.processor_time;
  report.command =
      "cmake --preset release && cmake --build --preset release --target "
      "bench_peers\nbuild/release/bench/bench_peers";
  for (int i = 1; i < count; ++i) report.command += std::string(" ") + words[i];
  run_all(options, report);
  const std::string table = to_markdown(report);
  if (options.out.empty()) {
    std::fputs(table.c_str(), stdout);
    return 0;
  }
  std::filesystem::create_directories(options.out);
  std::ofstream markdown(options.out + "/peers.md"), json(options.out + "/peers.json");
  markdown << table;
  json << to_json(report);
  markdown.close();
  json.close();
  if (!markdown.fail() && !json.fail()) return 0;
  std::fprintf(stderr, "can't write to %s\n", options.out.c_str());
  return 1;
}
