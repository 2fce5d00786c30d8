// lumbrical.h: recordings, read and replayed.
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capi/boundary.h"
#include "capi/convert.h"
#include "model/apart_objects.h"

using namespace lumbrical;
using namespace lumbrical::capi;

namespace {

std::string text_or_empty(const char* text) { return text == nullptr ? "" : text; }

// None where `side` is LUMBRICAL_FIRST_HAND.
Fault to_side(std::int32_t side, std::optional<Side>& wanted) {
  if (side == LUMBRICAL_FIRST_HAND) return {};
  return check_enum(side, 2, "side", wanted.emplace());
}

Fault check_read(const lumbrical_reader& reader) {
  return reader.last != nullptr ? Fault() : bad_argument("no tick has been read yet");
}

}  // namespace

int lumbrical_replay(const char* path, const char* world, const lumbrical_execution* execution,
                     lumbrical_replay_result* result) {
  return call(__func__, [&]() -> Fault {
    if (Fault fault = check_pointer(path, "path")) return fault;
    if (Fault fault = check_struct(result, "result")) return fault;
    ReplayOptions options;
    options.world = text_or_empty(world);
    if (Fault fault = to_execution(execution, options.execution)) return fault;
    ReplayResult found;
    if (Fault fault = replay_hands(path, options, found)) return fault;
    const Divergence first = found.first_divergence.value_or(Divergence{});
    result->identical = found.first_divergence ? 0 : 1;
    result->ticks = found.ticks;
    result->tick = first.tick;
    copy_text(first.stage, result->stage);
    copy_text(first.field, result->field);
    copy_text(first.recorded, result->recorded);
    copy_text(first.replayed, result->replayed);
    copy_text(found.damage, result->damage);
    return {};
  });
}

int lumbrical_reader_open(const char* path, int32_t side, lumbrical_reader** reader) {
  return call(__func__, [&]() -> Fault {
    if (Fault fault = check_pointer(path, "path")) return fault;
    if (Fault fault = check_pointer(reader, "reader")) return fault;
    std::optional<Side> wanted;
    if (Fault fault = to_side(side, wanted)) return fault;
    auto opened = std::make_unique<lumbrical_reader>();
    if (Fault fault = opened->reader.open(path, wanted)) return fault;
    const std::vector<SceneObject>& objects = opened->reader.scene().objects;
    for (std::size_t i = 0; i < objects.size(); ++i)
      if (is_apart(objects[i])) opened->apart_object.push_back(static_cast<std::uint32_t>(i));
    *reader = opened.release();
    return {};
  });
}

int lumbrical_reader_close(lumbrical_reader* reader) { return destroy(__func__, reader); }

int lumbrical_reader_describe(lumbrical_reader* reader, lumbrical_recording_info* info) {
  return call_with(__func__, reader, [&]() -> Fault {
    if (Fault fault = check_struct(info, "info")) return fault;
    const RecordingInfo& from = reader->reader.info();
    info->complete = from.complete ? 1 : 0;
    info->side = static_cast<std::int32_t>(reader->reader.scene().hand.side);
    info->hands = static_cast<std::int32_t>(from.hands.size());
    info->ticks = from.ticks;
    info->first_tick = from.first_tick;
    info->last_tick = from.last_tick;
    info->missing_ticks = from.missing_ticks;
    info->seconds = from.seconds;
    return {};
  });
}

int lumbrical_reader_model(lumbrical_reader* reader, const char* world, const lumbrical_execution* execution,
                           lumbrical_model** model) {
  return call_with(__func__, reader, [&]() -> Fault {
    if (Fault fault = check_pointer(model, "model")) return fault;
    Execution how;
    if (Fault fault = to_execution(execution, how)) return fault;
    if (Fault fault = reader->reader.find_world(text_or_empty(world))) return fault;
    auto built = std::make_shared<BuiltModel>();
    if (Fault fault = build_model(reader->reader.scene(), how, built->model)) return fault;
    list_objects(*built);
    built->start = reader->reader.initial_state(built->model);
    *model = new lumbrical_model(std::move(built));
    return {};
  });
}

int lumbrical_reader_next(lumbrical_reader* reader, lumbrical_frame* frame, lumbrical_output* output,
                          int32_t* end) {
  return call_with(__func__, reader, [&]() -> Fault {
    if (frame != nullptr)
      if (Fault fault = check_struct(frame, "frame")) return fault;
    if (output != nullptr)
      if (Fault fault = check_struct(output, "output")) return fault;
    TickRecord& record = reader->records[reader->last == &reader->records[0] ? 1 : 0];
    bool at_end = false;
    if (Fault fault = reader->reader.next(record, at_end)) return fault;
    if (end != nullptr) *end = at_end ? 1 : 0;
    if (at_end) return {};
    reader->last = &record;
    if (frame != nullptr) to_c(record.device, *frame);
    if (output != nullptr) to_c(record.output, record.object_count, *output);
    return {};
  });
}

int lumbrical_reader_objects(lumbrical_reader* reader, lumbrical_object_output* objects, size_t capacity,
                             size_t* count) {
  return call_with(__func__, reader, [&]() -> Fault {
    if (Fault fault = check_array(objects, capacity, "objects")) return fault;
    if (Fault fault = check_pointer(count, "count")) return fault;
    if (Fault fault = check_read(*reader)) return fault;
    const TickRecord& record = *reader->last;
    if (record.object_count > reader->apart_object.size())
      return {LUMBRICAL_BAD_DATA, "the recorded tick has more objects than its scene; verify the recording"};
    return hand_over(std::span(record.object).first(record.object_count), objects, capacity, count,
                     [&](std::size_t i) { return to_c(record.object[i], reader->apart_object[i]); });
  });
}

int lumbrical_reader_given(lumbrical_reader* reader, lumbrical_pose* given, size_t capacity, size_t* count) {
  return call_with(__func__, reader, [&]() -> Fault {
    if (capacity > 0)
      if (Fault fault = check_pointer(given, "given")) return fault;
    if (Fault fault = check_pointer(count, "count")) return fault;
    if (Fault fault = check_read(*reader)) return fault;
    const TickRecord& record = *reader->last;
    return hand_over(std::span(record.given).first(record.given_count), given, capacity, count,
                     [&](std::size_t i) { return to_c(record.given[i].pose); });
  });
}

int lumbrical_reader_seek(lumbrical_reader* reader, uint64_t tick) {
  return call_with(__func__, reader, [&]() -> Fault { return reader->reader.seek(tick); });
}
