// lumbrical.h: a hand that is ticked.
#include <chrono>
#include <cstring>

#include "base/hash.h"
#include "capi/boundary.h"
#include "capi/convert.h"
#include "lumbrical/jacobian.h"
#include "recording/state_message.h"

using namespace lumbrical;
using namespace lumbrical::capi;

namespace {

Fault check_ticked(const lumbrical_session& session) {
  return session.ticked ? Fault() : bad_argument("the session has not been ticked yet");
}

Fault take_given(const Model& model, const lumbrical_pose* given, std::size_t count, TickRecord& record) {
  const std::size_t places = given_count(model);
  if (count > places)
    return bad_argument("given_count is " + std::to_string(count) + ", but the model has " +
                        std::to_string(places) + " given objects");
  if (count > 0)
    if (Fault fault = check_pointer(given, "given")) return fault;
  for (std::size_t i = 0; i < count; ++i) record.given[i].pose = to_pose(given[i]);
  record.given_count = static_cast<std::uint32_t>(count);
  return {};
}

Fault keep(lumbrical_session& session) {
  TickRecord& record = session.record;
  take_results(session.state, session.scratch, record);
  if (session.recorder->record(record, &session.state) || session.recorder->failure().ok()) return {};
  return {session.recorder->failure(), LUMBRICAL_NOT_RECORDED};
}

Fault run_tick(lumbrical_session& session) {
  TickRecord& record = session.record;
  const auto start = std::chrono::steady_clock::now();
  record.output = tick(session.built->model, session.state, session.scratch, record.device,
                       std::span(record.given).first(record.given_count));
  const std::chrono::nanoseconds duration = std::chrono::steady_clock::now() - start;
  record.duration_ns = static_cast<std::uint32_t>(std::min<std::int64_t>(duration.count(), UINT32_MAX));
  session.ticked = true;
  return session.recorder ? keep(session) : Fault();
}

lumbrical_contact to_c(const BuiltModel& built, const NamedContact& named) {
  const std::size_t of_world = built.world_object.size();
  const Contact& contact = named.contact;
  lumbrical_contact out{};
  out.size = sizeof out;
  out.segment = named.segment;
  out.object = named.object < of_world ? built.world_object[named.object]
                                       : built.apart_object[named.object - of_world];
  out.triangle = named.triangle;
  out.depth = contact.depth;
  out.area = contact.area;
  capi::to_c(contact.centroid, out.centroid);
  capi::to_c(contact.centre, out.centre);
  capi::to_c(contact.normal, out.normal);
  capi::to_c(built.model.settings.stiffness * contact.volume * contact.normal, out.force);
  return out;
}

// The state's message with its hash before it.
std::vector<std::uint8_t> snapshot_of(const State& state) {
  const std::vector<std::uint8_t> message = encode_state(state);
  const std::uint64_t hash = hash_of_bytes(message.data(), message.size());
  std::vector<std::uint8_t> bytes(sizeof hash + message.size());
  std::memcpy(bytes.data(), &hash, sizeof hash);
  std::memcpy(bytes.data() + sizeof hash, message.data(), message.size());
  return bytes;
}

Fault read_snapshot(std::span<const std::uint8_t> bytes, State& state) {
  std::uint64_t hash = 0;
  if (bytes.size() > sizeof hash) std::memcpy(&hash, bytes.data(), sizeof hash);
  if (bytes.size() <= sizeof hash ||
      hash != hash_of_bytes(bytes.data() + sizeof hash, bytes.size() - sizeof hash))
    return {LUMBRICAL_BAD_DATA, "these bytes are no snapshot, or damaged"};
  return decode_state(bytes.subspan(sizeof hash), state);
}

}  // namespace

int lumbrical_session_create(const lumbrical_model* model, lumbrical_session** session) {
  return call(__func__, [&]() -> Fault {
    if (Fault fault = check_handle(model)) return fault;
    if (Fault fault = check_pointer(session, "session")) return fault;
    *session = new lumbrical_session(model->built);
    return {};
  });
}

int lumbrical_session_destroy(lumbrical_session* session) { return destroy(__func__, session); }

int lumbrical_session_tick(lumbrical_session* session, const lumbrical_frame* frame,
                           const lumbrical_pose* given, size_t given_count, lumbrical_output* output) {
  return call_with(__func__, session, [&]() -> Fault {
    if (Fault fault = check_struct(output, "output")) return fault;
    if (Fault fault = take_given(session->built->model, given, given_count, session->record)) return fault;
    if (Fault fault = to_frame(frame, session->record.device)) return fault;
    Fault recording = run_tick(*session);
    capi::to_c(session->record.output, session->scratch.object_output.size(), *output);
    return recording;
  });
}

int lumbrical_session_contacts(lumbrical_session* session, lumbrical_contact* contacts, size_t capacity,
                               size_t* count) {
  return call_with(__func__, session, [&]() -> Fault {
    if (Fault fault = check_array(contacts, capacity, "contacts")) return fault;
    if (Fault fault = check_pointer(count, "count")) return fault;
    if (Fault fault = check_ticked(*session)) return fault;
    const std::vector<NamedContact> found = all_contacts(session->built->model, session->scratch);
    return hand_over(found, contacts, capacity, count,
                     [&](std::size_t i) { return to_c(*session->built, found[i]); });
  });
}

