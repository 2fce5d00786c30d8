// What recording costs: time of the tick thread, bytes per tick, and how fast a long file is searched.
//
//   recording_cost cost SCENE.json     the scene's session, recorded and not in turns
//   recording_cost long HOURS          a file as long as that, made by repeating one, and seeks in it
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "lumbrical/recording.h"
#include "lumbrical/scene_file.h"
#include "lumbrical/shared_objects.h"
#include "read_number.h"
#include "timing.h"
#include "usage.h"

namespace {

using namespace lumbrical;
using bench::percentile, bench::thread_microseconds;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

int fail(const std::string& message) {
  std::fprintf(stderr, "%s\n", message.c_str());
  return 2;
}

/// The session's ticks, one after the other, each way in turns of `kTurn` ticks.
class Session {
 public:
  explicit Session(const SceneFile& file) : file_(file) {}
  Status build() {
    Execution single = file_.execution;
    single.threads = 1;  // so that the tick thread's time is all of it
    Status status = build_model(file_.scene, single, model_);
    if (!status.ok()) return status;
    if (file_.second || !start_frames(model_).empty())
      return Status::error("two hands or given objects are not measured; name a scene without");
    scratch_ = make_scratch(model_);
    state_ = make_state(model_);
    return {};
  }
  [[nodiscard]] std::uint64_t ticks() const {
    return static_cast<std::uint64_t>(file_.seconds * model_.settings.rate);
  }
  [[nodiscard]] DeviceFrame frame(std::uint64_t tick_number) const {
    return resample(file_.motion, static_cast<double>(tick_number % ticks()) / model_.settings.rate);
  }
  void run(const DeviceFrame& frame, Recorder* recorder) {
    TickRecord& record = record_;
    scratch_.hash_stages = recorder != nullptr;
    record.output = tick(model_, state_, scratch_, frame);
    if (recorder == nullptr) return;
    record.device = frame;
    take_results(state_, scratch_, record);
    if (!recorder->record(record)) std::abort();
  }

 private:
  const SceneFile& file_;
  Model model_;
  State state_;
  Scratch scratch_;
  TickRecord record_;
};

/// A recording in the place of the last one.
Status open_anew(Recorder& recorder, const std::string& path, const Scene& scene,
                 const RecorderOptions& options) {
  std::filesystem::remove(path);
  return recorder.open(path, scene, options);
}

/// Mean time of a tick [us], not recorded and recorded.
struct TickTime {
  double plain = 0, recorded = 0;
  [[nodiscard]] double cost() const { return 100 * (recorded / plain - 1); }  // [%]
};

// The whole session twice over: every tick is once recorded and once not, in turns that are short against
// anything that changes the processor's speed. The time is that of the tick thread, with what it waits for
// memory because the writer is at work on another core.
Status measure_pass(const SceneFile& file, const std::string& path, Session& session, TickTime& result) {
  constexpr std::uint64_t kTurn = 20;
  double time[2] = {0, 0};  // [us]
  for (int round = 0; round < 2; ++round) {
    Recorder recorder;
    if (Status status = open_anew(recorder, path, file.scene, {}); !status.ok()) return status;
    std::vector<DeviceFrame> frames;
    for (std::uint64_t first = 0; first < session.ticks(); first += kTurn) {
      frames.clear();
      for (std::uint64_t i = 0; i < kTurn; ++i) frames.push_back(session.frame(first + i));
      const bool recorded = (first / kTurn + static_cast<std::uint64_t>(round)) % 2 == 0;
      const double start = thread_microseconds();
      for (const DeviceFrame& frame : frames) session.run(frame, recorded ? &recorder : nullptr);
      time[recorded ? 1 : 0] += thread_microseconds() - start;
    }
    if (Status status = recorder.close(); !status.ok()) return status;
  }
  const auto ticks = static_cast<double>(session.ticks());
  result = {time[0] / ticks, time[1] / ticks};
  return {};
}

// Neighbours on the machine disturb a pass by tenths of a per cent; the median of several stays.
Status measure_time(const SceneFile& file, const std::string& path) {
  Session session(file);
  if (Status status = session.build(); !status.ok()) return status;
  std::vector<TickTime> passes(9);
  for (TickTime& pass : passes)
    if (Status status = measure_pass(file, path, session, pass); !status.ok()) return status;
  std::sort(passes.begin(), passes.end(),
            [](const TickTime& a, const TickTime& b) { return a.cost() < b.cost(); });
  const TickTime& middle = passes[passes.size() / 2];
  std::printf(
      "tick thread: %.2f us per tick, recorded %.2f us: %+.2f %% (median of %zu passes, %.2f to %.2f)\n",
      middle.plain, middle.recorded, middle.cost(), passes.size(), passes.front().cost(),
      passes.back().cost());
  return {};
}

Status measure_size(const SceneFile& file, const std::string& path, std::uint32_t force_interval) {
  std::printf("forces of every %u. tick (0: of none)\n", force_interval);
  for (const auto& [name, compression] :
       {std::pair("none", Compression::none), std::pair("lz4", Compression::lz4),
        std::pair("zstd", Compression::zstd)}) {
    Session session(file);
    if (Status status = session.build(); !status.ok()) return status;
    Recorder recorder;
    RecorderOptions options;
    options.compression = compression;
    options.force_interval = force_interval;
    if (Status status = open_anew(recorder, path, file.scene, options); !status.ok()) return status;
    for (std::uint64_t i = 0; i < session.ticks(); ++i) session.run(session.frame(i), &recorder);
    if (Status status = recorder.close(); !status.ok()) return status;
    const auto bytes = static_cast<double>(std::filesystem::file_size(path));
    std::printf("%-5s %.0f bytes per tick\n", name, bytes / static_cast<double>(session.ticks()));
  }
  return {};
}

// A session of ten seconds again and again, with the ticks' numbers going on.
Status write_long(const std::string& path, double hours) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"triangle", {{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}}, {{0, 1, 2}}}});
  const auto ticks = static_cast<std::uint64_t>(3600 * hours * scene.settings.rate);
  if (ticks == 0) return Status::error("recording_cost: that is less than a tick");
  Recorder recorder;
  if (Status status = recorder.open(path, scene, {}); !status.ok()) return status;
  TickRecord record;
  record.device.kind = InputKind::joint_angles;
  for (std::uint64_t i = 0; i < ticks; ++i) {
    const std::uint64_t phase = i % 10000;
    record.output.tick = i;
    for (std::size_t a = 0; a < kAngleCount; ++a)
      record.device.angle[a] = 1e-4f * static_cast<float>(phase + 17 * a);
    for (std::size_t s = 0; s < 6; ++s)
      record.output.segment[s].force = {1e-3 * static_cast<double>(phase),
                                        1.0 / (1.0 + static_cast<double>(phase)), 1};
    record.state_hash = i * 0x9e3779b97f4a7c15u;
    record.stage_hash.fill(i * 0xbf58476d1ce4e5b9u);
    if (!recorder.record(record)) return recorder.close();
  }
  return recorder.close();
}

