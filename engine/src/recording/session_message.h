// A scene as a FlatBuffer (schemas/recording.fbs, table Session) and back, every bit of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/model.h"
#include "lumbrical/tick.h"

namespace lumbrical {

inline constexpr const char* kSessionAttachment = "session";

/// Versions of the format, which the session states.
inline constexpr std::uint32_t kFirstVersion = 1;  ///< every tick has its forces
// 2: ticks may leave out forces, and then say so
inline constexpr std::uint32_t kVersion = 3;    ///< as 2, other hashes; what is written now
inline constexpr std::uint32_t kWorldFile = 4;  ///< as 3, of a scene whose world is a file of its own
inline constexpr std::uint32_t kLastVersion = kWorldFile;

constexpr HashKind hash_kind_of(std::uint32_t version) {
  return version < 3 ? HashKind::former : HashKind::current;
}

/// Refuses a scene of 2 GiB or more, which a FlatBuffer can't hold. Of a scene with a world file that file is
/// named, and the version is kWorldFile whatever `version` is.
Status encode_session(const Scene& scene, std::uint32_t version, std::vector<std::uint8_t>& bytes);

/// The error tells what is wrong, not where. Checks everything but the meshes, which build_model checks. A
/// world file is only named (World::bytes is null).
Status decode_session(std::span<const std::uint8_t> bytes, Scene& scene, std::uint32_t& version);

}  // namespace lumbrical
