// A scene as a FlatBuffer (schemas/recording.fbs, table Session) and back, every bit of it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lumbrical/model.h"
#include "lumbrical/status.h"

namespace lumbrical {

inline constexpr const char* kSessionAttachment = "session";

/// Of the format, which the session states; readers refuse any other (docs/recording.md).
inline constexpr std::uint32_t kVersion = 1;

/// Refuses a scene of 2 GiB or more, which a FlatBuffer can't hold. Of a scene with a world file that file is
/// named. `second` is there in a session of two hands.
Status encode_session(const Scene& scene, std::vector<std::uint8_t>& bytes,
                      const std::optional<Hand>& second = {});

/// The error tells what is wrong, not where. Checks everything but the meshes, which build_model checks. A
/// world file is only named (World::bytes is null). `second` may be null.
Status decode_session(std::span<const std::uint8_t> bytes, Scene& scene,
                      std::optional<Hand>* second = nullptr);

}  // namespace lumbrical
