// Flight recorder: every tick of a session in one self-contained MCAP file, and the way back.
//
// A file carries the whole scene (hand, world, settings), so a replay needs nothing else. Format:
// docs/recording.md.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lumbrical/device.h"
#include "lumbrical/model.h"
#include "lumbrical/status.h"
#include "lumbrical/tick.h"

namespace lumbrical {

/// One tick as it stands in a file.
struct TickRecord {
  DeviceFrame device;                                   ///< the input as received
  ActuatorFrame output;                                 ///< its `tick` is the record's number
  std::array<std::uint64_t, kStageCount> stage_hash{};  ///< Scratch::stage_hash
  std::uint64_t state_hash = 0;                         ///< hash_state after the tick
  std::uint32_t duration_ns = 0;                        ///< measured time of the tick; never compared
};

enum class Compression : std::uint8_t { none, lz4, zstd };

struct RecorderOptions {
  Compression compression = Compression::lz4;
  double chunk_seconds = 0.25;         ///< session time per chunk, <= 0.25: what a killed process can lose
  std::uint32_t ring_capacity = 2048;  ///< ticks between the tick thread and the writer
  bool wait_when_full =
      true;  ///< lockstep waits for the writer; otherwise (live) the gap is marked in the file
  std::map<std::string, std::string>
      metadata;  ///< free text for the file's metadata record, e.g. start time, build
};

/// Writes ticks to a file from a thread of its own. The tick thread only copies into a ring.
class Recorder {
 public:
  Recorder();
  ~Recorder();  ///< closes, dropping errors; call close() to see them
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Starts a file. Where `path` already exists the new file grows beside it as `path`.part and takes its
  /// place on close, so a good file is never replaced by half of one; otherwise it grows at `path` itself.
  Status open(const std::string& path, const Scene& scene, const RecorderOptions& options);
  /// Hands over one tick; no allocation or system call while the ring has room. False: not kept (ring full in
  /// live mode, tick number not above the last one, device.kind out of range, or the writer failed: see
  /// close()).
  bool record(const TickRecord& record) noexcept;
  /// Writes the rest, index and summary. Returns the first error of the whole recording, if any.
  Status close();

 private:
  struct Writer;
  std::unique_ptr<Writer> writer_;
};

struct RecordingInfo {
  std::string path;         ///< as given to open()
  std::uint64_t ticks = 0;  ///< records in the file
  std::uint64_t first_tick = 0, last_tick = 0;
  std::uint64_t missing_ticks = 0;  ///< numbers between first and last without a record
  double seconds = 0;               ///< of session time
  std::uint64_t bytes = 0;          ///< file size
  std::uint64_t chunks = 0;
  std::string compression;  ///< "lz4", "zstd", ""
  std::string library;      ///< who wrote it
  bool complete = false;    ///< has index, summary and footer; false after a crash
  std::map<std::string, std::string> metadata;
};

/// Where two runs part: the first tick, the first stage of it, and the first field that can be named.
struct Divergence {
  std::uint64_t tick = 0;
  std::string stage;  ///< stage_name, or "output", "state"; from diff_recordings also "scene"
  std::string
      field;  ///< e.g. "joint[7].position[1]", "segment[3].force.x", or "hash" where only a hash differs
  std::string recorded;  ///< the value as text, exact (floats round-trip)
  std::string replayed;
};

/// Reads a recording chunk by chunk: memory stays bounded however long the session was. Every byte is
/// distrusted: lengths, offsets and checksums are verified before use.
class RecordingReader {
 public:
  RecordingReader();
  ~RecordingReader();
  RecordingReader(RecordingReader&&) noexcept;
  RecordingReader& operator=(RecordingReader&&) noexcept;

  /// Opens by the index; a file without one (killed writer) is scanned instead, and info().complete is false.
  Status open(const std::string& path);
  [[nodiscard]] const RecordingInfo& info() const;
  [[nodiscard]] const Scene& scene() const;
  /// The next record in the order of the file. `end` tells that there is none; an error names the byte.
  Status next(TickRecord& record, bool& end);
  /// Whether the input of the record next() has just returned (device frame, tick number) was changed after
  /// it was recorded: `recorded` is then the original value of the field, `replayed` the present one. Every
  /// message carries a check that finds any change and names the field if it was the only one ("several"
  /// otherwise).
  [[nodiscard]] std::optional<Divergence> altered_input() const;
  /// Makes next() return the first record whose tick is >= `tick`; seek(0) goes back to the start.
  Status seek(std::uint64_t tick);

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Every checksum, every length, the index against the chunks, every record against its schema, every input
/// against its check. An error for a torn file too: it names the byte where the file stops being whole.
Status verify_recording(const std::string& path, RecordingInfo& info);

/// Rewrites what is whole of a torn or damaged file: `recovered` ticks kept, `lost` tick numbers missing, as
/// far as they can be known (those behind the last whole chunk of a torn file can't). The session itself must
/// be whole; `output` must be another file and appears only when it is complete.
Status recover_recording(const std::string& path, const std::string& output, std::uint64_t& recovered,
                         std::uint64_t& lost);

struct ReplayOptions {
  Execution execution;
  std::optional<Law> law;           ///< "what if": replaces the recorded law of every segment
  std::optional<double> stiffness;  ///< [N/m^3]
  std::optional<double> tolerance;  ///< Settings::tolerance
  std::function<void(std::uint64_t done, std::uint64_t all)> progress;  ///< may be empty
};

struct ReplayResult {
  std::uint64_t ticks = 0;                     ///< compared
  std::optional<Divergence> first_divergence;  ///< none: identical, bit for bit
};

/// Runs the recorded inputs through the engine again, from the file alone, and compares every output bit, up
/// to the first divergence. An error where ticks are missing (live recordings with gaps), since the state
/// behind a gap is unknown, and where the file holds none.
Status replay(RecordingReader& reader, const ReplayOptions& options, ReplayResult& result);

/// Compares two recordings tick by tick without running the engine, up to the first divergence: `recorded` is
/// from a, `replayed` from b, "none" where b or a has ended. Measured durations are not compared.
Status diff_recordings(RecordingReader& a, RecordingReader& b, ReplayResult& result);

/// One line per tick (CSV with a header line, or JSON lines), to the file `output`, which appears only when
/// it is complete, or to standard output where `output` is "-". Numbers are exact: read back, they give the
/// same bits.
enum class ExportFormat : std::uint8_t { csv, json };
Status export_recording(RecordingReader& reader, ExportFormat format, const std::string& output);

}  // namespace lumbrical
