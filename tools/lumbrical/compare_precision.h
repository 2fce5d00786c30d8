// Every rung's error and time on any scene and motion: what `lumbrical run --compare-precision` prints, and
// bench/mesh_grasps of real meshes.
#pragma once

#include <cstdint>
#include <vector>

#include "lumbrical/model.h"
#include "lumbrical/motion.h"

namespace lumbrical::tool {

struct PrecisionFigures {
  double precision = 0;              ///< Settings::precision of every segment; 0: exact
  double median_us = 0, p99_us = 0;  ///< of a tick that touches
  double hand_error = 0,
         worst_hand_error = 0;  ///< in 98 of 100 ticks, and in all; shares of the segments' forces together
  double segment_error = 0;     ///< the worst segment's, in 98 of 100 ticks; of the hand's force
};

struct PrecisionComparison {
  std::uint64_t ticks = 0;              ///< in which the hand felt more than kLeastForce
  double contacts = 0;                  ///< of those ticks, mean
  std::vector<PrecisionFigures> rungs;  ///< exact first, then finer to coarser
  std::size_t advised = 0;              ///< the quickest rung that keeps the precision the scene asks for
};

/// [N] Below, shares of the hand's force say little.
inline constexpr double kLeastForce = 0.05;

/// Up to 2000 moments of the session, every rung in turn at each. Limits and fading are left out.
Status compare_precision(const Scene& scene, const Execution& execution, const Motion& motion, double seconds,
                         PrecisionComparison& comparison);

}  // namespace lumbrical::tool
