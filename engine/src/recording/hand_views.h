// What other programs can draw of a tick: the posed hand, the contact points, hand and forces in a scene
// (scene_views.h), as messages of schemas that Foxglove knows (schemas/foxglove.fbs).
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "lumbrical/model.h"
#include "lumbrical/recording.h"
#include "lumbrical/tick.h"

namespace flatbuffers {
class FlatBufferBuilder;
}

namespace lumbrical {

inline constexpr std::string_view kPoseSchemaName = "foxglove.PosesInFrame";
inline constexpr std::string_view kContactsSchemaName = "foxglove.PointCloud";
/// The binary schema of all that others draw.
std::span<const std::uint8_t> view_schema();

/// Computes ticks anew to look at them; not for the thread of the ticks.
class HandViewer {
 public:
  /// On one thread, however many the session has.
  explicit HandViewer(const Model& model);
  /// Puts the hand where this tick felt it: what the messages are of. Where that was is in `after`, the state
  /// the tick left, if a proxy held the hand; false: it is wanted and not given.
  bool place(const TickRecord& record, const State* after);
  /// Clears the builder and leaves the message in it; false: the frame showed no hand that could be placed.
  bool pose(std::uint64_t time, flatbuffers::FlatBufferBuilder& builder);
  /// Likewise; without contacts the message has no points.
  void contacts(std::uint64_t time, flatbuffers::FlatBufferBuilder& builder);
  /// Likewise hand and forces, which are those of `output`.
  void scene(const ActuatorFrame& output, std::uint64_t time, flatbuffers::FlatBufferBuilder& builder);

 private:
  Model model_;
  bool has_proxy_;
  Scratch scratch_;
};

/// The error tells what is wrong, not where.
Status decode_pose(std::span<const std::uint8_t> bytes, std::vector<Pose>& joints);
Status decode_contacts(std::span<const std::uint8_t> bytes, std::vector<ContactPoint>& points);

}  // namespace lumbrical
