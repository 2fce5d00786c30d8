// Flight recorder: every tick of a session in one self-contained MCAP file, and the way back.
//
// A file carries the whole scene (hand, world, settings), so a replay needs nothing else; only a world that
// is a file of its own stays outside. Format: docs/recording.md.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lumbrical/device.h"
#include "lumbrical/device_link.h"
#include "lumbrical/loop_timing.h"
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
  bool has_forces = true;  ///< false: the file leaves them out, those of `output` are NaN
  std::uint8_t hand = 0;   ///< whose: 0 of Scene::hand, 1 of RecorderOptions::second_hand
  /// Of the loop with a device, in ticks that renewed its certificate by a tenth or more; never compared.
  std::optional<LoopTiming> timing;
  std::uint32_t sent_count = 0;    ///< of `sent`, at most kMaxSentPerTick
  std::uint32_t given_count = 0;   ///< of `given`: input, with `device`
  std::uint32_t object_count = 0;  ///< of `object`: output, with `output`
  // ---- the lists, of which most ticks have no more than the first entries
  std::array<SentCommand, kMaxSentPerTick> sent{};  ///< to a device, since the last tick; never compared
  std::array<ObjectFrame, kMostObjects> given{};
  std::array<ObjectOutput, kMostObjects> object{};
};

/// Takes a tick's input into its record; `given` holds at most kMostObjects.
void take_input(const DeviceFrame& frame, std::span<const ObjectFrame> given, TickRecord& record);

/// Takes what a tick made beside its output into its record: hashes and objects. `after` is the State it
/// left. The stages have hashes where Scratch::hash_stages was on.
void take_results(const State& after, const Scratch& scratch, TickRecord& record);

/// Refuses to record from amid a session on: a replay begins with the model's first state. `start` is the
/// session's own, which of a part of a recording is what the tick before the part left.
Status check_recording_start(const Model& model, const State& start, const State& state);

enum class Compression : std::uint8_t { none, lz4, zstd };

struct RecorderOptions {
  Compression compression = Compression::lz4;
  double chunk_seconds = 0.2;  ///< session time per chunk, <= 0.25: what a killed process can lose
  /// > 0, <= 3600: by the clock, from one order to the disk to the next: what a power cut can lose
  double sync_seconds = 1;
  std::uint32_t ring_capacity = 2048;  ///< ticks between the tick thread and the writer, 1 .. 2^18
  bool wait_when_full =
      true;  ///< lockstep waits for the writer; otherwise (live) the gap is marked in the file
  /// Ticks whose number is a multiple of this keep their forces and torques; 0: none does. Those left out
  /// cost no room and still have their hash: a replay finds any bit that differs, but other tools can't plot
  /// them.
  std::uint32_t force_interval = 1;
  /// Every so many ticks the recording also holds the posed hand, contact points, and hand, forces and
  /// objects as a scene, for programs that draw them; 0: never. They are computed by the recorder's thread,
  /// from `models`. With a proxy they are of the proxy, and record() needs `after`; where the ring for states
  /// is full in live mode, they are left out. Objects that take more than 16 MiB are refused, and
  /// contact points of a world file; more of them in a tick than 16 MiB (299,000) end the recording with an
  /// error.
  std::uint32_t pose_interval = 0, contact_interval = 0, scene_interval = 0;
  std::vector<const Model*> models;  ///< of the hands, while the recorder is open; needed for intervals only
  std::optional<Hand> second_hand;   ///< of a session of two hands on one world, of the other side
  std::map<std::string, std::string>
      metadata;  ///< free text for the file's metadata record, of at most 4 MiB, e.g. start time; "build" and
                 ///< "arithmetic" are added, and "force_interval" where it is not 1, "pose_interval",
                 ///< "contact_interval" and "scene_interval" where they are not 0
};

