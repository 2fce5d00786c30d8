// Copies of recordings: trimmed, merged, compressed otherwise, and every message as it was.
#include <algorithm>
#include <array>
#include <functional>
#include <new>
#include <optional>
#include <utility>

#include "base/check_stop.h"
#include "lumbrical/recording.h"
#include "recording/mcap_writer.h"
#include "recording/recorder.h"
#include "recording/session_message.h"
#include "recording/state_message.h"
#include "recording/tick_message.h"

namespace lumbrical {
namespace {

/// Where to start so that the state before `tick` comes out: the state before `begin`. Past the time forces
/// take to fade nothing is left of older ticks but the last output, and objects. Where that was left out,
/// nothing stands for it: the next tick puts its own in that place.
Status guess_state(RecordingReader& reader, const Model& model, std::uint64_t begin, State& state) {
  state = reader.initial_state(model);
  if (begin == reader.info().first_tick) return reader.seek(begin);
  if (Status status = reader.seek(begin - 1); !status.ok()) return status;
  TickRecord record;
  bool end = false;
  if (Status status = reader.next(record, end); !status.ok()) return status;
  state = {};
  state.tick = begin;
  state.rise = 1;
  state.last = record.output;
  return {};
}

/// Runs the ticks from the state's to the first that is copied; `found` stays as it is where there are none,
/// else tells whether the state behind them is the recorded one.
Status run_up_to(RecordingReader& reader, const Model& model, const CopyOptions& options, State& state,
                 bool& found) {
  Scratch scratch = make_scratch(model);
  scratch.hash_stages = false;
  while (state.tick < options.from) {
    if (Status status = check_stop(options.stop); !status.ok()) return status;
    TickRecord record;
    bool end = false;
    if (Status status = reader.next(record, end); !status.ok()) return status;
    found = false;
    if (end || record.output.tick != state.tick) return {};  // a gap
    tick(model, state, scratch, record.device, given_of(record));
    found = hash_state(state) == record.state_hash;
  }
  return {};
}

/// The last of the states that stand beside the ticks from `begin` to before `tick_number`; none: nothing is
/// kept there.
Status kept_state(RecordingReader& reader, std::uint64_t begin, std::uint64_t tick_number,
                  const std::function<bool()>& stop, std::optional<State>& kept) {
  const Side side = reader.scene().hand.side;
  if (Status status = reader.seek(begin); !status.ok()) return status;
  for (;;) {
    RecordedMessage message;
    bool end = false;
    if (Status status = check_stop(stop); !status.ok()) return status;
    if (Status status = reader.next_message(message, end); !status.ok()) return status;
    if (end || message.tick >= tick_number) return {};
    if (message.kind != MessageKind::tick || reader.info().hands[message.hand] != side) continue;
    std::optional<State> after;  // a damaged one is none; verify tells of it
    if (decode_state_after(message.bytes, after).ok() && after) kept = std::move(after);
  }
}

// A search backwards takes more and more ticks, at most all of them.
std::uint64_t farther(std::uint64_t back, std::uint64_t all) { return back < all / 8 ? 8 * back : all; }

/// From the last state kept before the first tick that is copied; looked for backwards, a few chunks first.
Status find_from_kept(RecordingReader& reader, const Model& model, const CopyOptions& options, State& state,
                      bool& found) {
  const std::uint64_t first = reader.info().first_tick, tick_number = options.from;
  const std::uint64_t all = tick_number - first;
  std::optional<State> kept;
  std::uint64_t begin = tick_number;
  for (std::uint64_t back = 256; !kept && begin > first; back = farther(back, all)) {
    const std::uint64_t end = begin;
    begin = tick_number - std::min(back, all);
    if (Status status = kept_state(reader, begin, end, options.stop, kept); !status.ok()) return status;
  }
  if (!kept || kept->tick > tick_number || !check_state(model, *kept).ok()) return {};
  state = std::move(*kept);
  found = true;
  if (Status status = reader.seek(state.tick); !status.ok()) return status;
  return run_up_to(reader, model, options, state, found);
}

/// From what is known of ticks that keep no state, more and more of them.
Status find_from_output(RecordingReader& reader, const Model& model, const CopyOptions& options, State& state,
                        bool& found) {
  const Settings& settings = reader.scene().settings;
  const std::uint64_t first = reader.info().first_tick;
  const std::uint64_t all = options.from - first;
  std::uint64_t back = 2 * static_cast<std::uint64_t>(settings.fade_time * settings.rate) + 8;
  if (!model.apart.empty()) back = all;  // where objects are depends on all ticks before
  for (;; back = farther(back, all)) {
    const std::uint64_t begin = options.from - std::min(back, all);
    if (Status status = guess_state(reader, model, begin, state); !status.ok()) return status;
    if (state.tick == begin)
      if (Status status = run_up_to(reader, model, options, state, found); !status.ok()) return status;
    if (found || begin == first) return {};
  }
}

/// The state before the first tick that is copied, which is not the recording's first. It is certain where it
/// is found, for its hash was recorded.
Status find_state(RecordingReader& reader, const CopyOptions& options, State& state, bool& found) {
  Model model;
  found = false;
  if (Status status = reader.find_world(options.world); !status.ok())
    return options.world.empty() ? Status() : status;
  if (!build_model(reader.scene(), {}, model).ok()) return {};       // nor can it be replayed here
  if (!model.apart.empty() || model.settings.proxy_stiffness > 0) {  // else none is kept (recorder.cpp)
    if (Status status = find_from_kept(reader, model, options, state, found); !status.ok() || found)
      return status;
  }
  return find_from_output(reader, model, options, state, found);
}

/// Where a replay of a hand's copied ticks would stand; no tick: one before it is missing.
struct ReplayEnd {
  std::uint64_t tick = UINT64_MAX;
  std::uint64_t state_hash = 0;
};

class Copy {
 public:
  Copy(const CopyOptions& options, CopyResult& result) : options_(options), result_(result) {}

