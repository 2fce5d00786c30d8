// The recorder: the tick thread puts records into a ring, a writer thread encodes, compresses and writes
// them.
#include "recording/recorder.h"

#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <optional>
#include <thread>
#include <utility>

#include "base/ring.h"
#include "base/thread_signals.h"
#include "flatbuffers/flatbuffers.h"
#include "lumbrical/recording.h"
#include "model/ranges.h"
#include "recording/hand_views.h"
#include "recording/record_fields.h"
#include "recording/scene_views.h"
#include "recording/session_message.h"
#include "recording/state_message.h"
#include "recording/tick_message.h"

namespace lumbrical {
namespace {

using namespace std::chrono_literals;

// The writer looks for ticks at this interval instead of being woken, which would cost the tick thread a
// system call per tick. 2 ms are a few ticks, where the ring holds thousands.
constexpr auto kWriterNap = 2ms;
constexpr auto kFullRingNap = 200us;
// A live session's chunk is open no longer than that by the clock, however slowly ticks come: with the
// writer's nap less than the 0.25 s that a killed process may lose.
constexpr auto kLongestOpen = 240ms;
constexpr std::uint32_t kLargestRing = 1u << 18;

// Ticks between the states that are kept, and how many may wait for the writer.
constexpr std::uint64_t kStateInterval = 250;
constexpr std::uint32_t kStateRing = 16;

// Forks between the process that loaded the library and this one. Counted, since asking for the process's
// number would cost the tick thread a system call per tick.
std::atomic<std::uint64_t> forks{0};

std::uint64_t fork_count() noexcept {
  static const int refused =
      ::pthread_atfork(nullptr, nullptr, [] { forks.fetch_add(1, std::memory_order_relaxed); });
  static_cast<void>(refused);  // for want of memory: then children are taken for their parent
  return forks.load(std::memory_order_relaxed);
}

/// A state and whose it is.
struct KeptState {
  State state;
  std::uint8_t hand = 0;
};

bool is_due(std::uint32_t interval, std::uint64_t tick) { return interval > 0 && tick % interval == 0; }

bool reaches_back(const State& state) { return !state.objects.empty() || state.proxy.has_value(); }

// All of a record but the empty places of its lists, which are most of it.
void copy_record(const TickRecord& from, TickRecord& to) {
  to.device = from.device;
  to.output = from.output;
  to.stage_hash = from.stage_hash;
  to.state_hash = from.state_hash;
  to.duration_ns = from.duration_ns;
  to.has_forces = from.has_forces;
  to.hand = from.hand;
  to.timing = from.timing;
  to.sent_count = std::min(from.sent_count, kMaxSentPerTick);
  to.given_count = std::min<std::uint32_t>(from.given_count, kMostObjects);
  to.object_count = std::min<std::uint32_t>(from.object_count, kMostObjects);
  std::copy_n(from.sent.begin(), to.sent_count, to.sent.begin());
  std::copy_n(from.given.begin(), to.given_count, to.given.begin());
  std::copy_n(from.object.begin(), to.object_count, to.object.begin());
}

Status check_options(const Scene& scene, const RecorderOptions& options) {
  if (!(options.chunk_seconds > 0 && options.chunk_seconds <= 0.25))
    return Status::error("chunk_seconds is out of range; choose more than 0 and at most 0.25");
  if (!(options.sync_seconds > 0 && options.sync_seconds <= 3600))
    return Status::error("sync_seconds is out of range; choose more than 0 and at most 3600");
  if (options.ring_capacity < 1 || options.ring_capacity > kLargestRing)
    return Status::error("ring_capacity is out of range; choose 1 to " + std::to_string(kLargestRing) +
                         " ticks");
  if (!range::rate.holds(scene.settings.rate))
    return Status::error("the scene's rate is out of range; choose " + text_of(range::rate));
  const bool views = options.pose_interval > 0 || options.contact_interval > 0 || options.scene_interval > 0;
  if (views && options.models.size() != (options.second_hand ? 2u : 1u))
    return Status::error("posed hands, contact points and scenes take the models of all hands");
  if (options.contact_interval > 0 && scene.world)
    return Status::error("contact points of a world file can't be recorded; leave them out");
  if (options.scene_interval > 0)
    if (Status status = check_drawable(scene); !status.ok()) return status;
  if (options.second_hand && options.second_hand->side == scene.hand.side)
    return Status::error("both hands are " + std::string(side_name(scene.hand.side)) +
                         " ones; a session of two has a left and a right one");
  if (options.second_hand)
    if (Status status = check_hand(*options.second_hand); !status.ok()) return status;
  return check_hand(scene.hand);
}

std::vector<MessageKind> views_of(const RecorderOptions& options) {
  return views_that([&options](MessageKind kind) {
    if (kind == MessageKind::pose) return options.pose_interval > 0;
    return kind == MessageKind::contacts ? options.contact_interval > 0 : options.scene_interval > 0;
  });
}

std::map<std::string, std::string> metadata_of(const RecorderOptions& options) {
  std::map<std::string, std::string> metadata = options.metadata;
  metadata.emplace("build", build_text());
  metadata.emplace("arithmetic", arithmetic_version());
  if (options.force_interval != 1) metadata.emplace("force_interval", std::to_string(options.force_interval));
  for (const auto& [name, interval] : {std::pair("pose_interval", options.pose_interval),
                                       std::pair("contact_interval", options.contact_interval),
                                       std::pair("scene_interval", options.scene_interval)})
    if (interval > 0) metadata.emplace(name, std::to_string(interval));
  return metadata;
}

McapWriterOptions mcap_options_of(const RecorderOptions& options) {
  McapWriterOptions result;
  result.compression = options.compression;
  result.chunk_time = static_cast<std::uint64_t>(options.chunk_seconds * 1e9);
  return result;
}

}  // namespace

Status open_recording(const std::string& path, double rate, const std::vector<std::uint8_t>& session,
                      const StateMessages& states, const std::map<std::string, std::string>& metadata,
                      McapWriterOptions options, McapWriter& writer,
                      const std::vector<RecordingChannel>& channels) {
  options.period = tick_time(1, 1e9 / rate);
  McapWriter::Start start;
  start.library = "lumbrical";
  options.last_channel = 0;
  while (options.last_channel + 1 < channels.size() &&
         channels[options.last_channel + 1].kind == MessageKind::tick)
    ++options.last_channel;
  for (const RecordingChannel& channel : channels) start.channels.push_back(start_of(channel));
  start.attachments.push_back({kSessionAttachment, session});
  for (std::size_t hand = 0; hand < states.size(); ++hand)
    if (!states[hand].empty()) start.attachments.push_back({kStateAttachments[hand], states[hand]});
  start.metadata_name = kMetadataName;
  start.metadata = &metadata;
  Status status = writer.open(path, options, start);
  if (!status.ok()) writer.discard();
  return status;
}

struct Recorder::Writer {
  Writer(const std::string& path, const Scene& scene, const RecorderOptions& options);

