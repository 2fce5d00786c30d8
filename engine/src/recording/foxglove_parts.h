// What all messages of schemas/foxglove.fbs share: times, poses, and how their bytes are checked.
#pragma once

#include <cstdint>

#include "base/message_alignment.h"
#include "foxglove_generated.h"
#include "lumbrical/math.h"

namespace lumbrical {

inline constexpr const char* kWorldFrame = "world";

/// Of session time [ns].
inline foxglove::Time to_fb(std::uint64_t time) {
  constexpr std::uint64_t kSecond = 1000000000;
  return {static_cast<std::uint32_t>(time / kSecond), static_cast<std::uint32_t>(time % kSecond)};
}

inline flatbuffers::Offset<foxglove::Vector3> to_fb(flatbuffers::FlatBufferBuilder& builder, Vec3 v) {
  return foxglove::CreateVector3(builder, v.x, v.y, v.z);
}

inline flatbuffers::Offset<foxglove::Quaternion> to_fb(flatbuffers::FlatBufferBuilder& builder, Quat q) {
  return foxglove::CreateQuaternion(builder, q.x, q.y, q.z, q.w);
}

inline flatbuffers::Offset<foxglove::Pose> to_fb(flatbuffers::FlatBufferBuilder& builder, const Pose& pose) {
  const auto position = to_fb(builder, pose.position);
  const auto orientation = to_fb(builder, pose.orientation);
  return foxglove::CreatePose(builder, position, orientation);
}

}  // namespace lumbrical
