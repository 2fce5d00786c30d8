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
#include "stage_clock.h"

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
  State state;
  Scratch scratch;
  TickRecord record;
  std::int64_t work_ns = 0;  // of its last tick, by work_clock
  StageClock stages;         // of its last tick
};

std::vector<MovingHand> moving(const std::vector<SessionHand>& hands, bool recorded) {
  std::vector<MovingHand> result;
  for (const SessionHand& hand : hands) {
    MovingHand& added =
        result.emplace_back(MovingHand{hand, make_state(hand.model), make_scratch(hand.model), {}, 0, {}});
    added.scratch.hash_stages = recorded;
    added.record.hand = static_cast<std::uint8_t>(result.size() - 1);
  }
  return result;
}

std::span<const ObjectFrame> given_to(const SessionParts& parts) {
  if (parts.given == nullptr) return {};
  return parts.given->frames;
}

// One tick of one hand, its time included.
void tick_hand(const DeviceFrame& frame, const SessionParts& parts, WorldPager& pager, MovingHand& moving) {
  TickRecord& record = moving.record;
  const std::span<const ObjectFrame> given = given_to(parts);
  take_input(frame, given, record);
  pager.hand_at(record.device, record.hand);
  const clockid_t clock = work_clock(moving.hand.model.execution.threads);
  const std::int64_t work_start = parts.paced ? read_clock(clock) : 0;
  moving.stages.microseconds = {};
  moving.stages.begin();
  const std::int64_t start = clock_ns();
  record.output = tick(moving.hand.model, moving.state, moving.scratch, record.device, given);
  record.duration_ns = nanoseconds_between(start, clock_ns());
  if (parts.paced)
    moving.work_ns = std::min<std::int64_t>(read_clock(clock) - work_start, record.duration_ns);
}

