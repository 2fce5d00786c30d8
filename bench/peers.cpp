// bench_peers: our tick beside Bullet, FCL, ODE and Embree on the same meshes and poses, interleaved in one
// run, with each one's contacts checked against brute force and its force against the exact one.
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
#include "peer.h"
#include "peer_table.h"
#include "stages/hand_pose.h"
#include "timing.h"

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
  Model model;
  double build_ms = 0;  // of the model
  std::vector<DeviceFrame> frames;
  std::vector<Primitives> hands;
  std::vector<std::vector<Primitive>> capsules, tiles;  // whole phalanges; their shares of the fingers
};

struct Truth {
  std::vector<std::uint32_t> touched, doubtful;  // triangles, ascending; doubtful: within 1 um of touching
  Vec3 force;                                    // [m^3] K_s = 1
  double area = 0;                               // [m^2]
};

// ---- Brute force ----

double square_between(Vec3 p, Vec3 q, Vec3 a, Vec3 b) {
  const Vec3 u = q - p, v = b - a, w = p - a;
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), uw = dot(u, w), vw = dot(v, w);
  const double det = uu * vv - uv * uv;
  double s = det > 1e-14 * uu * vv ? clamp((uv * vw - vv * uw) / det, 0, 1) : 0;
  const double t = vv > 0 ? clamp((s * uv + vw) / vv, 0, 1) : 0;
  s = uu > 0 ? clamp((t * uv - uw) / uu, 0, 1) : 0;
  const Vec3 gap = w + s * u - t * v;
  return dot(gap, gap);
}

bool above_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c, Vec3 n) {
  return dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 &&
         dot(cross(a - c, p - c), n) >= 0;
}

// [m] between the phalanx' axis and the triangle.
double distance_between(const Primitive& phalanx, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 p = phalanx.end1, q = phalanx.end2, n = cross(b - a, c - a);
  const double hp = dot(n, p - a), hq = dot(n, q - a), square = dot(n, n);
  if (square > 0 && (hp < 0) != (hq < 0) && above_triangle(p + hp / (hp - hq) * (q - p), a, b, c, n))
    return 0;
  double least = min(square_between(p, q, a, b), min(square_between(p, q, b, c), square_between(p, q, c, a)));
  if (square > 0 && above_triangle(p, a, b, c, n)) least = min(least, hp * hp / square);
  if (square > 0 && above_triangle(q, a, b, c, n)) least = min(least, hq * hq / square);
  return std::sqrt(least);
}

Truth truth_of(const Task& task, std::size_t pose, const Mesh& mesh) {
  constexpr double kDoubt = 1e-6;
  Truth truth;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    const Vec3 a = mesh.vertices[triangle[0]], b = mesh.vertices[triangle[1]], c = mesh.vertices[triangle[2]];
    double outside = 1;
    const double reach = max(norm(b - a), norm(c - a));
    for (const Primitive& phalanx : task.capsules[pose]) {
      const double far = phalanx.radius1 + reach + norm(phalanx.end2 - phalanx.end1);
      const Vec3 away = a - phalanx.end1;
      if (dot(away, away) > far * far) continue;
      outside = min(outside, distance_between(phalanx, a, b, c) - phalanx.radius1);
    }
    if (outside < -kDoubt) truth.touched.push_back(t);
    if (std::fabs(outside) <= kDoubt) truth.doubtful.push_back(t);
  }
  return truth;
}

// ---- Contenders ----

struct Outcome {
  std::vector<std::uint32_t> triangles;  // ascending, each once
  std::size_t contacts = 0;
  Vec3 force;
  double area = 0;
};

struct Contender {
  std::string name;
  double build_ms = 0;
  bool has_area = false, is_ours = false;
  std::function<void(std::size_t pose)> run;
  std::function<Outcome()> outcome;  // of the last run
  std::vector<double> times;         // [us]
  std::vector<Outcome> outcomes;     // by pose
};