int lumbrical_session_objects(lumbrical_session* session, lumbrical_object_output* objects, size_t capacity,
                              size_t* count) {
  return call_with(__func__, session, [&]() -> Fault {
    if (Fault fault = check_array(objects, capacity, "objects")) return fault;
    if (Fault fault = check_pointer(count, "count")) return fault;
    if (Fault fault = check_ticked(*session)) return fault;
    const std::vector<ObjectOutput>& rows = session->scratch.object_output;
    return hand_over(rows, objects, capacity, count,
                     [&](std::size_t i) { return capi::to_c(rows[i], session->built->apart_object[i]); });
  });
}

int lumbrical_session_joints(lumbrical_session* session, lumbrical_pose* joints) {
  return call_with(__func__, session, [&]() -> Fault {
    if (Fault fault = check_pointer(joints, "joints")) return fault;
    if (Fault fault = check_ticked(*session)) return fault;
    const auto placed = placed_joints(session->scratch);
    for (std::size_t j = 0; j < placed.size(); ++j) joints[j] = capi::to_c(placed[j]);
    return {};
  });
}

int lumbrical_session_jacobians(lumbrical_session* session, uint32_t segments, double* values,
                                uint32_t* known) {
  return call_with(__func__, session, [&]() -> Fault {
    if (Fault fault = check_pointer(values, "values")) return fault;
    if (Fault fault = check_pointer(known, "known")) return fault;
    if (Fault fault = check_ticked(*session)) return fault;
    std::array<SegmentJacobian, kSegmentCount> jacobians{};
    segment_jacobians(session->built->model, session->scratch, jacobians, segments);
    *known = 0;
    for (std::size_t s = 0; s < kSegmentCount; ++s) {
      std::memcpy(values + 36 * s, jacobians[s].value.data(), 36 * sizeof(double));
      if (jacobians[s].known) *known |= 1u << s;
    }
    return {};
  });
}

int lumbrical_session_save(lumbrical_session* session, void* bytes, size_t capacity, size_t* size) {
  return call_with(__func__, session, [&]() -> Fault {
    if (Fault fault = check_pointer(size, "size")) return fault;
    if (capacity > 0)
      if (Fault fault = check_pointer(bytes, "bytes")) return fault;
    const std::vector<std::uint8_t> snapshot = snapshot_of(session->state);
    auto* const out = static_cast<std::uint8_t*>(bytes);
    return hand_over(snapshot, out, capacity, size, [&](std::size_t i) { return snapshot[i]; });
  });
}

int lumbrical_session_restore(lumbrical_session* session, const void* bytes, size_t size) {
  return call_with(__func__, session, [&]() -> Fault {
    if (Fault fault = check_pointer(bytes, "bytes")) return fault;
    State state;
    if (Fault fault = read_snapshot({static_cast<const std::uint8_t*>(bytes), size}, state)) return fault;
    if (Fault fault = check_state(session->built->model, state)) return fault;
    if (session->recorder)
      return bad_argument("a session can't leave its course while it is recorded; stop the recording first");
    session->state = std::move(state);
    return {};
  });
}

int lumbrical_session_hash(lumbrical_session* session, uint64_t* hash) {
  return call_with(__func__, session, [&]() -> Fault {
    if (Fault fault = check_pointer(hash, "hash")) return fault;
    *hash = hash_state(session->state);
    return {};
  });
}

int lumbrical_session_record(lumbrical_session* session, const char* path,
                             const lumbrical_record_options* options) {
  return call_with(__func__, session, [&]() -> Fault {
    if (Fault fault = check_pointer(path, "path")) return fault;
    RecorderOptions how;
    if (options != nullptr) {
      if (Fault fault = check_struct(options, "options")) return fault;
      if (options->reserved != 0) return bad_argument("options->reserved is not 0");
      how.wait_when_full = options->live == 0;
      how.force_interval = options->force_interval;
    }
    if (session->recorder) return bad_argument("the session is recorded already");
    const Model& model = session->built->model;
    const Status first = check_recording_start(model, session->built->start, session->state);
    if (!first.ok()) return {first, LUMBRICAL_BAD_ARGUMENT};
    auto recorder = std::make_unique<Recorder>();
    if (Fault fault = recorder->open(path, scene_of(model), how)) return fault;
    session->recorder = std::move(recorder);
    session->scratch.hash_stages = true;
    return {};
  });
}

int lumbrical_session_stop_recording(lumbrical_session* session, uint64_t* kept) {
  return call_with(__func__, session, [&]() -> Fault {
    if (!session->recorder) return bad_argument("the session is not recorded");
    const std::unique_ptr<Recorder> recorder = std::move(session->recorder);
    session->scratch.hash_stages = false;
    const Status status = recorder->close();
    if (kept != nullptr) *kept = recorder->kept();
    return status;
  });
}