/// Writes ticks to a file from a thread of its own. The tick thread only copies into a ring.
/// In a forked process it is a copy that keeps nothing and leaves the file to the one that opened it.
class Recorder {
 public:
  Recorder();
  ~Recorder();  ///< closes, dropping errors; call close() to see them
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Starts a file, which grows as `path`.part and takes its path on close. Nothing is ever written over: an
  /// error where either is there already. A killed process loses at most 0.25 s of a live session, a power
  /// cut 1.5 s.
  /// A world file of the scene is named in the recording, not copied into it. Ticks are of this scene and of
  /// a State that nothing but they changes: begin another recording where settings change (change_settings).
  Status open(const std::string& path, const Scene& scene, const RecorderOptions& options);
  /// Hands over one tick; no allocation or system call while the ring has room. False: not kept (ring full in
  /// live mode, tick number not above the hand's last one or below the other's, device.kind out of range, or
  /// the writer failed: see close()).
  /// `after` is the State it left. With objects or a proxy every 250th is kept beside its tick: whoever looks
  /// at a tick amid the session begins there. With a proxy those of ticks that are drawn are kept, too, for
  /// the recorder's thread. That allocates until the first sixteen are kept.
  bool record(const TickRecord& record, const State* after = nullptr) noexcept;
  /// The error that ended the recording, as soon as the writer has met it (disk full, say); from then on
  /// record() keeps nothing. For the thread that calls record().
  [[nodiscard]] Status failure() const;
  /// Writes the rest, index and summary. Returns the first error of the whole recording, if any.
  Status close();
  /// In the place of close(): removes what was written.
  void discard();
  /// Ticks that are in the file of the last recording (of two hands: of both together), once it was closed;
  /// exact whatever went wrong.
  [[nodiscard]] std::uint64_t kept() const { return kept_; }

 private:
  bool leave_to_parent() noexcept;
  std::uint64_t kept_ = 0;
  struct Writer;
  std::unique_ptr<Writer> writer_;
};

struct RecordingInfo {
  std::string path;         ///< of the file that is read
  std::vector<Side> hands;  ///< of the session, one or two; what follows is of the reader's
  bool has_poses = false, has_contacts = false, has_scene = false;  ///< beside the ticks
  std::uint64_t ticks = 0;                                          ///< records in the file
  std::uint64_t first_tick = 0, last_tick = 0;
  std::uint64_t missing_ticks = 0;  ///< numbers between first and last without a record
  double seconds = 0;               ///< of session time
  std::uint64_t bytes = 0;          ///< file size
  std::uint64_t chunks = 0;
  std::uint32_t version = 0;  ///< of the format (docs/recording.md)
  std::string compression;    ///< "lz4", "zstd", ""
  std::string library;        ///< who wrote it
  bool complete = false;      ///< has index, summary and footer; false after a crash
  bool growing = false;       ///< its writer was at work when it was opened
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
  /// The pair the field is of. Known where this machine, computing in the plainest way, still
  /// gives what was recorded; so not for what went wrong elsewhere (see ReplayOptions::trace).
  std::optional<std::uint32_t> primitive{}, triangle{};
  /// How many representable numbers one value is away from the other; none for whole numbers and NaNs.
  std::optional<std::uint64_t> ulp{};
  std::string recorded_build{};  ///< build_text of who recorded, as far as the file tells
  std::string replayed_build{};
};

/// Which results ticks have, as eight hexadecimal digits: recordings of one arithmetic replay to the last bit
/// in every build that has it, of others they need not. The recorder writes it into the metadata as
/// "arithmetic".
std::string_view arithmetic_version();

/// Which build of the library this is: version, compiler, optimised or not, processor.
std::string build_text();

/// What a message of a recording is: a tick; of a tick the posed hand, its contact points, or hand and forces
/// as a scene; of the session the objects, once; of a tick where they are.
enum class MessageKind : std::uint8_t { tick, pose, contacts, scene, objects, transforms, count };

/// A message of a recording as it stands there: what copies pass on.
struct RecordedMessage {
  MessageKind kind = MessageKind::tick;
  std::uint8_t hand = 0;  ///< whose: RecordingInfo::hands
  std::uint64_t tick = 0;
  std::uint64_t state_hash = 0;         ///< of a tick: TickRecord::state_hash
  std::span<const std::uint8_t> bytes;  ///< valid until the next is read
};

/// Reads a recording of one hand, or one hand's of two, chunk by chunk: memory stays bounded however long the
/// session was. To scene(), next() and all that takes a reader a session of two hands is two recordings, each
/// of one. Every byte is distrusted: lengths, offsets and checksums are verified before use.
class RecordingReader {
 public:
  RecordingReader();
  ~RecordingReader();
  RecordingReader(RecordingReader&&) noexcept;
  RecordingReader& operator=(RecordingReader&&) noexcept;

