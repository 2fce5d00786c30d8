// "What if": the recorded hand meets a changed scene, and the forces are held against the recorded ones.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <new>
#include <optional>

#include "base/check_stop.h"
#include "lumbrical/recording.h"
#include "recording/record_fields.h"
#include "recording/replay.h"
#include "recording/session_message.h"

namespace lumbrical {
namespace {

// Smallest force difference people notice: 7 % (to 10 %) of a force, 15 % to 27 % of one below 0.5 N. The
// floor gives 15 % at 0.23 N and 27 % at 0.13 N.
constexpr double kWeber = 0.07, kWeberFloor = 0.5;  // [N]

/// One quantity over the ticks: largest, and sum of squares.
struct Sum {
  Change change;
  void add(double value, std::uint64_t tick) {
    change.rms += value * value;
    if (!(value > change.max)) return;
    change.max = value;
    change.max_tick = tick;
  }
  [[nodiscard]] Change over(std::uint64_t ticks) const {
    Change result = change;
    result.rms = std::sqrt(change.rms / static_cast<double>(ticks));
    return result;
  }
};

/// A finger's three segments, or the palm.
Vec3 force_of(const ActuatorFrame& output, int part) {
  if (part == kFingerCount) return output.segment[kPalmSegment].force;
  const auto first = static_cast<std::size_t>(3 * part);
  return output.segment[first].force + output.segment[first + 1].force + output.segment[first + 2].force;
}

/// A scene being run, timed.
struct TimedRun {
  Model model;
  State state;
  Scratch scratch;
  double seconds = 0, last = 0;  // of all ticks, and of the last one

  Status build(const Scene& scene, const Execution& execution) {
    Status status = build_model(scene, execution, model);
    if (status.ok()) scratch = make_scratch(model);
    return status;
  }
  ActuatorFrame run(const TickRecord& recorded) {
    const auto start = std::chrono::steady_clock::now();
    const ActuatorFrame output = tick(model, state, scratch, recorded.device, given_of(recorded));
    last = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    seconds += last;
    return output;
  }
};

// The changed session as a recording of its own.
Status open_record(const RecordingReader& reader, const Model& changed, const std::string& path,
                   Recorder& recorder) {
  const RecordingInfo& info = reader.info();
  if (info.first_tick > 0 || info.missing_ticks > 0)
    return Status::error(info.path + ": begins at tick " + std::to_string(info.first_tick) + " and lacks " +
                         std::to_string(info.missing_ticks) + "; what if is recorded of whole sessions only");
  RecorderOptions options;
  options.metadata["what_if_of"] = std::filesystem::path(info.path).filename().string();
  return recorder.open(path, scene_of(changed), options);
}

TickRecord record_of(const TickRecord& recorded, const ActuatorFrame& output, const TimedRun& run) {
  TickRecord record;
  take_input(recorded.device, given_of(recorded), record);
  record.output = output;
  record.duration_ns = static_cast<std::uint32_t>(std::min(1e9 * run.last, 4e9));
  take_results(run.state, run.scratch, record);
  return record;
}

class WhatIf {
 public:
  // What finish() has not closed is a part of the session that would pass for all of it.
  ~WhatIf() {
    if (recorder_) recorder_->discard();
  }

  Status build(RecordingReader& reader, const ReplayOptions& options) {
    Scene scene;
    if (Status status = scene_for(reader, options, scene); !status.ok()) return status;
    Execution plain = options.execution;
    plain.broadphase = Execution{}.broadphase;
    Status status = changed_.build(scene, options.execution);
    if (status.ok()) status = baseline_.build(reader.scene(), plain);
    if (status.ok()) {
      changed_.state = reader.initial_state(changed_.model);
      baseline_.state = reader.initial_state(baseline_.model);
    }
    if (!status.ok()) return Status::error(reader.info().path + ": " + status.message());
    if (options.record.empty()) return {};
    return open_record(reader, changed_.model, options.record, recorder_.emplace());
  }

  [[nodiscard]] std::uint64_t next_tick() const { return changed_.state.tick; }

