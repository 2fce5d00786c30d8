// A session as other programs draw it, in three kinds of messages that Foxglove knows (schemas/foxglove.fbs):
// the objects once, each in a frame of its own, where those frames are, and the hand with its forces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "lumbrical/model.h"
#include "lumbrical/recording.h"
#include "lumbrical/tick.h"
#include "recording/mcap_format.h"

namespace flatbuffers {
class FlatBufferBuilder;
}

namespace lumbrical {

inline constexpr std::string_view kSceneSchemaName = "foxglove.SceneUpdate";
inline constexpr std::string_view kTransformsSchemaName = "foxglove.FrameTransforms";

/// [m/N] length of a force's arrow.
inline constexpr double kArrowScale = 0.005;

/// Refuses objects whose message would be larger than any that can be read.
Status check_drawable(const Scene& scene, std::size_t most_bytes = mcap::kLargestMessage);

// Each clears the builder and leaves its message in it; `time` is session time [ns].

/// All objects of a scene that check_drawable lets pass.
void draw_objects(const Scene& scene, std::uint64_t time, flatbuffers::FlatBufferBuilder& builder);
/// Where the objects felt apart are.
void draw_transforms(const TickRecord& record, std::uint64_t time, flatbuffers::FlatBufferBuilder& builder);
/// The hand where the last tick on `scratch` had it, and the forces that the recorded one put out. One that
/// could not be placed is taken away.
void draw_hand(const Model& model, Scratch& scratch, const ActuatorFrame& output, std::uint64_t time,
               flatbuffers::FlatBufferBuilder& builder);

/// Whether a message can be drawn as it stands; the error tells what is wrong, not where.
Status check_scene(std::span<const std::uint8_t> bytes);
Status check_transforms(std::span<const std::uint8_t> bytes);

}  // namespace lumbrical