void sort_out(std::vector<std::uint32_t>& triangles) {
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
}

Vec3 normal_of(const Mesh& mesh, std::uint32_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3 a = mesh.vertices[t[0]];
  return unit_or(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a), {});
}

Contender ours(const Task& task) {
  const auto scratch = std::make_shared<Scratch>(make_scratch(task.model));
  const auto state = std::make_shared<State>();
  scratch->hash_stages = false;
  Contender contender;
  contender.name = "ours, field law, exact";
  contender.build_ms = task.build_ms;
  contender.has_area = contender.is_ours = true;
  contender.run = [&task, scratch, state](std::size_t pose) {
    tick(task.model, *state, *scratch, task.frames[pose]);
  };
  contender.outcome = [scratch] {
    Outcome outcome;
    outcome.contacts = scratch->contact_count;
    for (std::uint32_t i = 0; i < scratch->contact_count; ++i) {
      const Contact& contact = scratch->contacts[i];
      outcome.triangles.push_back(contact.triangle);
      outcome.force += contact.volume * contact.normal;
      outcome.area += contact.area;
    }
    sort_out(outcome.triangles);
    return outcome;
  };
  return contender;
}

Contender theirs(const Task& task, const Mesh& mesh, Peer (*make)(const Mesh&)) {
  const auto start = Clock::now();
  const auto peer = std::make_shared<Peer>(make(mesh));
  const auto contacts = std::make_shared<std::vector<PeerContact>>();
  Contender contender;
  contender.name = peer->name;
  contender.build_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  contender.has_area = peer->has_area;
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
      outcome.force += contact.depth * (peer->has_area ? contact.area : 1) * normal_of(mesh, triangle);
      outcome.area += contact.area;
    }
    sort_out(outcome.triangles);
    return outcome;
  };
  return contender;
}

using Makers = std::vector<Peer (*)(const Mesh&)>;
Makers all_peers() {
  Makers makers;
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

PeerRow row_of(Contender& contender, const std::vector<Truth>& truths) {
  PeerRow row;
  row.contender = contender.name;
  row.build_ms = contender.build_ms;
  row.median_us = percentile(contender.times, 0.5);
  row.p99_us = percentile(contender.times, 0.99);
  row.samples = contender.times.size();
  row.fitted = !contender.has_area;
  const double scale = contender.has_area ? 1 : best_scale(contender.outcomes, truths);
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
    row.force_error = max(row.force_error, norm(scale * outcome.force - truth.force) / norm(truth.force));
    if (contender.has_area) row.area_error = max(row.area_error, std::fabs(outcome.area / truth.area - 1));
  }
  row.missed = missed / max(row.touched, 1);
  row.extra = extra / max(row.touched, 1);
  return row;
}

Task make_task(const Scene& scene, bool drape, int poses) {
  Task task;
  const auto start = Clock::now();
  if (!build_model(scene, {}, task.model).ok()) std::abort();
  task.build_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  for (int i = 0; i < poses; ++i) {
    const double time = i / static_cast<double>(poses), depth = 0.001 + 0.002 * time;
    task.frames.push_back(drape ? test::pressed_frame(scene.hand, depth, time)
                                : tips_frame(scene.hand, depth, time));
    Primitives& hand = task.hands.emplace_back();
    pose_hand(task.model.hand, task.model.settings, task.frames.back(), hand);
    std::vector<Primitive>& capsules = task.capsules.emplace_back();
    for (std::size_t k = 0; k < kPhalanxCount; ++k) {
      if (hand.present[k]) capsules.push_back(hand.capsule[k]);
    }
    task.tiles.emplace_back(hand.primitive.begin(), hand.primitive.begin() + hand.count);
  }
  return task;
}