  void add(const TickRecord& recorded) {
    // Whichever goes first finds cold caches; they take turns.
    const bool baseline_first = recorded.output.tick % 2 == 0;
    ActuatorFrame before;
    if (baseline_first) before = baseline_.run(recorded);
    const ActuatorFrame changed = changed_.run(recorded);
    if (recorder_) recorder_->record(record_of(recorded, changed, changed_), &changed_.state);
    if (!baseline_first) before = baseline_.run(recorded);
    constexpr auto kLimits = static_cast<std::size_t>(Stage::limits);
    if (recorded.has_forces) {
      before = recorded.output;
    } else if (baseline_.scratch.stage_hash[kLimits] != recorded.stage_hash[kLimits]) {
      ++unlike_recorded_;
    }
    compare(before, changed);
    recorded_seconds_ += 1e-9 * recorded.duration_ns;
    ++ticks_;
  }

  Status finish(const ReplayOptions& options, WhatIfResult& result) {
    result.ticks = ticks_;
    result.unlike_recorded = unlike_recorded_;
    for (const World::Object& object : all_objects(changed_.model))
      if (options.mesh.count(object.name) > 0) result.replaced.push_back(object);
    const double per = 1 / static_cast<double>(ticks_);
    for (std::size_t p = 0; p < force_.size(); ++p) {
      result.force[p] = force_[p].over(ticks_);
      result.force_jnd[p] = force_jnd_[p].over(ticks_);
    }
    result.felt_ticks = felt_;
    for (std::size_t s = 0; s < kSegmentCount; ++s) result.torque[s] = torque_[s].over(ticks_);
    result.recorded_time = recorded_seconds_ * per;
    result.baseline_time = baseline_.seconds * per;
    result.changed_time = changed_.seconds * per;
    return recorder_ ? recorder_->close() : Status();
  }

 private:
  void compare(const ActuatorFrame& before, const ActuatorFrame& changed) {
    const std::uint64_t number = before.tick;
    for (int part = 0; part <= kFingerCount; ++part) {
      const auto p = static_cast<std::size_t>(part);
      const Vec3 force = force_of(before, part);
      const double difference = norm(force_of(changed, part) - force);
      const double noticeable = kWeber * max(norm(force), kWeberFloor);
      force_[p].add(difference, number);
      force_jnd_[p].add(difference / noticeable, number);
      felt_[p] += difference > noticeable ? 1 : 0;
    }
    for (std::size_t s = 0; s < kSegmentCount; ++s)
      torque_[s].add(norm(changed.joint_torque[s] - before.joint_torque[s]), number);
  }

  TimedRun changed_, baseline_;
  std::optional<Recorder> recorder_;
  double recorded_seconds_ = 0;
  std::uint64_t ticks_ = 0, unlike_recorded_ = 0;
  std::array<Sum, kFingerCount + 1> force_, force_jnd_;
  std::array<std::uint64_t, kFingerCount + 1> felt_{};
  std::array<Sum, kSegmentCount> torque_;
};

}  // namespace

Status what_if(RecordingReader& reader, const ReplayOptions& options, WhatIfResult& result) try {
  result = {};
  WhatIf comparison;
  if (Status status = comparison.build(reader, options); !status.ok()) return status;
  if (Status status = reader.seek(0); !status.ok()) return status;
  if (reader.info().ticks == 0)
    return Status::error(reader.info().path + ": the recording holds no tick; there is nothing to replay");
  TickRecord recorded;
  for (std::uint64_t done = 0;; ++done) {
    bool end = false;
    if (Status status = check_stop(options.stop); !status.ok()) return status;
    if (Status status = reader.next(recorded, end); !status.ok()) return status;
    if (end) break;
    if (recorded.output.tick != comparison.next_tick())
      return missing_tick(reader, comparison.next_tick(), recorded.output.tick);
    comparison.add(recorded);
    if (options.progress && done % kProgressInterval == 0) options.progress(done, reader.info().ticks);
  }
  return comparison.finish(options, result);
} catch (const std::bad_alloc&) {
  return Status::error(reader.info().path + ": not enough memory to replay the recording");
}

}  // namespace lumbrical
