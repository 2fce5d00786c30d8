// Given objects on a path: poses at some times, and in between.
#pragma once

#include <vector>

#include "lumbrical/math.h"

namespace lumbrical {

/// Where a given object is at one time.
struct PathPoint {
  double time = 0;  ///< [s]
  Pose pose;        ///< X_WO
};

/// The path of a given object: at least one point, times strictly increasing.
using ObjectPath = std::vector<PathPoint>;

/// Where it is at `time` [s], between the points as a hand's base is (motion.h); before the first and after
/// the last it stands still.
Pose resample(const ObjectPath& path, double time);

}  // namespace lumbrical