  Status start(const std::string& path);
  void run();
  void run_syncs();
  Status write_waiting();
  void fail(Status error);
  void stop();
  Status write(const TickRecord& record);
  Status write_views(const TickRecord& record, const State* after);
  [[nodiscard]] const State* state_after(const TickRecord& record);
  template <class T>
  T* place_in(Ring<T>& of) noexcept;
  Status flush_in_time();
  [[nodiscard]] bool is_parents() const noexcept {
    return forks.load(std::memory_order_relaxed) != opened_in;
  }
  [[nodiscard]] bool is_drawn(std::uint64_t tick) const {
    return is_due(pose_interval, tick) || is_due(contact_interval, tick) || is_due(scene_interval, tick);
  }
  [[nodiscard]] bool keeps_forces(const TickRecord& record) const {
    return record.has_forces && is_due(force_interval, record.output.tick);
  }

  Ring<TickRecord> ring;
  Ring<KeptState> states{kStateRing};  // of ticks in `ring`, put there first
  double period;                       // [ns]
  bool wait_when_full;
  std::uint32_t force_interval;
  std::chrono::duration<double> sync_interval;
  std::vector<Side> sides;  // of the hands
  std::vector<RecordingChannel> channels;
  std::uint32_t pose_interval, contact_interval, scene_interval;
  std::vector<HandViewer> viewers;                                 // of the hands, where there is an interval
  std::vector<std::uint8_t> objects;                               // their message, before the first tick
  std::array<std::optional<std::uint64_t>, kMostHands> last_tick;  // handed over; the tick thread's own

