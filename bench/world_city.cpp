// A city too large for memory: what building, opening and touching it takes (docs/worlds.md).
//
//   world_city build TRIANGLES CITY.world             streamed tile by tile
//   world_city walk CITY.world [ahead|alone] [SECONDS [SPEED]]
//                                                     a hand strokes along a street, 1000 ticks per second by
//                                                     the clock, with nothing of the file in the system's
//                                                     cache
//   world_city memory TRIANGLES [SECONDS [SPEED]]     the same with the city in memory
//
// The city has streets of sixty tiles of 1 m, 3 m apart in ten storeys; a tile's triangles have legs of 5 to
// 50 mm.
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "lumbrical/world.h"
#include "pressed_hand.h"
#include "random.h"
#include "timing.h"

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
  status = for_each_tile(
      triangles, [&](const std::string& name, const Mesh& mesh) { return writer.add_object(name, mesh); });
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

struct Walk {
  double seconds = 20, speed = 0.5;  // [m/s]
};

int walk(const Scene& scene, const Execution& execution, bool ahead, const Walk& how) {
  Model model;
  if (Status status = build_model(scene, execution, model); !status.ok()) return fail(status);
  if (scene.world) forget(scene.world->path);
  WorldPager pager(ahead ? model : Model{}, {});
  State state;
  Scratch scratch = make_scratch(model);
  const DeviceFrame still = test::pressed_frame(scene.hand, 0.002, 0);
  std::vector<double> times;
  std::uint64_t contacts = 0;
  double most = 0;
  rusage before{}, after{};
  pager.hand_at(still);
  pager.catch_up();
  tick(model, state, scratch, still);
  ::getrusage(RUSAGE_THREAD, &before);
  const auto start = Clock::now();
  const auto ticks = static_cast<int>(1000 * how.seconds);
  for (int i = 0; i < ticks; ++i) {
    std::this_thread::sleep_until(start + std::chrono::milliseconds(i));
    DeviceFrame frame = still;
    frame.base.position.x += how.speed * 0.001 * i;
    const auto begin = Clock::now();
    pager.hand_at(frame);
    contacts += tick(model, state, scratch, frame).contact_count;
    times.push_back(1e6 * seconds_since(begin));
    if (i % 1000 == 0) most = std::max(most, megabytes("RssFile"));
  }
  ::getrusage(RUSAGE_THREAD, &after);
  std::printf(
      "%s, %.0f million triangles, %.1f m/s: tick p50 %.0f  p99 %.0f  p99.9 %.0f  max %.0f us; "
      "pages waited for %ld, mapped late %ld; mean contacts %.0f; file in memory at most %.0f MB, held "
      "%.0f MB; peak memory %.0f MB\n",
      !scene.world ? "in memory"
      : ahead      ? "thread ahead"
                   : "no thread ahead",
      1e-6 * static_cast<double>(model.triangles.size()), how.speed, bench::percentile(times, 0.5),
      bench::percentile(times, 0.99), bench::percentile(times, 0.999), bench::percentile(times, 1),
      after.ru_majflt - before.ru_majflt, after.ru_minflt - before.ru_minflt,
      static_cast<double>(contacts) / ticks, most, 1e-6 * static_cast<double>(pager.held_bytes()),
      megabytes("VmHWM"));
  return 0;
}

Walk walk_of(int argc, char** argv, int first) {
  Walk how;
  if (argc > first) how.seconds = std::atof(argv[first]);
  if (argc > first + 1) how.speed = std::atof(argv[first + 1]);
  return how;
}

int walk_file(const std::string& path, bool ahead, const Walk& how) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  forget(path);
  const auto start = Clock::now();
  if (Status status = open_world(path, scene.world); !status.ok()) return fail(status);
  std::printf("opened and checked in %.1f s, %.0f MB file, %.0f MB of it in memory afterwards\n",
              seconds_since(start), 1e-6 * static_cast<double>(scene.world->byte_count),
              megabytes("RssFile"));
  return walk(scene, {}, ahead, how);
}

int walk_memory(double triangles, const Walk& how) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  const Status status = for_each_tile(triangles, [&](const std::string& name, Mesh& mesh) {
    scene.objects.push_back({name, std::move(mesh)});
    return Status();
  });
  if (!status.ok()) return fail(status);
  Execution execution;
  execution.broadphase = Broadphase::grid;
  return walk(scene, execution, false, how);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 2 ? argv[1] : "";
  if (what == "build" && argc > 3) return build(std::atof(argv[2]), argv[3]);
  if (what == "memory") return walk_memory(std::atof(argv[2]), walk_of(argc, argv, 3));
  if (what == "walk")
    return walk_file(argv[2], argc < 4 || std::string(argv[3]) != "alone", walk_of(argc, argv, 4));
  std::fprintf(stderr,
               "world_city build TRIANGLES FILE | walk FILE [ahead|alone] [SECONDS [SPEED]] | "
               "memory TRIANGLES [SECONDS [SPEED]]\n");
  return 2;
}
