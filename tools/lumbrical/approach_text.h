// What is said where a hand touches nothing: how near it came, where things are, and which unit may be wrong.
#pragma once

#include <string>
#include <vector>

#include "lumbrical/clearance.h"
#include "output.h"

namespace lumbrical::tool {

/// Which hand of the motion is felt with, and which other one is not: "right; 57 frames show a left one too,
/// ...".
std::string hand_text(const Motion& motion);

/// {"hand": box, "objects": [{"name", "lower", "upper", "distance", "time", "segment"}, ...]}
Json to_json(const Clearance& clearance, const Scene& scene);

/// A line for the hand and one or more for each object, nearest points and suspected units included.
std::vector<std::string> approach_sentences(const Clearance& clearance, const Scene& scene);

/// What the numbers of something so large [m] might have been in, told as the mistake: "mm read as m"; empty
/// where a hand could hold it as it is.
std::string likely_unit(double extent);

/// [m] as a person would say it: "12.3 mm", "4.56 m".
std::string length_text(double metres);

Json pose_json(const Pose& pose);  ///< {"position": [x, y, z], "orientation": [w, x, y, z]}
/// `"position": [...], "orientation": [...]`, all digits: what a scene file takes.
std::string pose_text(const Pose& pose);

/// Of SceneFile::touching.
inline constexpr const char* kTouching =
    "not moved: the hand is inside an object already, and contact moves a hand until it touches; align it by "
    "top or x,y,z";

}  // namespace lumbrical::tool
