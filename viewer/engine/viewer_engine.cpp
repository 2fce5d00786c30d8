// The engine inside the viewer's page: it takes the messages of a recording as they stand in the file, and
// answers what a tick looks like. A page writes a message to where `input` says and reads what `answer`
// points at.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lumbrical/model.h"
#include "lumbrical/motion.h"
#include "lumbrical/recording.h"
#include "lumbrical/shapes.h"
#include "lumbrical/tick.h"
#include "model/primitive.h"
#include "model/swept_polygon.h"
#include "recording/session_message.h"
#include "recording/state_message.h"
#include "recording/tick_message.h"
#include "stages/hand_pose.h"
#include "view_generated.h"

#define PAGE_MAY_CALL(name) extern "C" __attribute__((export_name(#name)))

namespace lumbrical {
namespace {

std::vector<std::uint8_t> in, out;
Model model;
State initial_state, state;
bool is_known = true;  // `state` is the session's, not a guess amid it
Scratch scratch;
TickRecord record;
std::optional<Motion> motion;  // moves the lab's hand; none: pointer and sliders do
std::string no_contacts;       // why what it touches is not known, but objects that move; empty: all is

std::span<const std::uint8_t> message(std::uint32_t first, std::uint32_t size) {
  return std::span(in).subspan(first, size);
}

bool answer_text(std::string_view text) {
  out.assign(text.begin(), text.end());
  return false;
}

bool answer_status(const Status& status) { return status.ok() || answer_text(status.message()); }

Status open_session(std::span<const std::uint8_t> session, std::span<const std::uint8_t> first_state,
                    std::uint32_t hand) {
  Scene scene;
  std::optional<Hand> second;
  if (Status status = decode_session(session, scene, &second); !status.ok()) return status;
  if (hand == 1 && second) scene.hand = *second;
  no_contacts.clear();
  if (scene.world) {
    no_contacts = "the recording's world is a file of its own, " + scene.world->path +
                  ", which a page does not have: forces are shown, contacts with it are not";
    scene.world.reset();
    if (scene.settings.proxy_stiffness > 0) scene.objects.clear();  // where a proxy is depends on the world
  }
  initial_state = {};
  if (!first_state.empty()) {
    if (Status status = decode_state(first_state, initial_state); !status.ok()) return status;
  }
  if (Status status = build_model(scene, {}, model); !status.ok()) return status;
  scratch = make_scratch(model);
  if (initial_state.objects.size() != model.apart.size()) initial_state.objects = make_state(model).objects;
  return {};
}

Status run_tick(std::span<const std::uint8_t> bytes) {
  InputCheck check;
  if (Status status = decode_tick(bytes, record, check); !status.ok()) return status;
  const std::uint64_t recorded = record.output.tick;
  if (recorded != state.tick)
    return Status::error("tick " + std::to_string(recorded) + " came where tick " +
                         std::to_string(state.tick) + " was due");
  // Amid a session objects are where they were recorded; what else is carried from tick to tick is known from
  // the first tick on that has it beside it.
  const bool is_moved_here = is_known && no_contacts.empty();
  for (std::size_t i = 0; !is_moved_here && i < state.objects.size() && i < record.object_count; ++i)
    state.objects[i].pose = record.object[i].pose;
  record.output = tick(model, state, scratch, record.device, given_of(record));
  std::optional<State> after;
  if (Status status = decode_state_after(bytes, after); !status.ok()) return status;
  if (!is_known && after && after->objects.size() == model.apart.size()) {
    state = std::move(*after);
    is_known = true;
  }
  return {};
}

std::string_view first_difference() {
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    if (scratch.stage_hash[stage] != record.stage_hash[stage]) return stage_name(static_cast<Stage>(stage));
  }
  return hash_state(state) == record.state_hash ? "" : "state";
}

fb::Vec3 to_fb(Vec3 v) { return {v.x, v.y, v.z}; }

std::vector<fb::Vec3> to_fb(std::span<const Vec3> points) {
  std::vector<fb::Vec3> result;
  for (const Vec3& point : points) result.push_back(to_fb(point));
  return result;
}

std::vector<fb::Vec3> joint_positions(const Joints& joints) {
  std::vector<fb::Vec3> result;
  for (int j = 0; j < kJointCount; ++j) result.push_back(to_fb(joints.position(j)));
  return result;
}

bool is_placed() {
  constexpr std::uint32_t kNowhere = kInputNotFinite | kInputImplausible | kInputLost;
  return (scratch.primitives->flags & kNowhere) == 0;
}

/// No joint of a hand that could not be placed: what is in `scratch` then is of another tick.
const Primitives& placed_hand() {
  static const Primitives kNobody;
  if (!is_placed()) return kNobody;
  place_axes(*scratch.primitives);  // a tick leaves them out far from everything
  return *scratch.primitives;
}

/// As the device told them, where a proxy stands in their place.
std::vector<fb::Vec3> tracked_joints() {
  if (!scratch.proxy || !is_placed()) return {};
  Primitives tracked;
  static_cast<void>(place_hand(model.hand, model.settings, record.device, tracked));
  return joint_positions(tracked.joints);
}

std::vector<fb::Phalanx> phalanges(const Primitives& hand) {
  std::vector<fb::Phalanx> result;
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    const Primitive& whole = hand.capsule[i];
    if (!hand.present[i]) continue;
    result.emplace_back(to_fb(whole.end1), to_fb(whole.end2), whole.radius1, whole.radius2,
                        static_cast<std::uint32_t>(i));
  }
  return result;
}

