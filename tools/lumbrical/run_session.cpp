// See run_session.h.
#include "run_session.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "lumbrical/tick.h"
#include "lumbrical/ways_out.h"
#include "lumbrical/world.h"

namespace lumbrical::tool {
namespace {

// Above ordinary work, below the kernel's own threads for clocks and migration.
constexpr int kTickPriority = 80;

std::uint32_t nanoseconds_between(std::int64_t start, std::int64_t end) {
  constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max();
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(end - start, 0, kMost));
}

// Of the calling thread so far, minor and major.
std::uint64_t page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_minflt) + static_cast<std::uint64_t>(usage.ru_majflt);
}

void add_output(const ActuatorFrame& output, const State& state, std::uint64_t ticks, HandFigures& figures) {
  const bool starting = figures.starting_ticks == ticks;
  if (starting && state.rise > 0 && (output.flags & kFading) != 0) ++figures.starting_ticks;
  figures.contacts += output.contact_count;
  figures.max_contacts = std::max(figures.max_contacts, output.contact_count);
  for (std::size_t finger = 0; finger < kFingerCount; ++finger) {
    Vec3 force;
    for (std::size_t s = 3 * finger; s < 3 * finger + 3; ++s) force += output.segment[s].force;
    figures.peak_force[finger] = std::max(figures.peak_force[finger], norm(force));
  }
  double& palm = figures.peak_force[kFingerCount];
  palm = std::max(palm, norm(output.segment[kPalmSegment].force));
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    figures.peak_segment[s] = std::max(figures.peak_segment[s], norm(output.segment[s].force));
    figures.peak_torque[s] = std::max(figures.peak_torque[s], norm(output.joint_torque[s]));
  }
  for (std::size_t bit = 0; bit < figures.flag_ticks.size(); ++bit) {
    figures.flag_ticks[bit] += (output.flags >> bit) & 1u;
  }
}

void add_evaluations(const TickRecord& record, RunStatistics& statistics) {
  statistics.max_evaluations = std::max<std::uint64_t>(statistics.max_evaluations, record.output.evaluations);
  if (record.output.evaluations == 0) return;
  statistics.evaluations += static_cast<double>(record.output.evaluations);
  statistics.evaluating_ns += record.duration_ns;
}

// What a hand carries from tick to tick.
struct MovingHand {
  const SessionHand& hand;
  bool still;  // a single pose is held for the whole session
  State state;
  Scratch scratch;
  TickRecord record;
};

std::vector<MovingHand> moving(const std::vector<SessionHand>& hands, bool recorded) {
  std::vector<MovingHand> result;
  for (const SessionHand& hand : hands) {
    MovingHand& added = result.emplace_back(MovingHand{
        hand, hand.motion.samples.size() == 1, make_state(hand.model), make_scratch(hand.model), {}});
    added.scratch.hash_stages = recorded;
    added.record.hand = static_cast<std::uint8_t>(result.size() - 1);
  }
  return result;
}

std::span<const ObjectFrame> given_to(const SessionParts& parts) {
  if (parts.given == nullptr) return {};
  return parts.given->frames;
}

DeviceFrame frame_at(double time, const MovingHand& moving) {
  const Motion& motion = moving.hand.motion;
  return resample(motion, moving.still ? motion.samples[0].time : time);
}

// One tick of one hand, its time included.
void tick_hand(const DeviceFrame& frame, const SessionParts& parts, WorldPager& pager, MovingHand& moving) {
  TickRecord& record = moving.record;
  record.device = frame;
  pager.hand_at(record.device, record.hand);
  const std::span<const ObjectFrame> given = given_to(parts);
  record.given_count = static_cast<std::uint32_t>(given.size());
  std::copy(given.begin(), given.end(), record.given.begin());
  const std::int64_t start = clock_ns();
  record.output = tick(moving.hand.model, moving.state, moving.scratch, record.device, given);
  record.duration_ns = nanoseconds_between(start, clock_ns());
  take_objects(moving.scratch, record);
}

// One tick of each hand, that of the device in a step of its loop. False: the session shall end.
bool tick_hands(double time, const SessionParts& parts, WorldPager& pager, std::vector<MovingHand>& all) {
  const auto tick_others = [&](std::size_t from, std::size_t end) {
    for (std::size_t i = from; i < end; ++i) tick_hand(frame_at(time, all[i]), parts, pager, all[i]);
  };
  if (parts.device == nullptr) {
    tick_others(0, all.size());
    return true;
  }
  tick_others(0, parts.device_hand);
  MovingHand& driven = all[parts.device_hand];
  const auto feel = [&](LoopStep& step) {
    tick_hand(step.frame, parts, pager, driven);
    tick_others(parts.device_hand + 1, all.size());
    step.output = driven.record.output;
    return !pager.changed();
  };
  LoopStep step;
  step.frame = frame_at(time, driven);
  const bool goes_on = parts.device->loop().step(driven.hand.model, driven.scratch, feel, step);
  parts.device->note(step);
  driven.record.sent_count = step.sent_count;
  driven.record.sent = step.sent;
  driven.record.timing = step.news;
  return goes_on;
}

void note_state(const std::vector<MovingHand>& all, TickStart& start) {
  for (const MovingHand& hand : all) start.state[hand.record.hand] = hand.state;
}