  /// Where `path` is not there, `path`.part is read: of a writer at work, or killed.
  /// Opens by the index; a file without one (killed writer) is scanned instead, and info().complete is false.
  /// Of two hands that of `side` is read, the session's first unless given; an error where there is none.
  Status open(const std::string& path, std::optional<Side> side = {});
  [[nodiscard]] const RecordingInfo& info() const;
  [[nodiscard]] const Scene& scene() const;
  /// The hand of the session that is not read, if there is one.
  [[nodiscard]] const std::optional<Hand>& other_hand() const;
  [[nodiscard]] const State& other_initial_state() const;  ///< its
  /// Opens the world file of a recording that names one, since it was too large to be inside: `path`; if that
  /// is empty, the regular file (no link) of its name beside the recording. It must have the same content.
  /// Until then scene().world is a name without a world. Nothing to do for recordings that carry their
  /// meshes, or a second time.
  Status find_world(const std::string& path);
  /// The state before the first tick as it is in the file: only where that is a later part of a session.
  [[nodiscard]] const State& initial_state() const;
  /// The same for a model of its scene: where nothing is in the file, objects stand where they start.
  [[nodiscard]] State initial_state(const Model& model) const;
  /// The next record in the order of the file. `end` tells that there is none; an error names the byte.
  Status next(TickRecord& record, bool& end);
  /// In the place of next(): the next message of whatever kind and hand, ticks checked likewise.
  Status next_message(RecordedMessage& message, bool& end);
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

/// A reader for each hand of the session, in the order of RecordingInfo::hands; for that of `side` alone
/// where one is given.
Status open_hands(const std::string& path, std::vector<RecordingReader>& readers,
                  std::optional<Side> side = {});

/// Tick numbers first .. last.
struct TickRange {
  std::uint64_t first = 0, last = 0;
  friend bool operator==(const TickRange&, const TickRange&) = default;
};

/// Every checksum, every length, the index against the chunks, every record against its schema, every input
/// against its check, every output against its hash, the order of ticks. An error for a torn file too: it
/// names the byte where the file stops being whole. What is whole may still lack ticks: `missing` (may be
/// null) are the numbers between the session's first (or the part's, which its state tells) and the last that
/// are not there, ascending.
Status verify_recording(const std::string& path, RecordingInfo& info,
                        std::vector<TickRange>* missing = nullptr);

/// Rewrites what is whole of a torn or damaged file: `recovered` ticks kept, of two hands those of both,
/// `lost` tick numbers missing, of either hand, and
/// which those are (`missing`, ascending; may be null): all between the first the file held and the last. The
/// last is known from the index, or where there is none from the chunks met, damaged ones too; what came
/// behind the last chunk of a torn file can't be. The session itself must be whole; `output` must be another
/// file and appears only when it is complete. `stop` is as that of CopyOptions, asked with
/// every chunk.
Status recover_recording(const std::string& path, const std::string& output, std::uint64_t& recovered,
                         std::uint64_t& lost, std::vector<TickRange>* missing = nullptr,
                         const std::function<bool()>& stop = {});

/// What copy_recordings takes over, and how.
struct CopyOptions {
  std::uint64_t from = 0;                  ///< first tick
  std::uint64_t to = UINT64_MAX;           ///< tick behind the last
  std::optional<Compression> compression;  ///< none: the first input's
  std::string world{};  ///< for RecordingReader::find_world; empty: at best beside the input
  /// Asked with every tick that is read; may be empty. Once it is true the copy ends with an error, and
  /// leaves no file.
  std::function<bool()> stop{};
};
struct CopyResult {
  std::uint64_t ticks = 0;
  /// Whether all of the copy can be replayed: no tick is missing, and where the first is not that of a
  /// session the state before it was found again (which takes the world file of a recording that names one).
  bool replayable = true;
};

/// Copies the ticks of one or more recordings of the same scene, each later than the one before, to a new
/// file, without changing a message: trimmed, merged, compressed otherwise. The state before the first tick
/// is computed anew from the ticks before it and held against the recorded hash; a later recording whose own
/// state is not what the ticks before it left is an error. Metadata are the first
/// input's; what other tools have added to a file (channels, attachments) is left out. `output` must be
/// another file and appears only when it is complete.
Status copy_recordings(const std::vector<std::string>& inputs, const std::string& output,
                       const CopyOptions& options, CopyResult& result);

struct ReplayOptions {
  Execution execution;
  std::optional<Law> law;           ///< "what if": replaces the recorded law of every segment
  std::optional<double> stiffness;  ///< [N/m^3]
  std::optional<double> precision;  ///< of every segment; 0: exact
  /// "What if": objects by their names in the scene; other meshes take their places, in the world frame [m]
  /// as the objects stand at the session's start, and are turned outside out as those of scene files are.
  std::map<std::string, Mesh> mesh;
  std::string world;  ///< for RecordingReader::find_world
  /// "What if": what_if writes the changed session here, a recording like any other; empty: nowhere. Of whole
  /// sessions only, and of one hand: the reader's.
  std::string record;
  /// Writes the intermediate values of a tick as text, a line per number, to this file ("-": standard
  /// output), for comparison with the same on another machine: of `trace_tick`, or where none is given of the
  /// first tick that differs (none, nothing is written).
  std::string trace;
  std::optional<std::uint64_t> trace_tick;
  std::optional<Stage> trace_stage;  ///< this one only; none: all of a given tick, the one that differs
  std::function<void(std::uint64_t done, std::uint64_t all)> progress;  ///< may be empty
  std::function<bool()> stop{};                                         ///< as that of CopyOptions
};

struct ReplayResult {
  std::uint64_t ticks = 0;                     ///< compared
  std::optional<Divergence> first_divergence;  ///< none: identical, bit for bit
  /// What verify_recording says of the file, whatever the replay found; empty where it is whole, still
  /// growing, or no engine runs.
  std::string damage;
  std::string not_traced;    ///< why ReplayOptions::trace_tick was not, behind a divergence; else empty
  double recorded_time = 0;  ///< [s] of all those ticks, as recorded on whatever machine that was
  double replayed_time = 0;  ///< [s] of all those ticks here; 0 where no engine runs
  Broadphase broadphase = Broadphase::automatic;  ///< that was used; automatic where no engine runs
};

/// Runs the recorded inputs through the engine again, from the file alone, and compares every output bit, up
/// to the first divergence. An error where ticks are missing (live recordings with gaps), since the state
/// behind a gap is unknown, and where the file holds none.
Status replay(RecordingReader& reader, const ReplayOptions& options, ReplayResult& result);

/// The same of all hands of a recording, one after the other, up to the first that diverges. Ticks and times
/// are those of all.
Status replay_hands(const std::string& path, const ReplayOptions& options, ReplayResult& result);

/// By how much one quantity of a what-if replay is off the recording, over all ticks.
struct Change {
  double max = 0;
  double rms = 0;
  std::uint64_t max_tick = 0;  ///< where the largest was
};

/// What another law, stiffness, mesh, precision or search would have changed.
struct WhatIfResult {
  std::uint64_t ticks = 0;
  std::array<Change, kFingerCount + 1> force;  ///< [N] |difference| per finger (its segments' sum) and palm
  /// The same in just-noticeable differences of the recorded force: 7 % of it, and never less than 7 % of
  /// 0.5 N, since of smaller forces people notice only larger shares. Above 1 it may be felt.
  std::array<Change, kFingerCount + 1> force_jnd;
  std::array<std::uint64_t, kFingerCount + 1> felt_ticks{};  ///< in which it is above 1
  std::array<Change, kSegmentCount> torque;                  ///< [N m] about each segment's base joint
  /// Ticks whose forces the file leaves out and whose hash says that this build computes others than were
  /// recorded.
  std::uint64_t unlike_recorded = 0;
  std::vector<World::Object> replaced;  ///< the objects of ReplayOptions::mesh: what was turned of them
  double recorded_time = 0;             ///< [s] mean per tick as recorded, on whatever machine that was
  double baseline_time = 0;  ///< [s] mean per tick of the recorded scene here, searched by the default
  double changed_time = 0;   ///< [s] mean per tick of the changed scene here
};

/// Runs the recorded inputs through the changed scene, and through the recorded one for the time it takes
/// here. Where the file leaves out forces, those this build computes take their place. Errors as of replay,
/// and of the recording that ReplayOptions::record asks for.
Status what_if(RecordingReader& reader, const ReplayOptions& options, WhatIfResult& result);

/// Compares two recordings tick by tick without running the engine, up to the first divergence: `recorded` is
/// from a, `replayed` from b, "none" where b or a has ended. Measured durations are not compared.
Status diff_recordings(RecordingReader& a, RecordingReader& b, ReplayResult& result);

/// Something that happened between a session and its device.
struct DeviceEvent {
  std::uint64_t tick = 0;  ///< in whose record it stands
  double time = 0;         ///< [s] of session time
  std::string kind;        ///< "state", "flags", "commands", "delay", "certificate"
  std::string text;        ///< what it was
};

/// A session's commands to its device: how many, what became of them, and what changed on the way.
struct DeviceHistory {
  std::uint64_t commands = 0, acknowledged = 0;
  double mean_delay = 0, largest_delay = 0;  ///< [s] from reading angles to the reply, where it is known
  std::vector<DeviceEvent> events;           ///< as they came
};

/// From the first tick to the last, of a session's hands (a reader each) the one that a device drove. Events:
/// the safety envelope's state and flags where they change, the first of commands that were not acknowledged
/// and the end of them, a delay a quarter longer than the last one told, a renewed certificate. `event` gets
/// each as it is found (may be empty: then they are in `history.events`).
Status read_device_history(std::span<RecordingReader> readers, DeviceHistory& history,
                           const std::function<Status(const DeviceEvent&)>& event = {});

/// csv: a table with a header of names and units, "index_distal.force.x [N]". npz: the same as a NumPy
/// archive, an array per column, and as texts the arrays "columns" and "units". json: one object per line,
/// with all there is of a tick in the engine's own names. Forces left out are empty cells, NaN or null.
enum class ExportFormat : std::uint8_t { csv, json, npz };

struct ExportOptions {
  ExportFormat format = ExportFormat::csv;
  /// Words: every column in whose name one of them is ("force", "angle.index", "all"), whether it varies or
  /// not. None: of pose, forces, flexion torques, flags, contacts and where objects are those that vary. Of
  /// tables only.
  std::vector<std::string> columns;
  std::vector<int> segments;                   ///< only these segments' columns; empty: all
  std::uint64_t first = 0, last = UINT64_MAX;  ///< tick numbers
  std::uint64_t step = 1;                      ///< every so many ticks, from `first` on
  bool exact = false;            ///< csv: as many digits as it takes to read the same bits, not six
  std::function<bool()> stop{};  ///< as that of CopyOptions
};

/// Writes to the file `output`, which appears only when it is complete, or to standard output where that is
/// "-" (not npz). Tables are read twice, to know what varies; an npz is in memory as a whole.
/// Of a session of two hands a reader of each may be given: then a line tells both, in columns named "left."
/// and "right." (empty, NaN or 0 where one hand's record is missing), and json has a line for each.
Status export_recording(std::span<RecordingReader> readers, const ExportOptions& options,
                        const std::string& output);
inline Status export_recording(RecordingReader& reader, const ExportOptions& options,
                               const std::string& output) {
  return export_recording(std::span(&reader, 1), options, output);
}

/// A contacted triangle, as recordings hold it for others.
struct ContactPoint {
  Vec3 centre;                 ///< [m] W: where its force acts
  Vec3 force;                  ///< [N] W: on the hand, before limits
  double depth = 0, area = 0;  ///< [m], [m^2] as of Contact
  std::uint32_t segment = 0;
  std::uint32_t object = 0;    ///< in all_objects (model.h)
  std::uint32_t triangle = 0;  ///< of the object's own mesh
};

/// Likewise of the posed hands a line per joint, or of the contact points a line per point, those of the
/// readers' hands as they come; in an npz an array per column. Of the contact points only those of the chosen
/// segments; columns can't be chosen. An error where the recording holds none.
Status export_views(std::span<RecordingReader> readers, MessageKind kind, const ExportOptions& options,
                    const std::string& output);

/// Likewise one line per DeviceEvent of the chosen ticks: csv (tick, time [s], kind, text) or json. No npz,
/// and nothing else can be chosen.
Status export_device_events(std::span<RecordingReader> readers, const ExportOptions& options,
                            const std::string& output);

/// The messages a recording would hold, for whoever passes them on while a session runs. `bytes` is replaced.
/// A scene of 2 GiB or more is refused.
Status session_message(const Scene& scene, std::vector<std::uint8_t>& bytes,
                       const std::optional<Hand>& second = {});
void tick_message(const TickRecord& record, std::vector<std::uint8_t>& bytes);

}  // namespace lumbrical