/// Whether objects are where they were, and so what touches them.
bool knows_objects() {
  return no_contacts.empty() || (!model.apart.empty() && record.object_count == model.apart.size());
}

/// To the page the world is object 0.
std::vector<fb::Contact> contacts() {
  const auto of_world = static_cast<std::uint32_t>(model.objects.size());
  std::vector<fb::Contact> result;
  if (!knows_objects()) return result;
  for (const NamedContact& named : all_contacts(model, scratch)) {
    const Contact& contact = named.contact;
    result.emplace_back(contact.primitive, named.segment, contact.triangle, contact.depth, contact.area,
                        contact.volume, contact.error, to_fb(contact.centroid), to_fb(contact.centre),
                        to_fb(contact.normal), named.object < of_world ? 0 : named.object - of_world + 1);
  }
  return result;
}

std::vector<fb::SegmentOutput> segments(const HandForces& forces) {
  std::vector<fb::SegmentOutput> result;
  if (!no_contacts.empty()) return result;
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    const auto& [force, torque] = forces.segment[s];
    result.emplace_back(static_cast<std::uint32_t>(s), to_fb(force), to_fb(torque),
                        to_fb(forces.joint_torque[s]), forces.flexion_torque[s]);
  }
  return result;
}

void answer_view() {
  // Before the hash of stages is of other contacts.
  const std::string_view differs = no_contacts.empty() ? first_difference() : "";
  const auto found = contacts();
  const Primitives& hand = placed_hand();
  // A tick that has no need of the palm does not place it.
  const SweptPolygon palm =
      hand.joints.has(kPalm) ? place_palm(model.hand.palm, hand.joints.pose[kPalm]) : SweptPolygon{};
  flatbuffers::FlatBufferBuilder builder(1 << 16);
  const auto joints = builder.CreateVectorOfStructs(joint_positions(hand.joints));
  const auto shapes = builder.CreateVectorOfStructs(phalanges(hand));
  const auto corners = builder.CreateVectorOfStructs(to_fb(std::span(palm.corner).first(palm.corner_count)));
  const auto touched = builder.CreateVectorOfStructs(found);
  const auto all_segments = builder.CreateVectorOfStructs(segments(record.output));
  const auto bases = builder.CreateVectorOfStructs(to_fb(hand.base_joint));
  const auto axes = builder.CreateVectorOfStructs(to_fb(hand.flexion_axis));
  const auto tracked = builder.CreateVectorOfStructs(tracked_joints());
  const auto text = differs.empty() ? 0 : builder.CreateString(differs.data(), differs.size());
  builder.Finish(fb::CreateTickView(builder, record.output.tick, joints, hand.joints.valid, shapes, corners,
                                    palm.radius, touched, all_segments, bases, axes, text, tracked,
                                    knows_objects()));
  out.assign(builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize());
}