void note_frame(const std::vector<MovingHand>& all, TickStart& start) {
  for (const MovingHand& hand : all) start.frame[hand.record.hand] = hand.record.device;
}

// False: the recording failed, and the session is to end with it.
bool record_tick(MovingHand& moving, const SessionParts& parts, RunStatistics& statistics) {
  moving.record.stage_hash = moving.scratch.stage_hash;
  moving.record.state_hash = hash_state(moving.state);
  static_cast<void>(
      parts.recorder->record(moving.record, &moving.state));  // what became of it, close() tells
  if (statistics.recording_error.ok()) {
    statistics.recording_error = parts.recorder->failure();
    if (!statistics.recording_error.ok()) fail(statistics.recording_error);
  }
  return statistics.recording_error.ok() || parts.unrecorded;
}

}  // namespace

bool measure_device(const SessionHand& hand, double seconds, DeviceSession& device) {
  Scratch scratch = make_scratch(hand.model);
  scratch.hash_stages = false;
  const DeviceFrame frame = resample(hand.motion, hand.motion.samples[0].time);
  return device.loop().measure(hand.model, scratch, frame, seconds);
}

RunStatistics run_session(const std::vector<SessionHand>& hands, std::uint64_t ticks,
                          const SessionParts& parts) {
  RunStatistics statistics;
  statistics.hands.resize(hands.size());
  std::vector<MovingHand> all = moving(hands, parts.recorder != nullptr);
  const Model& model = hands[0].model;
  const double rate = model.settings.rate;
  std::optional<Progress> progress;
  if (!parts.silent && parts.device == nullptr) progress.emplace("running");
  WorldPager pager(model, {});  // before real time, so that its thread has none of that
  for (std::size_t hand = 0; hand < hands.size(); ++hand)
    pager.hand_at(resample(hands[hand].motion, hands[hand].motion.samples[0].time), hand);
  pager.catch_up();
  if (parts.paced) {
    const auto pageable = model.world ? std::span(model.world->bytes.get(), model.world->byte_count)
                                      : std::span<const std::byte>();
    statistics.real_time = enter_real_time(kTickPriority, Pinning::last_processor, pageable);
  }
  if (parts.device != nullptr) {
    MovingHand& driven = all[parts.device_hand];
    const Motion& motion = driven.hand.motion;
    const DeviceFrame frame = resample(motion, motion.samples[0].time);
    statistics.interrupted = !parts.device->loop().start(driven.hand.model, driven.scratch, frame);
  }
  TickStart tick_start;
  if (parts.paced) {
    note_state(all, tick_start);
    statistics.late.reserve(tick_start);
  }
  const std::uint64_t faults_before = page_faults();
  Pace pace = start_pace(rate);
  const std::int64_t begin = pace.first, period = period_of(pace);
  std::int64_t end = begin;  // of the tick before
  bool stopped = false;

  for (std::uint64_t i = 0; i < ticks && !statistics.interrupted && !stopped; ++i) {
    const std::int64_t moment = moment_of(pace, i);
    const std::int64_t behind = std::max<std::int64_t>(0, end - moment);
    const std::int64_t waiting = std::max(moment, clock_ns());  // later, where the tick before is being kept
    if (parts.paced) {
      sleep_until_ns(moment);
      statistics.wake_ups.add(nanoseconds_between(waiting, clock_ns()));
      note_state(all, tick_start);
    }
    const std::int64_t start = clock_ns();
    stopped = !tick_hands(static_cast<double>(i) / rate, parts, pager, all);
    if (pager.changed()) {  // neither device nor recording learn of this tick
      statistics.world_error = pager.failure();
      break;
    }
    if (parts.given != nullptr) {
      for (const MovingHand& hand : all) push_given(hand.scratch, *parts.given);
      move_given(static_cast<double>(i + 1) / rate, 1 / rate, *parts.given);
    }
    std::uint32_t duration = 0;
    for (const MovingHand& hand : all) duration += hand.record.duration_ns;

    end = clock_ns();
    const bool late = parts.paced ? end > moment + period : duration > period;
    statistics.deadline_misses += late ? 1 : 0;
    if (late && parts.paced) {
      note_frame(all, tick_start);
      statistics.late.add(
          {behind, start - waiting, duration, end - moment - behind - (start - waiting) - duration},
          tick_start);
    }
    if (parts.device != nullptr) {
      statistics.loop_times.add(nanoseconds_between(start, end));
      if (parts.paced) forgive_late(i, end, pace);
    }
    statistics.tick_times.add(duration);
    for (MovingHand& hand : all) {
      add_evaluations(hand.record, statistics);
      add_output(hand.record.output, hand.state, statistics.ticks, statistics.hands[hand.record.hand]);
      if (parts.view != nullptr) parts.view->put(hand.record);
    }
    statistics.world_held = std::max(statistics.world_held, pager.held_bytes());
    ++statistics.ticks;
    bool recorded = true;
    for (MovingHand& hand : all)
      if (parts.recorder != nullptr) recorded = recorded && record_tick(hand, parts, statistics);
    if (!recorded) break;
    if (progress) progress->update(i + 1, ticks);
    statistics.interrupted = stop_requested();
  }
  statistics.page_faults = page_faults() - faults_before;
  statistics.wall_seconds = static_cast<double>(clock_ns() - begin) * 1e-9;
  leave_real_time(statistics.real_time);
  return statistics;
}

}  // namespace lumbrical::tool
