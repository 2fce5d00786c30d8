// What happened between a session and its device, told from the commands in its ticks.
#include <algorithm>
#include <cassert>
#include <functional>
#include <new>
#include <optional>
#include <span>
#include <string>

#include "base/check_stop.h"
#include "files/text_output.h"
#include "lumbrical/recording.h"
#include "recording/chosen_ticks.h"
#include "recording/json_line.h"
#include "recording/record_fields.h"

namespace lumbrical {
namespace {

std::string milliseconds(double seconds) { return rounded_text(1e3 * seconds, 3) + " ms"; }

/// One pass over the ticks of a recording.
class Pass {
 public:
  Pass(double rate, DeviceHistory& history, const std::function<Status(const DeviceEvent&)>& event)
      : rate_(rate), history_(history), event_(event) {}
  Status take(const TickRecord& record);
  Status end();

 private:
  Status tell(const char* kind, std::string text);
  Status take(const SentCommand& sent);
  Status take_state(const SentCommand& sent);
  Status take_flags(std::uint32_t flags);
  Status take_answer(const SentCommand& sent);
  Status take_delay(double delay);

  double rate_;
  DeviceHistory& history_;
  const std::function<Status(const DeviceEvent&)>& event_;
  std::uint64_t tick_ = 0;
  std::optional<SafetyState> state_;
  std::uint32_t flags_ = 0;
  std::uint64_t unanswered_ = 0;  // in a row
  double delays_ = 0, longest_told_ = 0;
  std::uint64_t delay_count_ = 0;
};

Status Pass::tell(const char* kind, std::string text) {
  DeviceEvent event{tick_, static_cast<double>(tick_) / rate_, kind, std::move(text)};
  if (event_) return event_(event);
  history_.events.push_back(std::move(event));
  return {};
}

Status Pass::take_state(const SentCommand& sent) {
  if (state_ == sent.state) return {};
  const std::string from = state_ ? std::string(safety_state_name(*state_)) + " -> " : std::string();
  state_ = sent.state;
  return tell("state", from + std::string(safety_state_name(sent.state)));
}

Status Pass::take_flags(std::uint32_t flags) {
  const std::uint32_t raised = flags & ~flags_, gone = flags_ & ~flags;
  flags_ = flags;
  if (raised != 0)
    if (Status status = tell("flags", safety_flag_names(raised)); !status.ok()) return status;
  return gone != 0 ? tell("flags", "no longer " + safety_flag_names(gone)) : Status{};
}

Status Pass::take_answer(const SentCommand& sent) {
  ++history_.commands;
  if (sent.acknowledged == 0)
    return ++unanswered_ == 1
               ? tell("commands", "command " + std::to_string(sent.cycle) + " not acknowledged")
               : Status{};
  ++history_.acknowledged;
  const std::uint64_t missed = unanswered_;
  unanswered_ = 0;
  return missed == 0
             ? Status{}
             : tell("commands", "acknowledged again after " + std::to_string(missed) + " that were not");
}

Status Pass::take_delay(double delay) {
  if (!(delay > 0)) return {};
  delays_ += delay;
  ++delay_count_;
  history_.mean_delay = delays_ / static_cast<double>(delay_count_);
  if (delay > history_.largest_delay) history_.largest_delay = delay;
  if (delay < 1.25 * longest_told_) return {};
  longest_told_ = delay;
  return tell("delay", milliseconds(delay) + " from reading angles to the reply");
}

Status Pass::take(const SentCommand& sent) {
  if (Status status = take_state(sent); !status.ok()) return status;
  if (Status status = take_flags(sent.flags); !status.ok()) return status;
  if (sent.sent == 0) return {};
  if (Status status = take_answer(sent); !status.ok()) return status;
  return take_delay(1e-9 * static_cast<double>(sent.loop_delay));
}

Status Pass::take(const TickRecord& record) {
  tick_ = record.output.tick;
  for (std::uint32_t i = 0; i < record.sent_count; ++i)
    if (Status status = take(record.sent[i]); !status.ok()) return status;
  if (!record.timing) return {};
  const LoopTiming& timing = *record.timing;
  return tell("certificate", "renewed for a period of " + milliseconds(timing.period) + ", " +
                                 milliseconds(timing.jitter) + " of jitter, a delay of " +
                                 milliseconds(timing.delay));
}

Status Pass::end() {
  return unanswered_ == 0 ? Status{}
                          : tell("commands", std::to_string(unanswered_) + " not acknowledged at the end");
}

// Kinds and texts are made here, without a character that would have to be escaped.
std::string event_line(const DeviceEvent& event, ExportFormat format) {
  if (format == ExportFormat::csv)
    return std::to_string(event.tick) + ',' + exact_text(event.time) + ',' + event.kind + ",\"" + event.text +
           '"';
  JsonLine json;
  json.open("", '{').number("tick", event.tick).number("time", event.time);
  return json.string("kind", event.kind).string("text", event.text).close('}').text();
}

Status read_history(RecordingReader& reader, DeviceHistory& history,
                    const std::function<Status(const DeviceEvent&)>& event,
                    const std::function<bool()>& stop) {
  history = {};
  if (Status status = reader.seek(0); !status.ok()) return status;
  Pass pass(reader.scene().settings.rate, history, event);
  for (TickRecord record;;) {
    bool end = false;
    if (Status status = check_stop(stop); !status.ok()) return status;
    if (Status status = reader.next(record, end); !status.ok()) return status;
    if (end) return pass.end();
    if (Status status = pass.take(record); !status.ok()) return status;
  }
}

/// The first hand whose ticks have a device's commands; what can't be read, or was stopped, tells why when it
/// is read again.
RecordingReader& driven_hand(std::span<RecordingReader> readers, const std::function<bool()>& stop) {
  assert(!readers.empty());
  const auto stop_at_first = [](const DeviceEvent&) { return Status::error("driven"); };
  for (RecordingReader& reader : readers.first(readers.size() - 1)) {
    DeviceHistory history;
    if (!read_history(reader, history, stop_at_first, stop).ok()) return reader;
  }
  return readers.back();
}

Status read_driven(std::span<RecordingReader> readers, DeviceHistory& history,
                   const std::function<Status(const DeviceEvent&)>& event,
                   const std::function<bool()>& stop) {
  return read_history(driven_hand(readers, stop), history, event, stop);
}

// Of ticks, not of events: there may be none of those.
Status check_ticks(const RecordingInfo& info, const ExportOptions& options) {
  std::uint64_t first = options.first;
  if (first < info.first_tick)
    first += (info.first_tick - first + options.step - 1) / options.step * options.step;
  return check_choice(info, first <= std::min(options.last, info.last_tick) ? 1 : 0);
}

Status write_events(std::span<RecordingReader> readers, const ExportOptions& options, TextOutput& out) {
  const ExportFormat format = options.format;
  if (format == ExportFormat::csv)
    if (Status status = out.line("tick,time [s],kind,text"); !status.ok()) return status;
  DeviceHistory history;
  const auto write = [&](const DeviceEvent& event) {
    return is_chosen(options, event.tick) ? out.line(event_line(event, format)) : Status();
  };
  return read_driven(readers, history, write, options.stop);
}

}  // namespace

Status read_device_history(std::span<RecordingReader> readers, DeviceHistory& history,
                           const std::function<Status(const DeviceEvent&)>& event) try {
  return read_driven(readers, history, event, {});
} catch (const std::bad_alloc&) {
  return Status::error(readers[0].info().path + ": not enough memory to read the events");
}

Status export_device_events(std::span<RecordingReader> readers, const ExportOptions& options,
                            const std::string& output) try {
  if (Status status = check_step(options); !status.ok()) return status;
  if (options.format == ExportFormat::npz)
    return Status::error("events are no table of numbers; export them as csv or json");
  if (!options.columns.empty() || !options.segments.empty() || options.exact)
    return Status::error("neither columns nor segments can be chosen of events, nor how exact they are");
  if (Status status = check_ticks(readers[0].info(), options); !status.ok()) return status;
  return write_whole<TextOutput>(output,
                                 [&](TextOutput& out) { return write_events(readers, options, out); });
} catch (const std::bad_alloc&) {
  return Status::error(output + ": not enough memory to export the events");
}

}  // namespace lumbrical