Status measure_seeks(const std::string& path) {
  auto start = Clock::now();
  RecordingReader reader;
  if (Status status = reader.open(path); !status.ok()) return status;
  const RecordingInfo& info = reader.info();
  std::printf("%llu ticks, %.2f hours, %.2f GB, %llu chunks; opened in %.0f ms\n",
              static_cast<unsigned long long>(info.ticks), info.seconds / 3600,
              1e-9 * static_cast<double>(info.bytes), static_cast<unsigned long long>(info.chunks),
              1e3 * seconds_since(start));
  std::vector<double> times;
  std::uint64_t number = 12345;
  for (int i = 0; i < 500; ++i) {
    number = number * 6364136223846793005u + 1442695040888963407u;
    const std::uint64_t wanted = (number >> 20) % info.ticks;
    start = Clock::now();
    TickRecord record;
    bool end = false;
    if (Status status = reader.seek(wanted); !status.ok()) return status;
    if (Status status = reader.next(record, end); !status.ok()) return status;
    times.push_back(1e3 * seconds_since(start));
    if (record.output.tick != wanted) return Status::error("seek found another tick");
  }
  std::printf("500 seeks to random ticks: median %.2f ms, 99 %% %.2f ms, longest %.2f ms\n",
              percentile(times, 0.5), percentile(times, 0.99), percentile(times, 1));
  return {};
}

void print_memory(const char* when) {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  std::printf("most memory so far, %s: %.0f MB\n", when, static_cast<double>(usage.ru_maxrss) / 1024);
}

Status measure_long(const std::string& path, double hours) {
  const auto start = Clock::now();
  if (Status status = write_long(path, hours); !status.ok()) return status;
  std::printf("written in %.0f s\n", seconds_since(start));
  print_memory("written");
  if (Status status = measure_seeks(path); !status.ok()) return status;
  print_memory("read");
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 || bench::has_switch(argc, argv))
    return bench::tell_usage("recording_cost cost SCENE.json | long HOURS", argc, argv);
  const std::string command = argv[1];
  const std::string path =
      (std::filesystem::temp_directory_path() / ("lumbrical_cost_" + std::to_string(::getpid()) + ".mcap"))
          .string();
  Status status = Status::error("recording_cost: \"" + command + "\" is neither cost nor long");
  if (command == "cost") {
    SceneFile file;
    status = load_scene_file(argv[2], file);
    if (status.ok()) status = measure_time(file, path);
    for (const std::uint32_t force_interval : {1u, 10u, 0u})
      if (status.ok()) status = measure_size(file, path, force_interval);
  } else if (command == "long") {
    double hours = 0;
    if (!lumbrical::bench::read_number(argv[2], 1000.0, hours))
      return fail("recording_cost: \"" + std::string(argv[2]) + "\" is no number of hours, above 0 to 1000");
    status = measure_long(path, hours);
  }
  std::filesystem::remove(path);
  return status.ok() ? 0 : fail(status.message());
}
