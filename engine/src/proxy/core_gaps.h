// How near the hand's cores are to surfaces.
//
// A segment's core is its axis, or the palm's polygon, thickened to half the segment's radius: there a field
// on a plane is at its stiffest, and beyond it would let the finger go. A gap always opens towards where the
// axis is, so a surface pushes back to the side from which it was met, whichever way it is wound.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/fixed_list.h"
#include "lumbrical/tick.h"
#include "model/primitive.h"

namespace lumbrical {

/// A core's share of the segment's radius.
inline constexpr double kCoreShare = 0.5;

/// Where a core is near a triangle.
struct Gap {
  std::uint8_t segment = 0;
  std::uint8_t object = 0;  ///< 0: of the world; else Model::apart[object - 1]
  Vec3 point;               ///< [m] W, of the axis
  Vec3 normal;              ///< unit, W, from the triangle to it
  double width = 0;         ///< [m] from the core to the triangle; negative where the core is in it
  double push = 0;          ///< [N] along `normal` on the segment, that keeps it open (hand_pull.h)
  double stiffness = 0;     ///< [N/m] by which that grows as the hand presses on
};

inline constexpr std::size_t kMostGapsPerSegment = 16;
using GapList = FixedList<Gap, kMostGapsPerSegment * kSegmentCount>;

struct CoreGaps {
  GapList gap;
  std::array<std::uint8_t, kSegmentCount> count{};  ///< of `gap`, by segment
  /// [m] Least distance of the axis, as far as that is less than the core's radius and the reach; 0 where it
  /// is inside a solid.
  std::array<double, kSegmentCount> clearance = every_segment(1e300);
  std::size_t pairs = 0;        ///< of a primitive and a triangle that were asked
  bool closed = false;          ///< something reaches into a core, or its axis is inside a solid
  bool asks_only_that = false;  ///< nothing more is looked at once one is closed
};

/// Which surfaces are asked, and as what.
struct Surroundings {
  const Model& model;
  Pose X_WM;                ///< of the model's frame
  std::uint8_t object = 0;  ///< Gap::object
};

/// A triangle that some of an axis is near to, and the sphere round it.
struct NearTriangle {
  Vec3 middle;
  double radius = 0;
  std::uint32_t number = 0;
};

/// A triangle's point nearest to one of an axis.
struct NearPoint {
  Vec3 gap;           ///< from it to the axis
  double square = 0;  ///< of the gap's length
  std::uint32_t triangle = 0;
  /// It holds this point of the axis off: a plane, or a corner or edge to which no other point is nearer.
  bool pushes = false;
};

/// Working memory for one primitive, sized once for all models it is asked of.
struct GapMemory {
  std::vector<NearTriangle> near;
  std::vector<NearPoint> points;
  std::size_t closed = 0;  ///< primitive by which a hand was last told to be closed: the first to be asked
};
void size_gap_memory(const Model& model, GapMemory& memory);

/// Adds the gaps narrower than `reach` [m] between one model's surfaces and a hand at these joints [W]. Where
/// a segment has more than it can hold the narrowest stay; neighbours that push the same way count once.
/// Returns false where there are more candidates than Settings::max_candidates.
bool add_gaps(const Surroundings& around, const Joints& hand, double reach, Scratch& scratch,
              GapMemory& memory, CoreGaps& gaps);

}  // namespace lumbrical
