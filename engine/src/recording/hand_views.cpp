// See hand_views.h.
#include "recording/hand_views.h"

#include <array>
#include <bit>
#include <cstring>

#include "foxglove_bfbs_generated.h"
#include "recording/foxglove_parts.h"
#include "recording/record_fields.h"
#include "recording/scene_views.h"

namespace lumbrical {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;
using foxglove::NumericType;

struct PackedField {
  const char* name;
  NumericType type;
  std::uint32_t size;  // [bytes]
};

constexpr std::array<PackedField, 11> kFields = {{{"x", NumericType::FLOAT64, 8},
                                                  {"y", NumericType::FLOAT64, 8},
                                                  {"z", NumericType::FLOAT64, 8},
                                                  {"force_x", NumericType::FLOAT32, 4},
                                                  {"force_y", NumericType::FLOAT32, 4},
                                                  {"force_z", NumericType::FLOAT32, 4},
                                                  {"depth", NumericType::FLOAT32, 4},
                                                  {"area", NumericType::FLOAT32, 4},
                                                  {"segment", NumericType::UINT32, 4},
                                                  {"object", NumericType::UINT32, 4},
                                                  {"triangle", NumericType::UINT32, 4}}};
constexpr std::size_t kStride = 3 * 8 + 8 * 4;

template <class Number>
void append(Number number, std::vector<std::uint8_t>& bytes) {
  static_assert(std::endian::native == std::endian::little);
  const auto* const raw = reinterpret_cast<const std::uint8_t*>(&number);
  bytes.insert(bytes.end(), raw, raw + sizeof number);
}

template <class Number>
void take(const std::uint8_t*& bytes, Number& number) {
  std::memcpy(&number, bytes, sizeof number);
  bytes += sizeof number;
}

void append(const ContactPoint& point, std::vector<std::uint8_t>& bytes) {
  for (const double x : {point.centre.x, point.centre.y, point.centre.z}) append(x, bytes);
  for (const double x : {point.force.x, point.force.y, point.force.z, point.depth, point.area})
    append(static_cast<float>(x), bytes);
  for (const std::uint32_t number : {point.segment, point.object, point.triangle}) append(number, bytes);
}

ContactPoint point_at(const std::uint8_t* bytes) {
  ContactPoint point;
  for (double* const x : {&point.centre.x, &point.centre.y, &point.centre.z}) take(bytes, *x);
  for (double* const x : {&point.force.x, &point.force.y, &point.force.z, &point.depth, &point.area}) {
    float number = 0;
    take(bytes, number);
    *x = static_cast<double>(number);
  }
  for (std::uint32_t* const number : {&point.segment, &point.object, &point.triangle}) take(bytes, *number);
  return point;
}

// The frame of a device that has the hand where its proxy was.
DeviceFrame frame_of(const ProxyState& proxy) {
  DeviceFrame frame;
  frame.kind = InputKind::joint_poses;
  frame.valid = static_cast<std::uint32_t>(proxy.valid);
  frame.base.position = proxy.joint[kWrist].position;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const auto& [position, orientation] = proxy.joint[j];
    frame.joint[j] = to_joint_pose({position - frame.base.position, orientation});
  }
  return frame;
}

}  // namespace

std::span<const std::uint8_t> view_schema() {
  return {foxglove::PosesInFrameBinarySchema::data(), foxglove::PosesInFrameBinarySchema::size()};
}

HandViewer::HandViewer(const Model& model) : model_(model), has_proxy_(model.settings.proxy_stiffness > 0) {
  model_.settings.proxy_stiffness = 0;  // it follows no one here
  model_.execution.threads = 1;
  scratch_ = make_scratch(model_);
  scratch_.hash_stages = false;
}

