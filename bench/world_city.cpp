// A city too large for memory: what building, opening and touching it takes (docs/worlds.md).
//
//   world_city build TRIANGLES CITY.world             streamed tile by tile
//   world_city walk CITY.world [ahead|alone] [SECONDS [SPEED [PRECISION]]]
//                                                     a hand goes across the streets, 1000 ticks per second
//                                                     by the clock, with nothing of the file in the system's
//                                                     cache
//   world_city memory TRIANGLES [SECONDS [SPEED [PRECISION]]]  the same with the city in memory
//
// The city has streets of sixty tiles of 1 m, 3 m apart in ten storeys; a tile's triangles have legs of 5 to
// 50 mm.
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "lumbrical/world.h"
#include "pressed_hand.h"
#include "random.h"
#include "read_number.h"
#include "timing.h"
#include "usage.h"

namespace {

using namespace lumbrical;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

int fail(const Status& status) {
  std::fprintf(stderr, "%s\n", status.message().c_str());
  return 2;
}

/// [MB] of this process, as the kernel counts them under `key`: VmHWM is the peak, RssFile of mapped files.
double megabytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(key + ":")) return 1.024e-3 * std::stod(line.substr(key.size() + 1));
  return 0;
}

constexpr double kStreet = 3;  // [m] from one to the next
constexpr int kTiles = 60, kStoreys = 10;

/// How often this thread has given up its processor to wait for something; in a tick that can only be the
/// disk.
long sleeps() {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nvcsw;
}

/// Tile after tile along the streets, until there are as many triangles.
Status for_each_tile(double triangles, const std::function<Status(const std::string&, Mesh&)>& take) {
  test::Random random(4);
  double done = 0;
  for (int tile = 0; done < triangles; ++tile) {
    const double leg = 0.005 * std::pow(10, random.between(0, 1));
    Mesh mesh = make_height_field(1, static_cast<std::uint32_t>(std::lround(1 / leg)), 0.002, 0.04);
    const int row = tile / kTiles;
    const Vec3 at{1.0 * (tile % kTiles), kStreet * (row / kStoreys), kStreet * (row % kStoreys)};
    for (Vec3& p : mesh.vertices) p += at;
    done += static_cast<double>(mesh.triangles.size());
    if (Status status = take("tile " + std::to_string(tile), mesh); !status.ok()) return status;
  }
  return {};
}

int build(double triangles, const std::string& path) {
  const auto start = Clock::now();
  Execution execution;
  execution.threads = std::max(1u, std::thread::hardware_concurrency());
  WorldWriter writer;
  Status status = writer.open(path, execution);
  if (!status.ok()) return fail(status);
  status = for_each_tile(triangles, [&](const std::string& name, const Mesh& mesh) {
    return writer.add_object({name, mesh});
  });
  const double added = seconds_since(start);
  if (status.ok()) status = writer.finish();
  if (!status.ok()) return fail(status);
  std::ifstream file(path, std::ios::ate);
  std::printf("built in %.1f s (%.1f s of it making and adding tiles), %.0f MB file, peak memory %.0f MB\n",
              seconds_since(start), added, 1e-6 * static_cast<double>(file.tellg()), megabytes("VmHWM"));
  return 0;
}

void forget(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY);
  ::fsync(descriptor);
  ::posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED);
  ::close(descriptor);
}

/// Across the streets of a storey, up to the next, and back across that one's: wherever it comes is new.
Vec3 place_after(double way, double width) {
  const int storey = static_cast<int>(way / (width + kStreet));
  const double along = way - storey * (width + kStreet), across = std::min(along, width);
  return {0, storey % 2 == 0 ? across : width - across, kStreet * storey + (along - across)};
}

struct Walk {
  double seconds = 40, speed = 1.5;  // [m/s]
  double precision = 1e-4;           // 0: exact
};

constexpr int kChecked = 97;  // ticks from one to the next that the exact rung feels too

struct Felt {
  DeviceFrame frame;
  ActuatorFrame output;
};

// How far off they are at worst, of the hand's force.
int check(const Model& measured, const std::vector<Felt>& ticks) {
  Settings settings = measured.settings;
  if (settings.precision[0] > 0) settings.felt_once = FeltOnce::always;
  settings.precision.fill(0);
  Model exact;
  if (Status status = change_settings(measured, settings, 1, exact); !status.ok()) return fail(status);
  State state;
  Scratch scratch = make_scratch(exact);
  double worst = 0;
  for (const Felt& felt : ticks) {
    const ActuatorFrame right = tick(exact, state, scratch, felt.frame);
    Vec3 off;
    double size = 0;
    for (std::size_t i = 0; i < kSegmentCount; ++i) {
      off += felt.output.segment[i].force - right.segment[i].force;
      size += norm(right.segment[i].force);
    }
    if (size > 0) worst = std::max(worst, norm(off) / size);
  }
  std::printf("at most %.0e of the hand's force beside the exact rung, in %zu ticks\n", worst, ticks.size());
  return 0;
}

