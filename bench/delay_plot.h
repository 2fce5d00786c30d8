// A picture of the loop over delays: the energy into the hand at worst, with each protection left out.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lumbrical::bench {

struct DelayPoint {
  std::string bus;
  double given = 0;  ///< [J]
  std::uint64_t shakes = 0;
};

struct DelayCurve {
  std::string name;
  std::vector<DelayPoint> points;  ///< the same buses for all
};

/// An SVG: a column per bus, a mark per curve on a logarithmic axis of 1e-6 .. 100 J, hollow where nothing
/// shakes, filled with the number of shakes beside it otherwise; a line at `limit`.
std::string plot_delays(const std::vector<DelayCurve>& curves, double limit);

}  // namespace lumbrical::bench