// What a hand touches depends on no tick before, but for where objects and its proxy are.
bool HandViewer::place(const TickRecord& record, const State* after) {
  if (has_proxy_ && after == nullptr) return false;
  State state = make_state(model_);
  for (std::size_t i = 0; i < state.objects.size() && i < record.object_count; ++i)
    state.objects[i].pose = record.object[i].pose;
  const bool held = has_proxy_ && after->proxy && after->proxy->valid > 0;
  tick(model_, state, scratch_, held ? frame_of(*after->proxy) : record.device, given_of(record));
  return true;
}

bool HandViewer::pose(std::uint64_t time, FlatBufferBuilder& builder) {
  const Joints& joints = scratch_.primitives->joints;
  if (joints.valid == 0) return false;
  builder.Clear();
  builder.ForceDefaults(true);
  std::vector<Offset<foxglove::Pose>> poses;
  for (const Pose& joint : joints.pose) poses.push_back(to_fb(builder, joint));
  const auto all = builder.CreateVector(poses);
  const auto frame = builder.CreateString(kWorldFrame);
  const foxglove::Time stamp = to_fb(time);
  builder.Finish(foxglove::CreatePosesInFrame(builder, &stamp, frame, all));
  return true;
}

void HandViewer::scene(const ActuatorFrame& output, std::uint64_t time, FlatBufferBuilder& builder) {
  draw_hand(model_, scratch_, output, time, builder);
}

void HandViewer::contacts(std::uint64_t time, FlatBufferBuilder& builder) {
  std::vector<std::uint8_t> data;
  for (const auto& [segment, object, triangle, contact] : all_contacts(model_, scratch_)) {
    const Vec3 force = (model_.settings.stiffness * contact.volume) * contact.normal;
    append({contact.centre, force, contact.depth, contact.area, segment, object, triangle}, data);
  }
  builder.Clear();
  builder.ForceDefaults(true);
  std::vector<Offset<foxglove::PackedElementField>> fields;
  std::uint32_t offset = 0;
  for (const PackedField& field : kFields) {
    fields.push_back(
        foxglove::CreatePackedElementField(builder, builder.CreateString(field.name), offset, field.type));
    offset += field.size;
  }
  const auto all_fields = builder.CreateVector(fields);
  const auto bytes = builder.CreateVector(data);
  const auto frame = builder.CreateString(kWorldFrame);
  const auto origin = to_fb(builder, Pose{});
  const foxglove::Time stamp = to_fb(time);
  builder.Finish(foxglove::CreatePointCloud(builder, &stamp, frame, origin, kStride, all_fields, bytes));
}

Status decode_pose(std::span<const std::uint8_t> bytes, std::vector<Pose>& joints) {
  std::vector<std::uint64_t> aligned;
  const auto* const message = verified<foxglove::PosesInFrame>(bytes, aligned);
  if (message == nullptr || message->poses() == nullptr || message->poses()->size() != kJointCount)
    return Status::error("a posed hand does not fit its schema");
  joints.clear();
  for (const foxglove::Pose* const pose : *message->poses()) {
    const auto* const p = pose->position();
    const auto* const q = pose->orientation();
    if (p == nullptr || q == nullptr) return Status::error("a joint of a posed hand is incomplete");
    joints.push_back({{p->x(), p->y(), p->z()}, {q->w(), q->x(), q->y(), q->z()}});
  }
  return {};
}

Status decode_contacts(std::span<const std::uint8_t> bytes, std::vector<ContactPoint>& points) {
  std::vector<std::uint64_t> aligned;
  const auto* const message = verified<foxglove::PointCloud>(bytes, aligned);
  if (message == nullptr || message->data() == nullptr || message->point_stride() != kStride ||
      message->data()->size() % kStride != 0)
    return Status::error("contact points do not fit their schema");
  points.clear();
  for (std::size_t at = 0; at < message->data()->size(); at += kStride) {
    points.push_back(point_at(message->data()->data() + at));
    if (points.back().segment >= kSegmentCount)
      return Status::error("a contact point is of a segment that no hand has");
  }
  return {};
}

}  // namespace lumbrical
