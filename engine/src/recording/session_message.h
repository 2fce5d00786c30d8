// A scene as a FlatBuffer (schemas/recording.fbs, table Session) and back, every bit of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/model.h"

namespace lumbrical {

inline constexpr const char* kSessionAttachment = "session";

/// Versions of the format, which the session states.
inline constexpr std::uint32_t kEveryForce = 1;  ///< every tick has its forces
inline constexpr std::uint32_t kSomeForces = 2;  ///< some ticks leave them out, and say so
inline constexpr std::uint32_t kWorldFile = 3;   ///< as 2, and the world is a file of its own

/// Refuses a scene of 2 GiB or more, which a FlatBuffer can't hold. Of a scene with a world file that file is
/// named, and the version is kWorldFile whatever `version` is.
Status encode_session(const Scene& scene, std::uint32_t version, std::vector<std::uint8_t>& bytes);

/// The error tells what is wrong, not where. Checks everything but the meshes, which build_model checks. A
/// world file is only named (World::bytes is null).
Status decode_session(std::span<const std::uint8_t> bytes, Scene& scene, std::uint32_t& version);

}  // namespace lumbrical