  Status add(const std::string& path, const std::string& output);
  Status close() { return writer_.close(); }
  void discard() {
    if (open_) writer_.discard();
  }

 private:
  Status start(RecordingReader& reader, const std::string& output);
  Status check_scene(const RecordingReader& reader) const;
  Status check_states(const RecordingReader& reader);
  void follow(const RecordedMessage& message);
  Status copy_objects(RecordingReader& reader);
  Status write(const RecordedMessage& message, std::uint64_t tick_number);
  Status initial_state(RecordingReader& reader, std::vector<std::uint8_t>& bytes, ReplayEnd& end);
  Status initial_states(RecordingReader& reader, StateMessages& states);

  const CopyOptions& options_;
  CopyResult& result_;
  McapWriter writer_;
  bool open_ = false;
  std::vector<std::uint8_t> session_;
  std::vector<Side> hands_;
  std::vector<RecordingChannel> channels_;
  double period_ = 0;                             // [ns]
  std::array<std::uint64_t, kMostHands> next_{};  // tick that may come next, by hand
  std::array<ReplayEnd, kMostHands> ends_;        // by hand
};

Status Copy::initial_state(RecordingReader& reader, std::vector<std::uint8_t>& bytes, ReplayEnd& end) {
  State state = reader.initial_state();
  const RecordingInfo& info = reader.info();
  bool found = state.tick == info.first_tick;
  if (options_.from > info.first_tick && options_.from <= info.last_tick) {
    if (Status status = find_state(reader, options_, state, found); !status.ok()) return status;
  }
  if (found && state.tick > 0) bytes = encode_state(state);
  if (found) end = {state.tick, hash_state(state)};
  return {};
}

Status Copy::initial_states(RecordingReader& reader, StateMessages& states) {
  if (Status status = initial_state(reader, states[0], ends_[0]); !status.ok() || !reader.other_hand())
    return status;
  RecordingReader second;
  if (Status status = second.open(reader.info().path, reader.other_hand()->side); !status.ok()) return status;
  return initial_state(second, states[1], ends_[1]);
}

Status Copy::start(RecordingReader& reader, const std::string& output) {
  const Scene& scene = reader.scene();
  if (Status status = encode_session(scene, session_, reader.other_hand()); !status.ok()) return status;
  hands_ = reader.info().hands;
  const RecordingInfo& info = reader.info();
  channels_ = channels_of(hands_, views_that([&info](MessageKind kind) {
                            if (kind == MessageKind::pose) return info.has_poses;
                            return kind == MessageKind::contacts ? info.has_contacts : info.has_scene;
                          }));
  StateMessages states;
  if (Status status = initial_states(reader, states); !status.ok()) return status;
  period_ = 1e9 / scene.settings.rate;
  McapWriterOptions options;
  options.compression = options_.compression.value_or(compression_named(info.compression));
  const Status status = open_recording(output, scene.settings.rate, session_, states, reader.info().metadata,
                                       options, writer_, channels_);
  open_ = status.ok();
  return status;
}

Status Copy::check_scene(const RecordingReader& reader) const {
  std::vector<std::uint8_t> session;
  if (Status status = encode_session(reader.scene(), session, reader.other_hand()); !status.ok())
    return status;
  if (session == session_) return {};
  return Status::error(reader.info().path +
                       ": its scene (hand, world, settings) is not that of the first; "
                       "only recordings of one session can be merged");
}

// A later part knows the state before it: it is what the ticks before it left, or they are another session's.
Status Copy::check_states(const RecordingReader& reader) {
  for (std::size_t hand = 0; hand < hands_.size(); ++hand) {
    const State& state = hand == 0 ? reader.initial_state() : reader.other_initial_state();
    ReplayEnd& end = ends_[hand];
    if (state.tick == end.tick && hash_state(state) != end.state_hash)
      return Status::error(reader.info().path + ": does not go on from the state that the ticks before " +
                           std::to_string(state.tick) +
                           " left; only recordings of one session can be merged");
    if (state.tick != end.tick) end = {};
  }
  return {};
}

void Copy::follow(const RecordedMessage& message) {
  ReplayEnd& end = ends_[message.hand];
  if (message.tick != end.tick) result_.replayable = false;
  end = {message.tick + 1, message.state_hash};
}

Status Copy::write(const RecordedMessage& message, std::uint64_t tick_number) {
  const std::size_t channel = channel_number(channels_, hands_, message.kind, message.hand);
  if (channel == channels_.size()) return {};  // the first recording had none of these
  return writer_.message(tick_time(tick_number, period_), static_cast<std::uint32_t>(tick_number),
                         message.bytes, channel);
}

// Objects are drawn once, where a session begins; so a part of it has to begin.
Status Copy::copy_objects(RecordingReader& reader) {
  const RecordingInfo& info = reader.info();
  if (!info.has_scene || options_.from <= info.first_tick || options_.from > info.last_tick) return {};
  if (Status status = reader.seek(0); !status.ok()) return status;
  for (;;) {
    RecordedMessage message;
    bool end = false;
    if (Status status = reader.next_message(message, end); !status.ok()) return status;
    if (end || message.kind == MessageKind::tick) return {};
    if (message.kind == MessageKind::objects) return write(message, options_.from);
  }
}

Status Copy::add(const std::string& path, const std::string& output) {
  RecordingReader reader;
  if (Status status = reader.open(path); !status.ok()) return status;
  const bool is_first = !open_;
  if (Status status = is_first ? start(reader, output) : check_scene(reader); !status.ok()) return status;
  if (Status status = is_first ? copy_objects(reader) : check_states(reader); !status.ok()) return status;
  if (Status status = reader.seek(options_.from); !status.ok()) return status;
  for (;;) {
    RecordedMessage message;
    bool end = false;
    if (Status status = check_stop(options_.stop); !status.ok()) return status;
    if (Status status = reader.next_message(message, end); !status.ok()) return status;
    const std::uint64_t tick_number = message.tick;
    if (end || tick_number >= options_.to) return {};
    if (tick_number < next_[message.hand])
      return Status::error(path + ": tick " + std::to_string(tick_number) +
                           " does not follow the ticks before it; name the recordings in their order, and "
                           "none twice");
    next_[1 - message.hand] = std::max(next_[1 - message.hand], tick_number);
    if (message.kind == MessageKind::tick) {
      next_[message.hand] = tick_number + 1;
      follow(message);
      if (message.hand == 0) ++result_.ticks;
    }
    if (message.kind == MessageKind::objects && !is_first) continue;
    if (Status status = write(message, tick_number); !status.ok()) return status;
  }
}

Status copy_all(const std::vector<std::string>& inputs, const std::string& output, Copy& copy) {
  for (const std::string& input : inputs) {
    if (Status status = copy.add(input, output); !status.ok()) return status;
  }
  return copy.close();
}

}  // namespace

Status copy_recordings(const std::vector<std::string>& inputs, const std::string& output,
                       const CopyOptions& options, CopyResult& result) try {
  result = {};
  if (inputs.empty()) return Status::error("there is no recording to copy; name at least one");
  Copy copy(options, result);
  Status status = copy_all(inputs, output, copy);
  if (!status.ok()) copy.discard();
  return status;
} catch (const std::bad_alloc&) {
  return Status::error(output + ": not enough memory to copy the recordings");
}

}  // namespace lumbrical
