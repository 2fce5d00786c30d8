// Scene files: everything a session needs, in one JSON text (schemas/scene.fbs says which fields there are,
// their units, ranges and defaults).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lumbrical/clearance.h"
#include "lumbrical/model.h"
#include "lumbrical/motion.h"
#include "lumbrical/object_path.h"
#include "lumbrical/status.h"

namespace lumbrical {

/// The other hand of a capture of both.
struct SecondHand {
  Hand hand;      ///< fitted to its motion
  Motion motion;  ///< placed as the first
};

/// Who moves the given objects that have a mass.
struct PhysicsChoice {
  std::string engine;  ///< "bullet"
  double friction = 0.5;
};

struct SceneFile {
  Scene scene;  ///< meshes placed in the world, the hand fitted to the motion
  Execution execution;
  Motion motion;                     ///< placed in the world
  std::optional<SecondHand> second;  ///< where both are felt: the left one, and the scene's is the right
  MotionPlacement placement;         ///< that it was placed with, alignment included
  bool aligned =
      false;  ///< it was moved to meet an object (find_shift): write the placement's pose into the scene
  bool touching =
      false;  ///< it was to be moved to contact and stayed: where it comes nearest it is inside already
  std::vector<ObjectPath> paths;           ///< of the scene's given objects, in their order; empty: none
  std::optional<PhysicsChoice> physics{};  ///< for a program that has it, such as `lumbrical run`
  double seconds = 0;                      ///< [s] length of the session, > 0
  std::vector<std::string> files;          ///< every file that was read, the scene file first
};

/// Refuses what only a program that asks for it can do, for those that would drop it without a word: a second
/// hand, paths of given objects, physics. The message starts with the file, and says what to do.
Status check_plain(const SceneFile& scene_file);

/// What takes the place of the file's own motion.
struct MotionOverride {
  std::string file;  ///< a motion file; empty: the scene's own motion
  double rate = 0;   ///< [Hz] of files without time stamps; 0: the scene's
  std::optional<Side> side;
  bool both = false;               ///< hands of a capture are felt, whatever the sides say
  double unit = 0;                 ///< [m] per number of the motion file; 0: the scene's
  std::optional<Alignment> align;  ///< above the scene's
};

/// Reads a scene file ("-": standard input) and every mesh and motion it names (paths relative to the scene
/// file; MotionOverride::file as it stands). On error `scene_file` is unchanged and the message starts with
/// "path:line:column:" of whatever file is at fault.
/// A world file that the scene names is opened (world.h).
Status load_scene_file(const std::string& path, SceneFile& scene_file, const MotionOverride& motion = {});

/// Reads only the objects of a scene file, one at a time: what a WorldWriter takes. `begin` is called first,
/// with how the work is to be done. The first error of either ends it, and names the object.
Status load_scene_objects(const std::string& path, const std::function<Status(const Execution&)>& begin,
                          const std::function<Status(SceneObject&&)>& take);

}  // namespace lumbrical
