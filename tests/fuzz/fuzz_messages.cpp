// Fuzzes the FlatBuffers messages of a recording: ticks, sessions, states, posed hands, contact points, drawn
// scenes. What is taken of a session must come out again.
#include "flatbuffers/flatbuffers.h"
#include "fuzz_input.h"
#include "recording/hand_views.h"
#include "recording/scene_views.h"
#include "recording/session_message.h"
#include "recording/state_message.h"
#include "recording/tick_message.h"

namespace {

using namespace lumbrical;

void tick_message(std::span<const std::uint8_t> bytes) {
  TickRecord record, again;
  InputCheck check, check_again;
  if (!decode_tick(bytes, record, check).ok()) return;
  // The one number in a table's field: its -0, which no sum of bounds is, would come back as +0.
  if (record.output.force_error == 0) record.output.force_error = 0;
  flatbuffers::FlatBufferBuilder builder;
  encode_tick(record, record.has_forces, check, builder);
  if (!decode_tick({builder.GetBufferPointer(), builder.GetSize()}, again, check_again).ok() ||
      input_fields(record) != input_fields(again) || record.has_forces != again.has_forces ||
      output_fields(record.output) != output_fields(again.output) || !(check == check_again))
    __builtin_trap();
}

void session_message(std::span<const std::uint8_t> bytes) {
  Scene scene, again;
  if (!decode_session(bytes, scene).ok()) return;
  std::vector<std::uint8_t> encoded;
  if (!encode_session(scene, encoded).ok()) return;
  if (!decode_session(encoded, again).ok()) __builtin_trap();
  if (scene.settings.max_candidates > 1u << 16) return;
  Model model;
  static_cast<void>(build_model(scene, {}, model).ok());
}

void state_message(std::span<const std::uint8_t> bytes) {
  State state, again;
  if (!decode_state(bytes, state).ok()) return;
  if (!decode_state(encode_state(state), again).ok() || hash_state(state) != hash_state(again))
    __builtin_trap();
}

void views(std::span<const std::uint8_t> bytes) {
  std::vector<Pose> joints;
  if (decode_pose(bytes, joints).ok() && joints.size() != kJointCount) __builtin_trap();
  static_cast<void>(check_scene(bytes).ok());
  static_cast<void>(check_transforms(bytes).ok());
  std::vector<ContactPoint> points;
  if (!decode_contacts(bytes, points).ok()) return;
  for (const ContactPoint& point : points)
    if (point.segment >= kSegmentCount) __builtin_trap();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  switch (data[0] % 4) {
    case 0:
      tick_message(bytes);
      break;
    case 1:
      session_message(bytes);
      break;
    case 2:
      state_message(bytes);
      break;
    default:
      views(bytes);
  }
  return 0;
}