/// A file that the page has put into `input` behind its name and a line's end. Formats without a word of
/// their own at the start are told by the name.
struct NamedFile {
  std::string name;
  std::string_view content;
};

NamedFile named_file(std::uint32_t size) {
  const std::string_view text(reinterpret_cast<const char*>(in.data()), size);
  const std::size_t end = std::min(text.find('\n'), text.size());
  return {std::string(text.substr(0, end)), text.substr(std::min(end + 1, text.size()))};
}

/// What the lab lets a hand touch, in the order of its list; the last is the mesh the page has put into
/// `input`.
bool lab_object(std::uint32_t which, std::uint32_t size, double metres, SceneObject& object) {
  switch (which) {
    case 0:
      object = {"mug", make_mug({})};
      return true;
    case 1:
      object = {"sphere", make_sphere(0.04, 24)};
      return true;
    case 2:
      object = {"box", make_box({0.08, 0.08, 0.08}, 12)};
      return true;
    case 3:
      object = {"bumpy field", make_height_field(0.3, 69, 0.003, 0.04)};
      return true;
    default:
      break;
  }
  const NamedFile file = named_file(size);
  object.name = file.name;
  Status status = parse_mesh(file.content, object.name, Unit::metre, object.mesh);
  if (!status.ok()) return answer_status(status);
  Box box;
  for (const Vec3& v : object.mesh.vertices) box.add(v);
  const Vec3 extent = box.upper - box.lower;
  const double scale = metres / std::max({extent.x, extent.y, extent.z, 1e-12});
  for (Vec3& v : object.mesh.vertices) v = scale * (v - 0.5 * (box.lower + box.upper));
  return true;
}

/// X_BH of the wrist joint.
Pose wrist_of(const DeviceFrame& frame) {
  if (frame.kind == InputKind::joint_angles) return frame.base;
  const auto& [p, q] = frame.joint[kWrist];
  return frame.base * Pose{{p[0], p[1], p[2]}, {q[3], q[0], q[1], q[2]}};
}

Status read_motion_of(const NamedFile& file, const MotionOptions& options) {
  Motion read;
  if (Status status = parse_motion(file.content, file.name, options, read); !status.ok()) return status;
  // Captures stand anywhere in their rooms: this one starts where the page has the hand.
  const Pose start = inverse(wrist_of(read.samples.front().frame));
  const Pose unit = {start.position, normalized(start.orientation)};
  if (Status status = place_motion({unit}, read); !status.ok()) return status;
  motion = std::move(read);
  return {};
}

/// Over and over, from tick to tick at the session's rate.
DeviceFrame motion_frame(const Pose& X_WM) {
  const double time = static_cast<double>(state.tick) / model.settings.rate;
  const double period = duration(*motion);
  DeviceFrame frame = resample(*motion, period > 0 ? std::fmod(time, period) : 0);
  frame.base = X_WM * frame.base;
  frame.base.orientation = normalized(frame.base.orientation);
  return frame;
}

/// What a headset tells, read as any capture of WebXR. A hand that is not in it is lost where it was last.
DeviceFrame tracked_frame(std::string_view text, const DeviceFrame& last) {
  MotionOptions options;
  options.side = model.hand.side;
  Motion seen;
  if (parse_motion(text, "hand tracking", options, seen).ok()) return seen.samples.front().frame;
  DeviceFrame frame = last;
  frame.flags |= kTrackingLost;
  return frame;
}

/// The lab's hand: X_WH of the wrist (position, then w x y z) and angles as doubles in `input`; behind them
/// what a headset tells, which then counts instead.
DeviceFrame lab_frame(std::uint32_t size, const DeviceFrame& last) {
  std::array<double, 7 + kAngleCount> numbers{};
  const std::size_t head = std::min<std::size_t>(size, sizeof numbers);
  std::memcpy(numbers.data(), in.data(), head);
  if (size > head) return tracked_frame({reinterpret_cast<const char*>(in.data()) + head, size - head}, last);
  const Pose X_WH = {{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5], numbers[6]}};
  if (motion) return motion_frame(X_WH);
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  frame.base = X_WH;
  for (std::size_t i = 0; i < kAngleCount; ++i) frame.angle[i] = static_cast<float>(numbers[7 + i]);
  return frame;
}

}  // namespace

