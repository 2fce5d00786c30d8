// A picture of the sweep: how far the joint swings over stiffness, with the predicted limits.
#pragma once

#include <string>
#include <vector>

namespace lumbrical::bench {

struct SweepPoint {
  double stiffness = 0;  ///< [N m/rad]
  double swing = 0;      ///< [rad]
};

struct SweepCurve {
  std::string name;
  double limit = 0;  ///< [N m/rad] predicted
  std::vector<SweepPoint> points;
};

/// An SVG with logarithmic axes, stiffness 0.1 .. 100 N m/rad, swing 1e-6 .. 10 rad.
std::string plot_sweep(const std::vector<SweepCurve>& curves);

}  // namespace lumbrical::bench