// `programs`: [MB] of program and libraries, which are files as well.
int walk(const Scene& scene, const Execution& execution, bool ahead, const Walk& how, double programs) {
  Model model;
  if (Status status = build_model(scene, execution, model); !status.ok()) return fail(status);
  if (scene.world) forget(scene.world->path);
  WorldPager pager(ahead ? model : Model{}, {});
  State state;
  Scratch scratch = make_scratch(model);
  const DeviceFrame still = test::pressed_frame(scene.hand, 0.002, 0);
  std::vector<double> times;
  std::vector<Felt> checked;
  std::uint64_t contacts = 0;
  double most = 0;
  double waited = 0;  // [us] in ticks that waited
  int waits = 0;
  pager.hand_at(still);
  pager.catch_up();
  tick(model, state, scratch, still);
  const double streets = std::max(kStreet, model.extent.upper.y - 0.5);  // [m] across all of them
  const auto start = Clock::now();
  const int ticks = std::max(1, static_cast<int>(1000 * how.seconds));
  for (int i = 0; i < ticks; ++i) {
    std::this_thread::sleep_until(start + std::chrono::milliseconds(i));
    DeviceFrame frame = still;
    frame.base.position += place_after(how.speed * 0.001 * i, streets);
    const long slept = sleeps();
    const auto begin = Clock::now();
    pager.hand_at(frame);
    const ActuatorFrame output = tick(model, state, scratch, frame);
    times.push_back(1e6 * seconds_since(begin));
    contacts += output.contact_count;
    if (sleeps() > slept) {
      waited += times.back();
      ++waits;
    }
    if (i % kChecked == 0 && output.contact_count > 0) checked.push_back({frame, output});
    if (i % 1000 == 0) most = std::max(most, megabytes("RssFile"));
  }
  std::printf("%s, %.1f million triangles, %.1f m/s, %d ticks: p50 %.0f  p99 %.0f  p99.9 %.0f  max %.0f us\n",
              !scene.world ? "in memory"
              : ahead      ? "thread ahead"
                           : "no thread ahead",
              1e-6 * static_cast<double>(model.triangles.size()), how.speed, ticks,
              bench::percentile(times, 0.5), bench::percentile(times, 0.99), bench::percentile(times, 0.999),
              bench::percentile(times, 1));
  std::printf(
      "%d ticks waited for the disk, %.1f ms on average; mean contacts %.0f; of the file in memory at "
      "most %.0f MB; peak memory of the process %.0f MB\n",
      waits, waits > 0 ? 1e-3 * waited / waits : 0, static_cast<double>(contacts) / ticks,
      scene.world ? most - programs : 0, megabytes("VmHWM"));
  return check(model, checked);
}

/// From the word `first` on, as far as they are there; false: one is no such number.
bool read_walk(int argc, char** argv, int first, Walk& how) {
  const auto read = [&](int i, double most, double& number) {
    return argc <= i || bench::read_number(argv[i], most, number);
  };
  const bool exact = argc > first + 2 && std::string(argv[first + 2]) == "0";
  if (exact) how.precision = 0;
  return read(first, 1e5, how.seconds) && read(first + 1, 100, how.speed) &&
         (exact || read(first + 2, 0.1, how.precision));
}

// Forces are not limited: what is compared is what was felt.
Scene empty_scene(const Walk& how) {
  Scene scene;
  scene.settings.precision.fill(how.precision);
  scene.hand = default_hand(Side::right);
  scene.settings.max_force = 1e6;
  scene.settings.fade_time = 0;
  return scene;
}

int walk_file(const std::string& path, bool ahead, const Walk& how) {
  Scene scene = empty_scene(how);
  forget(path);
  const double programs = megabytes("RssFile");
  const auto start = Clock::now();
  if (Status status = open_world(path, scene.world); !status.ok()) return fail(status);
  std::printf("opened and checked in %.1f s, %.0f MB file, %.0f MB of it in memory afterwards\n",
              seconds_since(start), 1e-6 * static_cast<double>(scene.world->byte_count),
              megabytes("RssFile") - programs);
  return walk(scene, {}, ahead, how, programs);
}

int walk_memory(double triangles, const Walk& how) {
  Scene scene = empty_scene(how);
  const Status status = for_each_tile(triangles, [&](const std::string& name, Mesh& mesh) {
    scene.objects.push_back({name, std::move(mesh)});
    return Status();
  });
  if (!status.ok()) return fail(status);
  Execution execution;
  execution.broadphase = Broadphase::grid;
  return walk(scene, execution, false, how, 0);
}

}  // namespace

int main(int argc, char** argv) {
  const auto usage = [argc, argv] {
    return lumbrical::bench::tell_usage(
        "world_city build TRIANGLES FILE | walk FILE [ahead|alone] [SECONDS [SPEED [PRECISION]]] | "
        "memory TRIANGLES [SECONDS [SPEED [PRECISION]]]",
        argc, argv);
  };
  if (lumbrical::bench::has_switch(argc, argv)) return usage();
  const std::string what = argc > 2 ? argv[1] : "";
  double triangles = 0;
  if ((what == "build" || what == "memory") && !lumbrical::bench::read_number(argv[2], 1e12, triangles)) {
    std::fprintf(stderr, "world_city: \"%s\" is no number of triangles\n", argv[2]);
    return 2;
  }
  if (what == "build" && argc > 3) return build(triangles, argv[3]);
  Walk how;
  if (what == "memory" && read_walk(argc, argv, 3, how)) return walk_memory(triangles, how);
  const std::string reading = argc > 3 ? argv[3] : "ahead";
  if (what == "walk" && (reading == "ahead" || reading == "alone") && read_walk(argc, argv, 4, how))
    return walk_file(argv[2], reading == "ahead", how);
  return usage();
}
