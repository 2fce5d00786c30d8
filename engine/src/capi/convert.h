// Between the structs of lumbrical.h and the engine's.
#pragma once

#include "capi/boundary.h"

namespace lumbrical::capi {

Vec3 to_vec3(const double (&v)[3]);
void to_c(Vec3 v, double (&out)[3]);
Pose to_pose(const lumbrical_pose& pose);
lumbrical_pose to_c(const Pose& pose);
lumbrical_wrench to_c(const Wrench& wrench);

/// Refuses another size, and a kind that is none.
Fault to_frame(const lumbrical_frame* given, DeviceFrame& frame);
void to_c(const DeviceFrame& frame, lumbrical_frame& out);
lumbrical_object_output to_c(const ObjectOutput& output, std::uint32_t object);
void to_c(const ActuatorFrame& output, std::size_t object_count, lumbrical_output& out);

/// Whose axes and unit. What is mirrored keeps its handedness in numbers: torques, quaternions.
enum class Convention : std::uint8_t { openxr, unity, unreal };
enum class Quantity : std::uint8_t { position, direction, rotation };
Fault check_convention(std::int32_t value, const char* name, Convention& convention);
Vec3 converted(Convention from, Convention to, Quantity quantity, Vec3 v);
Pose converted(Convention from, Convention to, const Pose& pose);

/// Of an XrHandJointLocationsEXT: poses, which of them are valid, and radii [m].
Fault read_openxr(const void* locations, DeviceFrame& frame, std::array<double, kJointCount>& radius);

}  // namespace lumbrical::capi