/// Where the next message of so many bytes goes.
PAGE_MAY_CALL(input) std::uint8_t* input_of(std::uint32_t size) {
  in.resize(size);
  return in.data();
}

PAGE_MAY_CALL(answer) const std::uint8_t* answer_data() { return out.data(); }
PAGE_MAY_CALL(answer_size) std::uint32_t answer_size() { return static_cast<std::uint32_t>(out.size()); }

// Those that can fail return false, and the answer is then the error's text. Where memory ends they throw.

/// A session message and behind it, of `state_size` bytes, the state before the first tick, if any; `hand` of
/// two is the one whose ticks are to come. The answer is why contacts are not known; nothing: they are.
PAGE_MAY_CALL(open)
bool open_recording(std::uint32_t session_size, std::uint32_t state_size, std::uint32_t hand) {
  if (!answer_status(open_session(message(0, session_size), message(session_size, state_size), hand)))
    return false;
  answer_text(no_contacts);
  return true;
}

/// The next message is that of this tick, a whole number below 2^53: with the state the file begins with
/// where it is the file's first.
PAGE_MAY_CALL(begin) void begin_at(double tick, bool first) {
  state = first ? initial_state : make_state(model);
  is_known = first;
  state.tick = static_cast<std::uint64_t>(tick);
}

/// Computes a tick and answers nothing.
PAGE_MAY_CALL(pass) bool pass_tick(std::uint32_t size) { return answer_status(run_tick(message(0, size))); }

/// Whether the state after the last tick is the recorded one, or no matter, since the hand alone is placed.
PAGE_MAY_CALL(is_recorded_state) bool has_recorded_state() {
  return !no_contacts.empty() || hash_state(state) == record.state_hash;
}

/// Computes a tick and answers a TickView of it.
PAGE_MAY_CALL(show) bool show_tick(std::uint32_t size) {
  if (!pass_tick(size)) return false;
  answer_view();
  return true;
}

/// Answers which results ticks have here.
PAGE_MAY_CALL(arithmetic) void answer_arithmetic() { answer_text(arithmetic_version()); }

// ---- The lab: a session made in the page
// --------------------------------------------------------------------------

/// From now on the motion file in `input` moves the hand. `side`: 0 that which the file tells, 1 right, 2
/// left; `unit` [m] per number of the file, 0 its own.
PAGE_MAY_CALL(read_motion) bool read_lab_motion(std::uint32_t size, std::uint32_t side, double unit) {
  MotionOptions options;
  options.unit = unit;
  if (side != 0) options.side = side == 1 ? Side::right : Side::left;
  return answer_status(read_motion_of(named_file(size), options));
}

/// Answers the session message of an object and a right hand, or that of the motion; `metres` is the largest
/// extent of a mesh in `input`.
PAGE_MAY_CALL(make_session)
bool make_lab_session(std::uint32_t which, std::uint32_t size, double metres, std::uint32_t law,
                      double precision, double stiffness, double rate) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  if (motion) scene.hand = fit_hand(scene.hand, *motion);
  scene.objects.resize(1);
  if (!lab_object(which, size, metres, scene.objects[0])) return false;
  scene.settings.law.fill(static_cast<Law>(law));
  scene.settings.precision.fill(precision);
  scene.settings.stiffness = stiffness;
  scene.settings.rate = rate;
  return answer_status(encode_session(scene, out));
}

/// Answers the schema of tick messages.
PAGE_MAY_CALL(schema) void answer_schema() {
  const auto bytes = tick_schema();
  out.assign(bytes.begin(), bytes.end());
}

/// Computes the next tick of the lab's hand and answers its message, as a recording holds it.
PAGE_MAY_CALL(touch) void touch_with_hand(std::uint32_t size) {
  const DeviceFrame frame = lab_frame(size, record.device);
  record = {};
  record.device = frame;
  record.output = tick(model, state, scratch, record.device, given_of(record));
  take_results(state, scratch, record);
  flatbuffers::FlatBufferBuilder builder;
  encode_tick(record, true, input_check_of(record), builder);
  out.assign(builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize());
}

/// Answers a TickView of the last tick.
PAGE_MAY_CALL(look) void look_at_tick() { answer_view(); }

}  // namespace lumbrical
