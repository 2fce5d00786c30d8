// How near a hand in motion comes to the objects of a scene, and moving the motion so that it meets one: for
// when nothing was touched.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lumbrical/model.h"
#include "lumbrical/motion.h"
#include "lumbrical/status.h"

namespace lumbrical {

/// Where hand and object are nearest to each other in the whole of a motion.
struct Approach {
  double distance = 1e300;  ///< [m] from skin to surface, to about a millimetre; 0 where they overlap
  double time = 0;          ///< [s] of the motion's sample
  int segment = 0;          ///< of the hand
  Vec3 hand, object;        ///< [m] W: the point of the skin and that of the surface
};

struct Clearance {
  Box hand;                 ///< [m] W: round all of the hand in all samples; empty where none shows a hand
  std::vector<Box> object;  ///< [m] W: round each object's triangles; of a world file one more, round all
  std::vector<Approach>
      approach;  ///< to each object; none for a world file, and where no sample shows a hand
};

/// Looks at the motion's samples up to `seconds`, or a thousand of them if there are more. Builds a search
/// tree for each object: takes about as long as build_model. The scene's meshes must be such as build_model
/// takes.
Clearance find_clearance(const Scene& scene, const Motion& motion, double seconds);

/// What of an object a motion is moved to.
struct Alignment {
  /// A point of the object's bounding box, or where the hand comes nearest to its surface as the motion
  /// stands.
  enum class Target : std::uint8_t { centre, top, bottom, left, right, front, back, contact, point };
  std::string object;              ///< by name; empty: the first
  Target target = Target::centre;  ///< left -x, right +x, front -y, back +y, bottom -z, top +z
  Vec3 point;                      ///< [m] W, for Target::point
};

/// "centre", "top", ..., "contact", or "x,y,z" [m], with an object's name and a colon before it or not.
std::optional<Alignment> parse_alignment(std::string_view text);
inline constexpr const char* kAlignmentForms =
    "centre, top, bottom, left, right, front, back, contact or x,y,z [m], with OBJECT: before it or not";

/// The shift [m, W] that does it; the motion is left as it is. All but contact bring the middle between thumb
/// tip and the other fingertips, at the first moment the fingertips are closest together, to the target.
/// Contact moves along the shortest way, so that the hand first touches, 1 mm deep, at the moment it came
/// nearest; 0 where it touches already. Refuses names that the scene has not, what a world file can't tell,
/// and motions without a hand.
Status find_shift(const Scene& scene, const Motion& motion, double seconds, const Alignment& alignment,
                  Vec3& shift);

}  // namespace lumbrical
