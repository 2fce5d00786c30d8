// Every rung's error and time on any scene and motion: what `lumbrical run --compare-precision` prints, and
// bench/mesh_grasps of real meshes.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "lumbrical/model.h"
#include "lumbrical/motion.h"
#include "lumbrical/tick.h"

namespace lumbrical::tool {

struct PrecisionFigures {
  double precision = 0;                        ///< Settings::precision of every segment; 0: exact
  double median_us = 0, p99_us = 0;            ///< of a tick that touches, by work_clock
  double wall_median_us = 0, wall_p99_us = 0;  ///< the same, with what other work took of the processor
  std::uint64_t coarsened = 0;                 ///< ticks that Settings::effort made coarser
  std::uint64_t max_evaluations = 0;           ///< of a tick
  double hand_error = 0,
         worst_hand_error = 0;  ///< in 98 of 100 ticks, and in all; shares of the segments' forces together
  double segment_error = 0;     ///< the worst segment's, in 98 of 100 ticks; of the hand's force
};

struct PrecisionComparison {
  std::uint64_t ticks = 0;              ///< in which the hand felt more than kLeastForce
  double contacts = 0;                  ///< of those ticks, mean
  std::vector<PrecisionFigures> rungs;  ///< exact first, then finer to coarser
  /// Exact as the scene has it, where that feels for each part what several hold together: the exact rung,
  /// which others are held against, feels it once (FeltOnce::always).
  std::optional<PrecisionFigures> exact_for_each;
  /// Of a scene that asks for several precisions, in the place of which the advised one is for all: its own.
  std::optional<PrecisionFigures> own;
  /// The quickest rung that keeps the precision the scene asks for: the finest of its segments by samples.
  /// Where its effort lets none of them, the best of those that keep within the effort.
  std::size_t advised = 0;
  bool cut_by_effort = false;     ///< the advised one is what the effort leaves
  Settings settings;              ///< the scene's
  bool by_processor_time = true;  ///< of one thread; of several by the clock on the wall
};

/// [N] Below, shares of the hand's force say little.
inline constexpr double kLeastForce = 0.05;

/// Where given objects are in the tick of `model` at `time` [s]; `last`: of the tick before it, null in the
/// first. None: there are no such objects.
using GivenAt = std::function<std::span<const ObjectFrame>(double time, const Model& model, Scratch* last)>;

/// Up to 2000 moments of the session, every rung in turn at each. Limits and fading are left out. Where what
/// is felt depends on ticks before (objects apart, a proxy, damped pads) the session goes through all of its
/// ticks as the scene has it, and every rung feels a moment from the state that has come of them: so errors
/// are of forces, not of where objects have gone to since.
Status compare_precision(const Scene& scene, const Execution& execution, const Motion& motion, double seconds,
                         const GivenAt& given_at, PrecisionComparison& comparison);

}  // namespace lumbrical::tool
