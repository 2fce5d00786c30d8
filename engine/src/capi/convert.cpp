// See convert.h.
#include "capi/convert.h"

#include <cstring>

namespace lumbrical::capi {
namespace {

// What OpenXR's header declares, as far as it is read (lumbrical.h tells the offsets).
struct XrLocation {
  std::uint64_t flags;
  float orientation[4];
  float position[3];
  float radius;
};
struct XrLocations {
  std::int32_t type;
  const void* next;
  std::uint32_t is_active;
  std::uint32_t joint_count;
  const XrLocation* location;
};
static_assert(sizeof(XrLocation) == 40);
constexpr std::int32_t kXrLocationsType = 1000051003;
constexpr std::uint64_t kXrOrientationValid = 1, kXrPositionValid = 2;

constexpr double kUnrealUnits = 100;  // to the metre

// Both mirror, so that vectors that stand for rotations turn their sign besides.
Vec3 from_openxr(Convention to, Vec3 v) {
  if (to == Convention::unity) return {v.x, v.y, -v.z};
  if (to == Convention::unreal) return {-v.z, v.x, v.y};
  return v;
}
Vec3 to_openxr(Convention from, Vec3 v) {
  if (from == Convention::unity) return {v.x, v.y, -v.z};
  if (from == Convention::unreal) return {v.y, v.z, -v.x};
  return v;
}

template <class Work>
int convert(const char* function, std::int32_t from, std::int32_t to, const Work& work) noexcept {
  return call(function, [&]() -> Fault {
    Convention a{}, b{};
    if (Fault fault = check_convention(from, "from", a)) return fault;
    if (Fault fault = check_convention(to, "to", b)) return fault;
    return work(a, b);
  });
}

// The three numbers at v.
template <class Number>
void convert_in_place(Convention from, Convention to, Quantity quantity, Number* v) {
  const Vec3 result = converted(from, to, quantity, {v[0], v[1], v[2]});
  v[0] = static_cast<Number>(result.x);
  v[1] = static_cast<Number>(result.y);
  v[2] = static_cast<Number>(result.z);
}

// Of a quaternion its vector.
template <class PoseLike>
void convert_pose(Convention from, Convention to, PoseLike& pose) {
  convert_in_place(from, to, Quantity::position, pose.position);
  convert_in_place(from, to, Quantity::rotation, pose.orientation);
}

}  // namespace

Vec3 to_vec3(const double (&v)[3]) { return {v[0], v[1], v[2]}; }
void to_c(Vec3 v, double (&out)[3]) {
  out[0] = v.x;
  out[1] = v.y;
  out[2] = v.z;
}

Pose to_pose(const lumbrical_pose& pose) {
  const double* const q = pose.orientation;
  return {to_vec3(pose.position), {q[3], q[0], q[1], q[2]}};
}
lumbrical_pose to_c(const Pose& pose) {
  const Quat& q = pose.orientation;
  return {{pose.position.x, pose.position.y, pose.position.z}, {q.x, q.y, q.z, q.w}};
}
lumbrical_wrench to_c(const Wrench& wrench) {
  lumbrical_wrench out;
  to_c(wrench.force, out.force);
  to_c(wrench.torque, out.torque);
  return out;
}

Fault to_frame(const lumbrical_frame* given, DeviceFrame& frame) {
  if (Fault fault = check_struct(given, "frame")) return fault;
  if (Fault fault = check_enum(given->kind, 2, "frame->kind", frame.kind)) return fault;
  frame.base = to_pose(given->base);
  frame.flags = given->flags;
  frame.valid = given->valid;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    std::memcpy(frame.joint[j].position.data(), given->joint[j].position, sizeof given->joint[j].position);
    std::memcpy(frame.joint[j].orientation.data(), given->joint[j].orientation,
                sizeof given->joint[j].orientation);
  }
  std::memcpy(frame.angle.data(), given->angle, sizeof given->angle);
  return {};
}

void to_c(const DeviceFrame& frame, lumbrical_frame& out) {
  out.kind = static_cast<std::int32_t>(frame.kind);
  out.base = to_c(frame.base);
  out.flags = frame.flags;
  out.valid = frame.valid;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    std::memcpy(out.joint[j].position, frame.joint[j].position.data(), sizeof out.joint[j].position);
    std::memcpy(out.joint[j].orientation, frame.joint[j].orientation.data(), sizeof out.joint[j].orientation);
  }
  std::memcpy(out.angle, frame.angle.data(), sizeof out.angle);
}

lumbrical_object_output to_c(const ObjectOutput& output, std::uint32_t object) {
  return {sizeof(lumbrical_object_output), object, to_c(output.pose), to_c(output.wrench), output.coordinate};
}

void to_c(const ActuatorFrame& output, std::size_t object_count, lumbrical_output& out) {
  out.flags = output.flags;
  out.tick = output.tick;
  out.contact_count = output.contact_count;
  out.object_count = static_cast<std::uint32_t>(object_count);
  out.evaluations = output.evaluations;
  out.error_estimate = output.error_estimate;
  out.force_error = output.force_error;
  Vec3 sum;
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    sum += output.segment[s].force;
    out.segment[s] = to_c(output.segment[s]);
    to_c(output.joint_torque[s], out.joint_torque[s]);
    out.flexion_torque[s] = output.flexion_torque[s];
  }
  to_c(sum, out.hand_force);
}

Fault check_convention(std::int32_t value, const char* name, Convention& convention) {
  return check_enum(value, 3, name, convention);
}

