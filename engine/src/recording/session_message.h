// A scene as a FlatBuffer (schemas/recording.fbs, table Session) and back, every bit of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/model.h"

namespace lumbrical {

inline constexpr const char* kSessionAttachment = "session";

/// Refuses a scene of 2 GiB or more, which a FlatBuffer can't hold.
Status encode_session(const Scene& scene, std::vector<std::uint8_t>& bytes);

/// The error tells what is wrong, not where. Checks everything but the meshes, which build_model checks.
Status decode_session(std::span<const std::uint8_t> bytes, Scene& scene);

}  // namespace lumbrical
