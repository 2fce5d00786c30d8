// How often something strikes through: what flies at sheets and meshes, fingertips at 0 to 3 m/s and whole
// hands at 1 to 12, held by a proxy.
//
//   strikes [COUNT] [MESH.. UNIT]    COUNT (10000) strikes on each sheet, a hundredth as many by whole hands,
//                                    and as many again on each mesh (m, cm or mm)
//
// A strike is through where the proxy's axes cut a triangle, or have gone from one side of it to the other
// between two ticks. (Not where they move farther than 3 mm in a tick: where a finger slips off a rim, the
// straight way leads through the mesh, but the proxy's does not.) The time of ticks stands beside it.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "model/corners.h"
#include "model/primitive.h"
#include "pads.h"
#include "proxy/proxy_hand.h"
#include "random.h"
#include "read_number.h"
#include "timing.h"
#include "usage.h"

namespace {

using namespace lumbrical;

constexpr double kProxyStiffness = 3000;  // [N/m]
constexpr int kTicks = 40;
constexpr double kPlainWay = 0.003;  // [m]

struct Target {
  std::string name;
  Mesh mesh;
  bool middle = false;  ///< only that is struck, so that no finger slips off the rim
};

std::vector<Target> sheets() {
  return {{"open sheet", make_plane(2, 5, 0.7), true},
          {"closed sheet of 0.1 mm", make_box({2, 2, 1e-4}, 5), true},
          {"closed sheet of 0.3 mm", make_box({2, 2, 3e-4}, 5), true},
          {"closed sheet of 1 mm", make_box({2, 2, 1e-3}, 5), true}};
}

// Does the way from p to q lead through the triangle?
bool crosses(Vec3 p, Vec3 q, const Corners& at) {
  const Vec3 way = q - p;
  const auto volume = [&](Vec3 a, Vec3 b) { return dot(way, cross(a - p, b - p)); };
  const double u = volume(at.a, at.b), v = volume(at.b, at.c), w = volume(at.c, at.a);
  if (!((u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0))) return false;
  const Vec3 normal = cross(at.b - at.a, at.c - at.a);
  return (dot(normal, p - at.a) > 0) != (dot(normal, q - at.a) > 0);
}

/// A hand that flies at a place of the mesh.
struct Strike {
  DeviceFrame frame;
  Vec3 speed;  // [m/s]
};

void move(Vec3 by, DeviceFrame& frame) { frame.base.position += by; }

Strike fingertip_strike(test::Random& random, Vec3 place, Vec3 normal) {
  const Vec3 tilt = random.direction(), finger = unit_or(normal + random.between(0, 0.9) * tilt, normal);
  Strike strike{test::frame_of({{{0, 0, 0}, finger}}), {}};
  const Vec3 wrist = 0.15 * finger;
  strike.frame.joint[kWrist].position = {static_cast<float>(wrist.x), static_cast<float>(wrist.y),
                                         static_cast<float>(wrist.z)};
  strike.frame.valid |= 1u << kWrist;
  move(place + random.between(0.0095, 0.02) * normal, strike.frame);
  strike.speed = random.between(0, 3) * unit_or(-normal + random.between(0, 1) * random.direction(), -normal);
  return strike;
}

Strike hand_strike(test::Random& random, Vec3 place, Vec3 normal) {
  Strike strike;
  strike.frame.kind = InputKind::joint_angles;
  for (float& angle : strike.frame.angle) angle = static_cast<float>(random.between(-0.2, 1.2));
  const Vec3 turn = random.direction();
  const double angle = random.between(0, 2);
  strike.frame.base.orientation = normalized({1, angle * turn.x, angle * turn.y, angle * turn.z});
  move(place + random.between(0.22, 0.25) * normal, strike.frame);
  strike.speed =
      random.between(1, 12) * unit_or(-normal + random.between(0, 0.5) * random.direction(), -normal);
  return strike;
}

/// What is found of all strikes on a target.
struct Tally {
  std::uint64_t strikes = 0, held = 0, through = 0;
  std::vector<double> microseconds;
};

bool crosses_plainly(Vec3 before, Vec3 after, const Corners& at) {
  return norm(after - before) < kPlainWay && crosses(before, after, at);
}

bool has_passed(const Triangles& world, const Joints& before, const Joints& after) {
  for (std::uint32_t t = 0; t < world.size(); ++t) {
    const Corners at = corners_of(world, t);
    for (const auto& [base, tip] : kPhalanxJoints) {
      if (!after.has(base) || !after.has(tip)) continue;
      if (crosses(after.position(base), after.position(tip), at) ||
          crosses_plainly(before.position(base), after.position(base), at) ||
          crosses_plainly(before.position(tip), after.position(tip), at))
        return true;
    }
  }
  return false;
}

Joints proxy_of(const State& state) {
  return {state.proxy->joint, static_cast<std::uint32_t>(state.proxy->valid)};
}

void run_strike(const Strike& strike, test::Session& run, Tally& tally) {
  run.state = make_state(run.model);
  DeviceFrame frame = strike.frame;
  bool held = false, through = false;
  Joints before;
  for (int i = 0; i < kTicks; ++i) {
    const double start = bench::thread_microseconds();
    run.output = tick(run.model, run.state, run.scratch, frame);
    tally.microseconds.push_back(bench::thread_microseconds() - start);
    const Joints now = proxy_of(run.state);
    if (now.valid == 0) return;  // it began within the mesh
    held = held || !run.scratch.proxy->pushing.empty();
    through = through || (i > 0 && has_passed(run.model.triangles, before, now));
    before = now;
    move(1e-3 * strike.speed, frame);
  }
  ++tally.strikes;
  tally.held += held;
  tally.through += through;
}

double area_of(const Corners& at) { return norm(cross(at.b - at.a, at.c - at.a)); }

// As often as it is large.
Corners random_triangle(test::Random& random, const Triangles& world, double largest) {
  for (;;) {
    const Corners at = corners_of(world, static_cast<std::uint32_t>(random.bits() % world.size()));
    if (random.between(0, largest) < area_of(at)) return at;
  }
}

Tally strike_at(const Target& target, bool whole_hand, std::uint64_t count) {
  Scene scene = test::pad_scene();
  if (whole_hand) scene.hand = default_hand(Side::right);
  scene.settings.proxy_stiffness = kProxyStiffness;
  scene.settings.precision = every_segment(1e-4);
  scene.objects.push_back({target.name, target.mesh});
  test::Session run(scene);
  run.scratch.hash_stages = false;
  test::Random random(whole_hand ? 2 : 1);
  Tally tally;
  const Triangles& world = run.model.triangles;
  double largest = 0;
  for (std::uint32_t t = 0; t < world.size(); ++t) largest = max(largest, area_of(corners_of(world, t)));
  for (std::uint64_t i = 0; i < count; ++i) {
    const Corners at = random_triangle(random, world, largest);
    double u = random.between(0, 1), v = random.between(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    Vec3 place = at.a + u * (at.b - at.a) + v * (at.c - at.a);
    if (target.middle) place = {0.3 * place.x, 0.3 * place.y, place.z};
    const Vec3 normal = unit_or(cross(at.b - at.a, at.c - at.a), {0, 0, 1});
    run_strike(whole_hand ? hand_strike(random, place, normal) : fingertip_strike(random, place, normal), run,
               tally);
  }
  return tally;
}

bool print_row(const Target& target, bool whole_hand, std::uint64_t count) {
  Tally tally = strike_at(target, whole_hand, std::max<std::uint64_t>(count, 1));
  std::printf("| %s | %s | %llu | %llu | %llu | %.1f | %.1f |\n", target.name.c_str(),
              whole_hand ? "hand" : "fingertip", static_cast<unsigned long long>(tally.strikes),
              static_cast<unsigned long long>(tally.held), static_cast<unsigned long long>(tally.through),
              bench::percentile(tally.microseconds, 0.5), bench::percentile(tally.microseconds, 0.99));
  std::fflush(stdout);
  return tally.through == 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t count = 10000;
  const bool is_count = argc < 2 || bench::read_number(argv[1], std::uint64_t{1000000000}, count);
  std::vector<Target> targets = sheets();
  const auto unit = parse_unit(argc > 2 ? argv[argc - 1] : "m");
  if (!is_count || !unit || argc == 3 || bench::has_switch(argc, argv))
    return bench::tell_usage("strikes [COUNT] [MESH.. UNIT]    UNIT is m, cm or mm", argc, argv);
  for (int i = 2; i < argc - 1; ++i) {
    Target target{argv[i], {}};
    if (const Status status = load_mesh(argv[i], *unit, target.mesh); !status.ok()) {
      std::fprintf(stderr, "%s\n", status.message().c_str());
      return 1;
    }
    targets.push_back(std::move(target));
  }
  std::printf(
      "| target | striker | strikes | held | through | tick p50 [us] | p99 "
      "|\n|---|---|---|---|---|---|---|\n");
  bool good = true;
  for (const Target& target : targets) {
    good = print_row(target, false, count) && good;
    good = print_row(target, true, count / 100) && good;
  }
  return good ? 0 : 1;
}