Vec3 converted(Convention from, Convention to, Quantity quantity, Vec3 v) {
  if (from == to) return v;
  const bool mirrors = (from == Convention::openxr) != (to == Convention::openxr);
  if (quantity == Quantity::position && from == Convention::unreal) v = v / kUnrealUnits;
  v = from_openxr(to, to_openxr(from, v));
  if (quantity == Quantity::position && to == Convention::unreal) v = kUnrealUnits * v;
  return quantity == Quantity::rotation && mirrors ? -v : v;
}

Pose converted(Convention from, Convention to, const Pose& pose) {
  const Quat& q = pose.orientation;
  const Vec3 v = converted(from, to, Quantity::rotation, {q.x, q.y, q.z});
  return {converted(from, to, Quantity::position, pose.position), {q.w, v.x, v.y, v.z}};
}

Fault read_openxr(const void* locations, DeviceFrame& frame, std::array<double, kJointCount>& radius) {
  if (Fault fault = check_pointer(locations, "xr_hand_joint_locations")) return fault;
  const auto& from = *static_cast<const XrLocations*>(locations);
  if (from.type != kXrLocationsType)
    return bad_argument("xr_hand_joint_locations->type is " + std::to_string(from.type) +
                        ", which is not XR_TYPE_HAND_JOINT_LOCATIONS_EXT");
  if (from.joint_count != kJointCount)
    return bad_argument("xr_hand_joint_locations->jointCount is " + std::to_string(from.joint_count) +
                        "; the default joint set has 26");
  if (Fault fault = check_pointer(from.location, "xr_hand_joint_locations->jointLocations")) return fault;
  frame.kind = InputKind::joint_poses;
  frame.flags = from.is_active != 0 ? 0u : kTrackingLost;
  frame.valid = 0;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const XrLocation& joint = from.location[j];
    constexpr std::uint64_t kWhole = kXrOrientationValid | kXrPositionValid;
    if ((joint.flags & kWhole) == kWhole) frame.valid |= 1u << j;
    std::memcpy(frame.joint[j].position.data(), joint.position, sizeof joint.position);
    std::memcpy(frame.joint[j].orientation.data(), joint.orientation, sizeof joint.orientation);
    radius[j] = joint.radius;
  }
  return {};
}

}  // namespace lumbrical::capi

using namespace lumbrical::capi;

int lumbrical_frame_from_openxr(const void* xr_hand_joint_locations, lumbrical_frame* frame) {
  return call(__func__, [&]() -> Fault {
    if (Fault fault = check_struct(frame, "frame")) return fault;
    lumbrical::DeviceFrame read;
    read.base = to_pose(frame->base);
    std::array<double, lumbrical::kJointCount> radius;
    if (Fault fault = read_openxr(xr_hand_joint_locations, read, radius)) return fault;
    to_c(read, *frame);
    return {};
  });
}

int lumbrical_convert_vectors(int32_t from, int32_t to, int32_t quantity, double* xyz, size_t count) {
  return convert(__func__, from, to, [&](Convention a, Convention b) -> Fault {
    Quantity kind{};
    if (Fault fault = check_enum(quantity, 3, "quantity", kind)) return fault;
    if (count > 0)
      if (Fault fault = check_pointer(xyz, "xyz")) return fault;
    for (std::size_t i = 0; i < count; ++i) convert_in_place(a, b, kind, xyz + 3 * i);
    return {};
  });
}

int lumbrical_convert_poses(int32_t from, int32_t to, lumbrical_pose* poses, size_t count) {
  return convert(__func__, from, to, [&](Convention a, Convention b) -> Fault {
    if (count > 0)
      if (Fault fault = check_pointer(poses, "poses")) return fault;
    for (std::size_t i = 0; i < count; ++i) convert_pose(a, b, poses[i]);
    return {};
  });
}

int lumbrical_convert_frame(int32_t from, int32_t to, lumbrical_frame* frame) {
  return convert(__func__, from, to, [&](Convention a, Convention b) -> Fault {
    if (Fault fault = check_struct(frame, "frame")) return fault;
    convert_pose(a, b, frame->base);
    for (lumbrical_joint& joint : frame->joint) convert_pose(a, b, joint);
    return {};
  });
}

int lumbrical_convert_output(int32_t from, int32_t to, lumbrical_output* output) {
  return convert(__func__, from, to, [&](Convention a, Convention b) -> Fault {
    if (Fault fault = check_struct(output, "output")) return fault;
    convert_in_place(a, b, Quantity::direction, output->hand_force);
    for (lumbrical_wrench& wrench : output->segment) {
      convert_in_place(a, b, Quantity::direction, wrench.force);
      convert_in_place(a, b, Quantity::rotation, wrench.torque);
    }
    for (double(&torque)[3] : output->joint_torque) convert_in_place(a, b, Quantity::rotation, torque);
    return {};
  });
}

int lumbrical_convert_contacts(int32_t from, int32_t to, lumbrical_contact* contacts, size_t count) {
  return convert(__func__, from, to, [&](Convention a, Convention b) -> Fault {
    if (Fault fault = check_array(contacts, count, "contacts")) return fault;
    for (std::size_t i = 0; i < count; ++i) {
      lumbrical_contact& contact = contacts[i];
      convert_in_place(a, b, Quantity::position, contact.centroid);
      convert_in_place(a, b, Quantity::position, contact.centre);
      convert_in_place(a, b, Quantity::direction, contact.normal);
      convert_in_place(a, b, Quantity::direction, contact.force);
    }
    return {};
  });
}