// Every contender does every pose in turn, so that what disturbs the machine disturbs all alike.
void measure(std::vector<Contender>& contenders, std::size_t poses, const Options& options) {
  const clockid_t clock = options.processor_time ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC;
  const auto start = Clock::now();
  for (int round = 0; round < 400; ++round) {
    for (std::size_t pose = 0; pose < poses; ++pose) {
      for (Contender& contender : contenders) {
        const double from = microseconds(clock);
        contender.run(pose);
        const double time = microseconds(clock) - from;
        if (round == 0) contender.outcomes.push_back(contender.outcome());  // and warms the caches up
        if (round > 0) contender.times.push_back(time);
      }
    }
    if (round > 0 && std::chrono::duration<double>(Clock::now() - start).count() > options.seconds) break;
  }
}

void run_scene(const std::string& name, double extent, std::uint32_t cells, bool drape,
               const Options& options, PeerReport& report) {
  std::fprintf(stderr, "%s, %u triangles ...\n", name.c_str(), 2 * cells * cells);
  Scene scene;
  scene.hand = plain_hand();
  scene.settings.max_candidates = 1u << 22;
  scene.objects.push_back({"field", make_height_field(extent, cells, 0.002, 0.04)});
  const Mesh& mesh = scene.objects[0].mesh;
  const Task task = make_task(scene, drape, options.poses);
  std::vector<Contender> contenders;
  contenders.push_back(ours(task));
  for (const auto make : all_peers()) contenders.push_back(theirs(task, mesh, make));
  measure(contenders, static_cast<std::size_t>(options.poses), options);
  std::vector<Truth> truths;
  for (std::size_t pose = 0; pose < static_cast<std::size_t>(options.poses); ++pose) {
    truths.push_back(truth_of(task, pose, mesh));
    truths.back().force = contenders[0].outcomes[pose].force;
    truths.back().area = contenders[0].outcomes[pose].area;
  }
  const std::size_t first = report.rows.size();
  for (Contender& contender : contenders) {
    report.rows.push_back(row_of(contender, truths));
    PeerRow& row = report.rows.back();
    row.scene = name;
    row.triangles = mesh.triangles.size();
    row.times_ours = row.median_us / report.rows[first].median_us;
  }
}

std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(": ") + 2);
  }
  return "unknown";
}

bool parse(int count, char** words, Options& options) {
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string name = words[i];
    const char* const value = words[i + 1];
    if (name == "--scenes") {
      options.scenes = value;
    } else if (name == "--most") {
      options.most = std::strtoull(value, nullptr, 10);
    } else if (name == "--poses") {
      options.poses = std::atoi(value);
    } else if (name == "--seconds") {
      options.seconds = std::strtod(value, nullptr);
    } else if (name == "--clock") {
      options.processor_time = std::string(value) == "processor";
    } else if (name == "--out") {
      options.out = value;
    } else {
      return false;
    }
  }
  return count % 2 == 1 && options.poses > 0 && options.seconds > 0;
}

void run_all(const Options& options, PeerReport& report) {
  for (const std::uint32_t cells : {9u, 29u, 49u, 69u, 224u, 708u, 2236u}) {
    if (2ull * cells * cells > options.most) continue;
    for (const bool drape : {true, false}) {
      const std::string how = drape ? " drape" : " tips";
      if (options.scenes.find('A') != std::string::npos)
        run_scene("A" + how, test::kWidthA, cells, drape, options, report);
      // Scene B is A at 69 cells, nearly, and smaller than the hand below.
      if (options.scenes.find('B') != std::string::npos && cells > 69)
        run_scene("B" + how, test::kCellB * cells, cells, drape, options, report);
    }
  }
}

}  // namespace
}  // namespace lumbrical::bench

int main(int count, char** words) {
  using namespace lumbrical::bench;
  Options options;
  if (!parse(count, words, options)) {
    std::fprintf(stderr,
                 "bench_peers [--scenes A,B] [--most TRIANGLES] [--poses N] [--seconds S] "
                 "[--clock wall|processor] [--out FOLDER]\n");
    return 2;
  }
  PeerReport report;
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
