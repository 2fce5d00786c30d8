// The recorder: the tick thread puts records into a ring, a writer thread encodes, compresses and writes
// them.
#include "recording/recorder.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <new>
#include <optional>
#include <system_error>
#include <thread>

#include "base/ring.h"
#include "flatbuffers/flatbuffers.h"
#include "lumbrical/recording.h"
#include "recording/record_fields.h"
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
constexpr std::uint32_t kLargestRing = 1u << 18;

// All of a record but the places for commands it does not have, which are a third of it.
void copy_record(const TickRecord& from, TickRecord& to) {
  to.device = from.device;
  to.output = from.output;
  to.stage_hash = from.stage_hash;
  to.state_hash = from.state_hash;
  to.duration_ns = from.duration_ns;
  to.has_forces = from.has_forces;
  to.sent_count = std::min(from.sent_count, kMaxSentPerTick);
  std::copy_n(from.sent.begin(), to.sent_count, to.sent.begin());
}

Status check_options(const Scene& scene, const RecorderOptions& options) {
  if (!(options.chunk_seconds > 0 && options.chunk_seconds <= 0.25))
    return Status::error("chunk_seconds is out of range; choose more than 0 and at most 0.25");
  if (options.ring_capacity < 1 || options.ring_capacity > kLargestRing)
    return Status::error("ring_capacity is out of range; choose 1 to " + std::to_string(kLargestRing) +
                         " ticks");
  if (!(scene.settings.rate >= 1 && scene.settings.rate <= 100000))
    return Status::error("the scene's rate is out of range; choose 1 to 100000 Hz");
  return check_hand(scene.hand);
}

}  // namespace

Status open_recording(const std::string& path, OutputFile::Place place, double rate,
                      const std::vector<std::uint8_t>& session, const std::vector<std::uint8_t>& state,
                      const std::map<std::string, std::string>& metadata, McapWriterOptions options,
                      McapWriter& writer) {
  options.period = tick_time(1, 1e9 / rate);
  McapWriter::Start start;
  start.library = "lumbrical";
  start.schema_name = kTickSchemaName;
  start.schema = tick_schema();
  start.topic = "tick";
  start.attachments.push_back({kSessionAttachment, session});
  if (!state.empty()) start.attachments.push_back({kStateAttachment, state});
  start.metadata_name = kMetadataName;
  start.metadata = &metadata;
  Status status = writer.open(path, place, options, start);
  if (!status.ok()) writer.discard();
  return status;
}

struct Recorder::Writer {
  explicit Writer(std::uint32_t ring_capacity) : ring(ring_capacity) {}

  void run();
  Status write(const TickRecord& record);
  [[nodiscard]] bool keeps_forces(const TickRecord& record) const {
    return record.has_forces && force_interval > 0 && record.output.tick % force_interval == 0;
  }

  Ring<TickRecord> ring;
  double period = 0;  // [ns]
  bool wait_when_full = true;
  std::uint32_t force_interval = 1;
  std::optional<std::uint64_t> last_tick;  // handed over; the tick thread's own

  McapWriter mcap;  // the writer thread's own, from open() until it has ended
  flatbuffers::FlatBufferBuilder builder{4096};
  Status status;

  std::atomic<bool> closing{false};
  std::atomic<bool> failed{false};
  std::thread thread;
};

Status Recorder::Writer::write(const TickRecord& record) {
  encode_tick(record, keeps_forces(record), make_input_check(input_fields(record)), builder);
  const std::uint64_t tick = record.output.tick;
  // The sequence number is the tick's, so that any MCAP tool shows a gap as a gap.
  return mcap.message(tick_time(tick, period), static_cast<std::uint32_t>(tick),
                      {builder.GetBufferPointer(), builder.GetSize()});
}

void Recorder::Writer::run() {
  for (;;) {
    const bool last_round =
        closing.load(std::memory_order_acquire);  // before looking: what is there then, is all
    while (const TickRecord* const record = ring.front()) {
      status = write(*record);
      if (!status.ok()) {
        failed.store(true, std::memory_order_release);
        return;
      }
      ring.pop();
    }
    if (last_round) return;
    std::this_thread::sleep_for(kWriterNap);
  }
}

Recorder::Recorder() = default;

Recorder::~Recorder() {
  const Status dropped = close();
  static_cast<void>(dropped);
}

Status Recorder::open(const std::string& path, const Scene& scene, const RecorderOptions& options) try {
  if (writer_) return Status::error(path + ": the recorder is still open; close it first");
  if (Status status = check_options(scene, options); !status.ok())
    return Status::error(path + ": " + status.message());
  std::vector<std::uint8_t> session;
  if (Status status = encode_session(scene, session); !status.ok())
    return Status::error(path + ": " + status.message());

  auto writer = std::make_unique<Writer>(options.ring_capacity);
  writer->period = 1e9 / scene.settings.rate;
  writer->wait_when_full = options.wait_when_full;
  writer->force_interval = options.force_interval;
  McapWriterOptions mcap_options;
  mcap_options.compression = options.compression;
  mcap_options.chunk_time = static_cast<std::uint64_t>(options.chunk_seconds * 1e9);
  std::map<std::string, std::string> metadata = options.metadata;
  metadata.emplace("build", build_text());
  if (options.force_interval != 1) metadata.emplace("force_interval", std::to_string(options.force_interval));
  Status status = open_recording(path, OutputFile::Place::beside_existing, scene.settings.rate, session, {},
                                 metadata, mcap_options, writer->mcap);
  if (!status.ok()) return status;
  try {
    writer->thread = std::thread([raw = writer.get()] { raw->run(); });
  } catch (const std::system_error&) {
    writer->mcap.discard();
    return Status::error(path + ": no thread for the recorder; the system has reached its limit");
  }
  writer_ = std::move(writer);
  return {};
} catch (const std::bad_alloc&) {
  return Status::error(path + ": not enough memory to record; use a smaller ring or scene");
}

bool Recorder::record(const TickRecord& record) noexcept {
  if (!writer_ || writer_->failed.load(std::memory_order_acquire)) return false;
  const std::uint64_t tick = record.output.tick;
  if (writer_->last_tick && tick <= *writer_->last_tick) return false;
  if (record.device.kind > InputKind::joint_angles) return false;

  TickRecord* slot = writer_->ring.claim();
  while (slot == nullptr) {
    if (!writer_->wait_when_full || writer_->failed.load(std::memory_order_acquire)) return false;
    std::this_thread::sleep_for(kFullRingNap);
    slot = writer_->ring.claim();
  }
  copy_record(record, *slot);
  writer_->ring.publish();
  writer_->ring.prefetch(sizeof(TickRecord) - sizeof(record.sent));  // long out of the caches by now
  writer_->last_tick = tick;
  return true;
}

Status Recorder::failure() const {
  if (!writer_ || !writer_->failed.load(std::memory_order_acquire)) return {};
  return writer_->status;
}

Status Recorder::close() {
  if (!writer_) return {};
  const std::unique_ptr<Writer> writer = std::move(writer_);
  writer->closing.store(true, std::memory_order_release);
  writer->thread.join();
  return writer->status.ok() ? writer->mcap.close() : writer->status;
}

}  // namespace lumbrical