// One tick of each hand, that of the device in a step of its loop. False: the session shall end.
bool tick_hands(double time, const SessionParts& parts, WorldPager& pager, std::vector<MovingHand>& all) {
  const auto tick_others = [&](std::size_t from, std::size_t end) {
    for (std::size_t i = from; i < end; ++i)
      tick_hand(resample(all[i].hand.motion, time), parts, pager, all[i]);
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
  step.frame = resample(driven.hand.motion, time);
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

void note_input(const std::vector<MovingHand>& all, TickStart& start) {
  for (const MovingHand& hand : all) {
    const TickRecord& record = hand.record;
    start.frame[record.hand] = record.device;
    start.given[record.hand] = record.given;
    start.given_count[record.hand] = record.given_count;
  }
}

bool by_samples(const std::vector<MovingHand>& hands) {
  return std::any_of(hands.begin(), hands.end(),
                     [](const MovingHand& hand) { return hand.record.output.evaluations > 0; });
}

// False: the recording failed, and the session is to end with it.
bool record_tick(MovingHand& moving, const SessionParts& parts, RunStatistics& statistics) {
  static_cast<void>(
      parts.recorder->record(moving.record, &moving.state));  // what became of it, close() tells
  if (statistics.recording_error.ok()) {
    statistics.recording_error = parts.recorder->failure();
    if (!statistics.recording_error.ok()) fail(statistics.recording_error);
  }
  return statistics.recording_error.ok() || parts.unrecorded;
}

/// A session while it runs.
struct RunningSession {
  const SessionParts& parts;
  std::vector<MovingHand> hands;
  WorldPager pager;  // made before real time, so that its thread has none of that
  RunStatistics statistics{};
  TickStart tick_start{};  // paced: what a late tick is studied from
  Pace pace{};
  std::int64_t end = 0;  // of the tick before
};

// Reads what a world file has near the hands' first places.
void read_first_places(const std::vector<SessionHand>& hands, WorldPager& pager) {
  for (std::size_t hand = 0; hand < hands.size(); ++hand)
    pager.hand_at(resample(hands[hand].motion, hands[hand].motion.samples[0].time), hand);
  pager.catch_up();
}

void enter_pace(const Model& model, RunningSession& session) {
  const auto pageable = model.world ? std::span(model.world->bytes.get(), model.world->byte_count)
                                    : std::span<const std::byte>();
  session.statistics.real_time = enter_real_time(kTickPriority, Pinning::last_processor, pageable);
}

void start_device(RunningSession& session) {
  MovingHand& driven = session.hands[session.parts.device_hand];
  const Motion& motion = driven.hand.motion;
  const DeviceFrame frame = resample(motion, motion.samples[0].time);
  session.statistics.interrupted =
      !session.parts.device->loop().start(driven.hand.model, driven.scratch, frame);
}

/// [ns] by the clock: when a tick was due, by how much the one before had passed that, since when this one
/// could have begun, and when it did.
struct TickMoment {
  std::int64_t due = 0, behind = 0, waiting = 0, start = 0;
};

TickMoment wait_for_tick(std::uint64_t number, RunningSession& session) {
  TickMoment at;
  at.due = moment_of(session.pace, number);
  at.behind = std::max<std::int64_t>(0, session.end - at.due);
  at.waiting = std::max(at.due, clock_ns());  // later, where the tick before is being kept
  if (session.parts.paced) {
    sleep_until_ns(at.due);
    session.statistics.wake_ups.add(nanoseconds_between(at.waiting, clock_ns()));
    note_state(session.hands, session.tick_start);
  }
  at.start = clock_ns();
  return at;
}

void note_stages(RunningSession& session) {
  for (std::size_t i = 0; i < kStageCount; ++i) {
    double microseconds = 0;
    for (const MovingHand& hand : session.hands) microseconds += hand.stages.microseconds[i];
    session.statistics.stage_times[i].add(nanoseconds_between(0, std::llround(1e3 * microseconds)));
    session.statistics.stage_sums[i] += microseconds;
  }
}

void note_times(std::uint64_t number, const TickMoment& at, RunningSession& session) {
  const bool paced = session.parts.paced;
  const std::int64_t end = session.end = clock_ns(), period = period_of(session.pace);
  RunStatistics& statistics = session.statistics;
  std::uint32_t duration = 0;
  std::int64_t work = 0;
  for (const MovingHand& hand : session.hands) {
    duration += hand.record.duration_ns;
    work += hand.work_ns;
  }
  statistics.tick_times.add(duration);
  const bool late = paced && end > at.due + period;
  statistics.deadline_misses += late ? 1 : 0;
  if (paced) note_input(session.hands, session.tick_start);
  if (paced && by_samples(session.hands)) statistics.slowest_by_samples.add(work, session.tick_start);
  if (late) {
    const std::int64_t woken = at.start - at.waiting, beside = end - at.due - at.behind - woken - duration;
    statistics.late.add({at.behind, woken + duration - work, work, beside}, session.tick_start);
  }
  if (session.parts.device == nullptr) return;
  statistics.loop_times.add(nanoseconds_between(at.start, end));
  if (paced) forgive_late(number, end, session.pace);
}

// False: the recording failed, and the session is to end with it.
bool keep_results(RunningSession& session) {
  RunStatistics& statistics = session.statistics;
  const bool is_kept = session.parts.recorder != nullptr || session.parts.view != nullptr;
  for (MovingHand& hand : session.hands) {
    if (is_kept) take_results(hand.state, hand.scratch, hand.record);
    add_evaluations(hand.record, statistics);
    add_output(hand.record.output, hand.state, statistics.ticks, statistics.hands[hand.record.hand]);
    note_objects(hand.hand.model, hand.scratch.object_output, statistics.objects);
    if (session.parts.view != nullptr) session.parts.view->put(hand.record);
  }
  statistics.world_held = std::max(statistics.world_held, session.pager.held_bytes());
  ++statistics.ticks;
  bool kept = true;
  for (MovingHand& hand : session.hands)
    if (session.parts.recorder != nullptr) kept = kept && record_tick(hand, session.parts, statistics);
  return kept;
}

// What is given to the next tick.
void move_given_objects(std::uint64_t next, RunningSession& session) {
  if (session.parts.given == nullptr) return;
  for (MovingHand& hand : session.hands) push_given(hand.hand.model, hand.scratch, *session.parts.given);
  const Model& model = session.hands.front().hand.model;
  move_given(static_cast<double>(next) / model.settings.rate, model, *session.parts.given);
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
  const Model& model = hands[0].model;
  const double rate = model.settings.rate;
  RunningSession session{parts, moving(hands, parts.recorder != nullptr), WorldPager(model, {})};
  for (MovingHand& hand : session.hands)
    if (parts.stages) set_watch({&StageClock::ended, &hand.stages}, hand.scratch);
  RunStatistics& statistics = session.statistics;
  statistics.hands.resize(hands.size());
  std::optional<Progress> progress;
  if (!parts.silent && parts.device == nullptr) progress.emplace("running");
  read_first_places(hands, session.pager);
  if (parts.paced) enter_pace(model, session);
  if (parts.device != nullptr) start_device(session);
  if (parts.paced) {
    note_state(session.hands, session.tick_start);
    statistics.late.slowest.reserve(session.tick_start);
    statistics.slowest_by_samples.reserve(session.tick_start);
  }
  const std::uint64_t faults_before = page_faults();
  session.pace = start_pace(rate);
  const std::int64_t begin = session.end = session.pace.first;
  bool stopped = false;
  for (std::uint64_t i = 0; i < ticks && !statistics.interrupted && !stopped; ++i) {
    const TickMoment at = wait_for_tick(i, session);
    stopped = !tick_hands(static_cast<double>(i) / rate, parts, session.pager, session.hands);
    if (session.pager.changed()) {  // neither device nor recording learn of this tick
      statistics.world_error = session.pager.failure();
      break;
    }
    move_given_objects(i + 1, session);
    note_times(i, at, session);
    if (parts.stages) note_stages(session);
    if (!keep_results(session)) break;
    if (progress) progress->update(i + 1, ticks);
    statistics.interrupted = stop_requested();
  }
  statistics.page_faults = page_faults() - faults_before;
  statistics.wall_seconds = static_cast<double>(clock_ns() - begin) * 1e-9;
  // Without its priority this thread may wait for longer than a tick may be late: that would be a fault.
  if (parts.device != nullptr) parts.device->close();
  leave_real_time(statistics.real_time);
  return statistics;
}

}  // namespace lumbrical::tool
