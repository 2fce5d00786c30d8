// See tick_trace.h.
#include "tick/tick_trace.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "index/cluster_tree.h"
#include "model/primitive.h"
#include "stages/contact_force.h"

namespace lumbrical {
namespace {

class Tracer {
 public:
  std::vector<TraceValue> values;
  std::int64_t primitive = -1, triangle = -1;
  std::size_t members = 0;
  std::int32_t index = -1;
  const char* part = "";

  void pair(const ClusterTree& clusters, std::uint32_t of, std::uint32_t with) {
    primitive = of;
    triangle = with;
    members = (with & kClusterBit) != 0 ? triangles_of(clusters, cluster_of(with)).size() : 0;
  }
  void whole(const char* name, std::uint64_t value) { add(name, TraceValue::Type::whole, value); }
  void real(const char* name, double value) {
    add(name, TraceValue::Type::real, std::bit_cast<std::uint64_t>(value));
  }
  void real32(const char* name, float value) {
    add(name, TraceValue::Type::real32, std::bit_cast<std::uint32_t>(value));
  }
  void vector(const std::array<const char*, 3>& names, Vec3 v) {
    real(names[0], v.x);
    real(names[1], v.y);
    real(names[2], v.z);
  }

 private:
  void add(const char* name, TraceValue::Type type, std::uint64_t bits) {
    values.push_back({name, part, index, primitive, triangle, members, type, bits});
  }
};

void trace_input(const DeviceFrame& frame, Tracer& to) {
  to.vector({"base.position.x", "base.position.y", "base.position.z"}, frame.base.position);
  const Quat q = frame.base.orientation;
  to.real("base.orientation.w", q.w);
  to.vector({"base.orientation.x", "base.orientation.y", "base.orientation.z"}, {q.x, q.y, q.z});
  to.whole("kind", static_cast<std::uint64_t>(frame.kind));
  to.whole("flags", frame.flags);
  to.whole("valid", frame.valid);
  for (to.index = 0; to.index < kJointCount; ++to.index) {
    const JointPose& joint = frame.joint[static_cast<std::size_t>(to.index)];
    const auto& [px, py, pz] = joint.position;
    const auto& [qx, qy, qz, qw] = joint.orientation;
    to.real32("joint.position.x", px);
    to.real32("joint.position.y", py);
    to.real32("joint.position.z", pz);
    to.real32("joint.orientation.x", qx);
    to.real32("joint.orientation.y", qy);
    to.real32("joint.orientation.z", qz);
    to.real32("joint.orientation.w", qw);
  }
  for (to.index = 0; to.index < kAngleCount; ++to.index)
    to.real32("angle", frame.angle[static_cast<std::size_t>(to.index)]);
}

void trace_unshaped(const Primitives& hand, Tracer& to) {
  for (to.index = 0; to.index < kPhalanxCount; ++to.index) {
    const auto i = static_cast<std::size_t>(to.index);
    if (!hand.present[i]) continue;
    const Primitive& capsule = hand.capsule[i];
    to.vector({"phalanx.end1.x", "phalanx.end1.y", "phalanx.end1.z"}, capsule.end1);
    to.vector({"phalanx.end2.x", "phalanx.end2.y", "phalanx.end2.z"}, capsule.end2);
    to.real("phalanx.radius1", capsule.radius1);
    to.real("phalanx.radius2", capsule.radius2);
  }
  to.index = -1;
  if (!hand.joints.has(kPalm)) return;
  const auto& [position, orientation] = hand.joints.pose[kPalm];
  to.vector({"palm.position.x", "palm.position.y", "palm.position.z"}, position);
  to.real("palm.orientation.w", orientation.w);
  to.vector({"palm.orientation.x", "palm.orientation.y", "palm.orientation.z"},
            {orientation.x, orientation.y, orientation.z});
}

void trace_palm(const SweptPolygon& palm, Tracer& to) {
  to.whole("palm_corner_count", static_cast<std::uint64_t>(palm.corner_count));
  for (to.index = 0; to.index < palm.corner_count; ++to.index) {
    const auto i = static_cast<std::size_t>(to.index);
    to.vector({"palm_corner.x", "palm_corner.y", "palm_corner.z"}, palm.corner[i]);
    to.vector({"palm_outward.x", "palm_outward.y", "palm_outward.z"}, palm.outward[i]);
  }
  to.index = -1;
  to.vector({"palm_normal.x", "palm_normal.y", "palm_normal.z"}, palm.normal);
  to.real("palm_radius", palm.radius);
}

void trace_hand(const Primitives& hand, Tracer& to) {
  to.whole("primitive_count", static_cast<std::uint64_t>(hand.count));
  for (to.primitive = 0; to.primitive < hand.count; ++to.primitive) {
    const Primitive& primitive = hand.primitive[static_cast<std::size_t>(to.primitive)];
    to.vector({"end1.x", "end1.y", "end1.z"}, primitive.end1);
    to.vector({"end2.x", "end2.y", "end2.z"}, primitive.end2);
    to.real("radius1", primitive.radius1);
    to.real("radius2", primitive.radius2);
    for (to.index = 0; to.index < primitive.cut_count; ++to.index) {
      const HalfSpace& cut = primitive.cut[static_cast<std::size_t>(to.index)];
      to.vector({"cut.normal.x", "cut.normal.y", "cut.normal.z"}, cut.normal);
      to.vector({"cut.point.x", "cut.point.y", "cut.point.z"}, cut.point);
    }
    to.index = -1;
  }
  to.primitive = -1;
  if (hand.out_of_reach) trace_unshaped(hand, to);
  if (hand.palm.corner_count > 0) trace_palm(hand.palm, to);
  for (to.index = 0; to.index < kSegmentCount; ++to.index) {
    const auto s = static_cast<std::size_t>(to.index);
    to.vector({"base_joint.x", "base_joint.y", "base_joint.z"}, hand.base_joint[s]);
    to.vector({"flexion_axis.x", "flexion_axis.y", "flexion_axis.z"}, hand.flexion_axis[s]);
  }
}

void trace_contacts(const ClusterTree& clusters, std::span<const Contact> contacts, Tracer& to) {
  for (const Contact& contact : contacts) {
    to.pair(clusters, contact.primitive, contact.triangle);
    to.real("depth", contact.depth);
    to.real("area", contact.area);
    to.real("volume", contact.volume);
    to.real("error", contact.error);
    to.vector({"centroid.x", "centroid.y", "centroid.z"}, contact.centroid);
    to.vector({"centre.x", "centre.y", "centre.z"}, contact.centre);
    to.vector({"normal.x", "normal.y", "normal.z"}, contact.normal);
  }
}

void trace_forces(const HandForces& forces, Tracer& to) {
  for (to.index = 0; to.index < kSegmentCount; ++to.index) {
    const auto s = static_cast<std::size_t>(to.index);
    to.vector({"segment.force.x", "segment.force.y", "segment.force.z"}, forces.segment[s].force);
    to.vector({"segment.torque.x", "segment.torque.y", "segment.torque.z"}, forces.segment[s].torque);
    to.vector({"joint_torque.x", "joint_torque.y", "joint_torque.z"}, forces.joint_torque[s]);
    to.real("flexion_torque", forces.flexion_torque[s]);
  }
  to.index = -1;
}

void trace_limits(const ActuatorFrame& output, Tracer& to) {
  to.whole("flags", output.flags);
  to.whole("contact_count", output.contact_count);
  to.real("force_error", output.force_error);
  trace_forces(output, to);
}

// Monotonic in the number: neighbours of a type are one apart.
template <class Real, class Bits>
std::optional<std::uint64_t> distance(std::uint64_t a, std::uint64_t b) {
  constexpr Bits kSign = Bits{1} << (8 * sizeof(Bits) - 1);
  const auto place = [](Bits bits) { return (bits & kSign) != 0 ? ~bits : bits | kSign; };
  const Bits bits_a = static_cast<Bits>(a), bits_b = static_cast<Bits>(b);
  if (std::isnan(std::bit_cast<Real>(bits_a)) || std::isnan(std::bit_cast<Real>(bits_b))) return std::nullopt;
  const Bits place_a = place(bits_a), place_b = place(bits_b);
  return place_a > place_b ? place_a - place_b : place_b - place_a;
}

}  // namespace

bool TraceValue::same_place(const TraceValue& other) const {
  return primitive == other.primitive && triangle == other.triangle && index == other.index &&
         type == other.type && std::strcmp(name, other.name) == 0 && std::strcmp(part, other.part) == 0;
}

std::string TraceValue::field() const {
  std::string text = name;
  if (index >= 0)
    text.insert(text.find('.') == std::string::npos ? text.size() : text.find('.'),
                "[" + std::to_string(index) + "]");
  return *part == 0 ? text : part + ("." + text);
}

std::vector<TraceValue> trace_stage(const Model& model, const Scratch& scratch, const DeviceFrame& frame,
                                    const ActuatorFrame& output, Stage stage) {
  Tracer to;
  const std::span<const Contact> contacts(scratch.contacts.data(), scratch.contact_count);
  switch (stage) {
    case Stage::input:
      trace_input(frame, to);
      break;
    case Stage::hand_pose:
      trace_hand(*scratch.primitives, to);
      break;
    case Stage::broadphase:
      for (std::uint32_t i = 0; i < scratch.candidate_count; ++i) {
        const std::uint64_t pair = scratch.candidates[i];
        to.pair(model.clusters, static_cast<std::uint32_t>(pair >> 32), static_cast<std::uint32_t>(pair));
        to.whole("candidate", 1);
      }
      break;
    case Stage::narrowphase:
      trace_contacts(model.clusters, contacts, to);
      break;
    case Stage::contact_force:
      trace_forces(sum_forces(model.settings, *scratch.primitives, contacts), to);
      break;
    case Stage::limits:
      trace_limits(output, to);
      break;
  }
  return std::move(to.values);
}

std::vector<TraceValue> trace_state(const State& state) {
  Tracer to;
  to.whole("tick", state.tick);
  to.real("rise", state.rise);
  to.real("fall", state.fall);
  to.part = "last";
  trace_forces(state.last, to);
  to.part = "held";
  trace_forces(state.held, to);
  return std::move(to.values);
}

std::optional<std::uint64_t> ulps_between(TraceValue::Type type, std::uint64_t a, std::uint64_t b) {
  if (type == TraceValue::Type::real) return distance<double, std::uint64_t>(a, b);
  if (type == TraceValue::Type::real32) return distance<float, std::uint32_t>(a, b);
  return std::nullopt;
}

}  // namespace lumbrical