  const std::uint64_t opened_in = fork_count();  // elsewhere the file is another process's

  McapWriter mcap;  // the writer thread's own, from open() until it has ended; but for its sync()
  flatbuffers::FlatBufferBuilder builder{4096};
  std::chrono::steady_clock::time_point opened;  // of the open chunk

  std::mutex mutex;    // of `first_error` until `failed`, and of `ended`
  Status first_error;  // that ended the recording
  // Put down in open(), as there may be no memory for it later; each thread's own.
  std::array<Status, 2> out_of_memory;
  std::atomic<bool> closing{false};
  std::atomic<bool> failed{false};
  bool ended = false;
  std::condition_variable end;
  // A disk may take seconds to write all it was given, and the ring may not hold that many ticks: so the
  // writer goes on meanwhile.
  std::thread thread, syncs;
};

Recorder::Writer::Writer(const std::string& path, const Scene& scene, const RecorderOptions& options)
    : ring(options.ring_capacity),
      period(1e9 / scene.settings.rate),
      wait_when_full(options.wait_when_full),
      force_interval(options.force_interval),
      sync_interval(options.sync_seconds),
      sides{scene.hand.side},
      pose_interval(options.pose_interval),
      contact_interval(options.contact_interval),
      scene_interval(options.scene_interval) {
  if (options.second_hand) sides.push_back(options.second_hand->side);
  channels = channels_of(sides, views_of(options));
  if (channels.size() > sides.size())
    for (const Model* const model : options.models) viewers.emplace_back(*model);
  if (scene_interval > 0 && !scene.objects.empty()) {
    draw_objects(scene, 0, builder);
    objects.assign(builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize());
    builder.Reset();  // gives back the room
  }
  out_of_memory.fill(Status::error(path + ": not enough memory to go on recording; end other programs"));
}

Status Recorder::Writer::start(const std::string& path) try {
  thread = std::thread([this] {
    leave_signals_to_others();
    run();
  });
  syncs = std::thread([this] {
    leave_signals_to_others();
    run_syncs();
  });
  return {};
} catch (const std::exception&) {  // no thread, or no memory for one; the first may run
  stop();
  return Status::error(path + ": no thread for the recorder; the system has reached its limit");
}

// Of two errors the first is told.
void Recorder::Writer::fail(Status error) {
  const std::lock_guard lock(mutex);
  if (failed.load(std::memory_order_relaxed)) return;
  first_error = std::move(error);
  failed.store(true, std::memory_order_release);
}

void Recorder::Writer::stop() {
  closing.store(true, std::memory_order_release);
  if (thread.joinable()) thread.join();
  {
    const std::lock_guard lock(mutex);
    ended = true;
  }
  end.notify_all();
  if (syncs.joinable()) syncs.join();
}

// Before their tick, which ends the chunk.
Status Recorder::Writer::write_views(const TickRecord& record, const State* after) {
  const std::uint64_t tick = record.output.tick, time = tick_time(tick, period);
  const auto put_bytes = [&](MessageKind kind, std::span<const std::uint8_t> bytes) {
    return mcap.message(time, static_cast<std::uint32_t>(tick), bytes,
                        channel_number(channels, sides, kind, record.hand));
  };
  const auto put = [&](MessageKind kind) {
    return put_bytes(kind, {builder.GetBufferPointer(), builder.GetSize()});
  };
  if (record.hand == 0 && !objects.empty()) {
    if (Status status = put_bytes(MessageKind::objects, objects); !status.ok()) return status;
    std::vector<std::uint8_t>().swap(objects);
  }
  if (!is_drawn(tick)) return {};
  HandViewer& viewer = viewers[record.hand];
  if (!viewer.place(record, after)) return {};
  if (is_due(pose_interval, tick) && viewer.pose(time, builder))
    if (Status status = put(MessageKind::pose); !status.ok()) return status;
  if (is_due(contact_interval, tick)) {
    viewer.contacts(time, builder);
    if (Status status = put(MessageKind::contacts); !status.ok()) return status;
  }
  if (!is_due(scene_interval, tick)) return {};
  if (record.hand == 0 && record.object_count > 0) {
    draw_transforms(record, time, builder);
    if (Status status = put(MessageKind::transforms); !status.ok()) return status;
  }
  viewer.scene(record.output, time, builder);
  return put(MessageKind::scene);
}

// That was kept of this tick, if one was; until it is popped.
const State* Recorder::Writer::state_after(const TickRecord& record) {
  const KeptState* const kept = states.front();
  const bool is_of_it =
      kept != nullptr && kept->hand == record.hand && kept->state.tick == record.output.tick + 1;
  return is_of_it ? &kept->state : nullptr;
}

Status Recorder::Writer::write(const TickRecord& record) {
  const std::uint64_t tick = record.output.tick;
  const State* const after = state_after(record);
  Status status = write_views(record, after);
  if (!status.ok()) return status;
  const bool keeps_state = after != nullptr && tick % kStateInterval == 0;
  encode_tick(record, keeps_forces(record), input_check_of(record), builder,
              keeps_state ? encode_state(*after) : std::vector<std::uint8_t>{});
  if (after != nullptr) states.pop();
  // The sequence number is the tick's, so that any MCAP tool shows a gap as a gap.
  return mcap.message(tick_time(tick, period), static_cast<std::uint32_t>(tick),
                      {builder.GetBufferPointer(), builder.GetSize()}, record.hand);
}

// A live session can't be had again, so it isn't left in memory for long. One in lockstep can, to the bit:
// there chunks end by session time alone, and the file's bytes depend on no clock.
Status Recorder::Writer::flush_in_time() {
  if (wait_when_full || !mcap.is_chunk_open()) return {};
  return std::chrono::steady_clock::now() - opened < kLongestOpen ? Status{} : mcap.flush();
}

Status Recorder::Writer::write_waiting() {
  while (const TickRecord* const record = ring.front()) {
    if (!mcap.is_chunk_open()) opened = std::chrono::steady_clock::now();
    if (Status status = write(*record); !status.ok()) return status;
    if (failed.load(std::memory_order_acquire)) break;
    ring.pop();
  }
  return flush_in_time();
}

// Nobody could catch what leaves a thread.
void Recorder::Writer::run() {
  for (;;) {
    const bool last_round =
        closing.load(std::memory_order_acquire);  // before looking: what is there then, is all
    try {
      if (Status status = write_waiting(); !status.ok()) fail(std::move(status));
    } catch (const std::exception&) {
      fail(std::move(out_of_memory[0]));
    }
    if (last_round || failed.load(std::memory_order_acquire)) return;
    std::this_thread::sleep_for(kWriterNap);
  }
}

void Recorder::Writer::run_syncs() try {
  std::unique_lock lock(mutex);
  while (!end.wait_for(lock, sync_interval, [this] { return ended; })) {
    lock.unlock();
    if (Status synced = mcap.sync(); !synced.ok()) return fail(std::move(synced));
    lock.lock();
  }
} catch (const std::exception&) {
  fail(std::move(out_of_memory[1]));
}

Recorder::Recorder() = default;

Recorder::~Recorder() {
  const Status dropped = close();
  static_cast<void>(dropped);
}

Status Recorder::open(const std::string& path, const Scene& scene, const RecorderOptions& options) try {
  const NoFileSizeSignal guard;
  if (writer_) return Status::error(path + ": the recorder is still open; close it first");
  if (Status status = check_options(scene, options); !status.ok())
    return Status::error(path + ": " + status.message());
  std::vector<std::uint8_t> session;
  if (Status status = encode_session(scene, session, options.second_hand); !status.ok())
    return Status::error(path + ": " + status.message());

  auto writer = std::make_unique<Writer>(path, scene, options);
  McapWriter& mcap = writer->mcap;
  if (Status status = open_recording(path, scene.settings.rate, session, {}, metadata_of(options),
                                     mcap_options_of(options), mcap, writer->channels);
      !status.ok())
    return status;
  Status status = mcap.sync();
  if (status.ok()) status = writer->start(path);
  if (!status.ok()) {
    mcap.discard();
    return status;
  }
  writer_ = std::move(writer);
  kept_ = 0;
  return {};
} catch (const std::bad_alloc&) {
  return Status::error(path + ": not enough memory to record; use a smaller ring or scene");
}

// Null where there is no room and it is not waited for.
template <class T>
T* Recorder::Writer::place_in(Ring<T>& of) noexcept {
  T* slot = of.claim();
  while (slot == nullptr) {
    if (!wait_when_full || failed.load(std::memory_order_acquire)) return nullptr;
    std::this_thread::sleep_for(kFullRingNap);
    slot = of.claim();
  }
  return slot;
}

bool Recorder::record(const TickRecord& record, const State* after) noexcept {
  if (!writer_ || writer_->is_parents() || writer_->failed.load(std::memory_order_acquire)) return false;
  const std::uint64_t tick = record.output.tick;
  if (record.hand >= writer_->sides.size()) return false;
  std::optional<std::uint64_t>& last_tick = writer_->last_tick[record.hand];
  const std::optional<std::uint64_t>& other = writer_->last_tick[1 - record.hand];
  if ((last_tick && tick <= *last_tick) || (other && tick < *other)) return false;
  if (record.device.kind > InputKind::joint_angles) return false;

  TickRecord* const slot = writer_->place_in(writer_->ring);
  if (slot == nullptr) return false;
  const bool is_wanted = after != nullptr && ((tick % kStateInterval == 0 && reaches_back(*after)) ||
                                              (after->proxy && writer_->is_drawn(tick)));
  if (is_wanted && after->tick == tick + 1) {
    try {
      if (KeptState* const kept = writer_->place_in(writer_->states)) {
        *kept = {*after, record.hand};
        writer_->states.publish();
      }
    } catch (const std::bad_alloc&) {  // then this one is not kept
    }
  }
  copy_record(record, *slot);
  writer_->ring.publish();
  const auto* const lists = reinterpret_cast<const char*>(&record.sent);
  const auto bytes = static_cast<std::size_t>(lists - reinterpret_cast<const char*>(&record));
  writer_->ring.prefetch(bytes);  // long out of the caches by now
  last_tick = tick;
  return true;
}

Status Recorder::failure() const {
  if (!writer_ || !writer_->failed.load(std::memory_order_acquire)) return {};
  return writer_->first_error;
}

// Of a copy that a fork has made nothing can be taken apart: its threads are not here, its locks may be held
// by them. It stays in memory until this process ends.
bool Recorder::leave_to_parent() noexcept {
  if (!writer_ || !writer_->is_parents()) return false;
  static_cast<void>(writer_.release());
  kept_ = 0;
  return true;
}

Status Recorder::close() {
  if (leave_to_parent())
    return Status::error("the recording is another process's, of which this one is a fork; close it there");
  if (!writer_) return {};
  const NoFileSizeSignal guard;
  const std::unique_ptr<Writer> writer = std::move(writer_);
  writer->stop();
  Status status = std::move(writer->first_error);
  try {
    if (status.ok()) status = writer->mcap.close();
  } catch (const std::bad_alloc&) {
    status = std::move(writer->out_of_memory[0]);
  }
  kept_ = 0;
  for (std::size_t hand = 0; hand < writer->sides.size(); ++hand)
    kept_ += writer->mcap.written_messages(hand);
  return status;
}

void Recorder::discard() {
  if (leave_to_parent() || !writer_) return;
  writer_->stop();
  writer_->mcap.discard();
  writer_.reset();
}

Status check_recording_start(const Model& model, const State& start, const State& state) {
  const std::uint64_t first = hash_state(make_state(model));
  if (hash_state(start) != first)
    return Status::error(
        "a recording begins with a session's first tick, and this one goes on from a part of a "
        "recording; begin with the whole recording");
  if (hash_state(state) != first)
    return Status::error("a recording begins with a session's first tick; make a new session");
  return {};
}

Status session_message(const Scene& scene, std::vector<std::uint8_t>& bytes,
                       const std::optional<Hand>& second) {
  return encode_session(scene, bytes, second);
}

void tick_message(const TickRecord& record, std::vector<std::uint8_t>& bytes) {
  flatbuffers::FlatBufferBuilder builder;
  encode_tick(record, record.has_forces, input_check_of(record), builder);
  bytes.assign(builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize());
}

}  // namespace lumbrical
