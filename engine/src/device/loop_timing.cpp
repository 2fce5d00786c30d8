// See lumbrical/loop_timing.h.
#include "lumbrical/loop_timing.h"

#include <limits>

#include "lumbrical/math.h"

namespace lumbrical {
namespace {

constexpr double kHalf = 0.5;        // [s] after which the older half of the peaks is forgotten
constexpr double kUsual = 1 / 16.0;  // share of the newest interval in the mean

void insert(double value, std::array<double, 2>& largest) {
  if (value > largest[0]) {
    largest = {value, largest[0]};
  } else if (value > largest[1]) {
    largest[1] = value;
  }
}

// The second largest of both halves, at once if above what is held.
void follow(double value, double dt, RecentPeak& peak) {
  insert(value, peak.now);
  std::array<double, 2> both = peak.now;
  insert(peak.before[0], both);
  insert(peak.before[1], both);
  peak.value =
      both[1] > peak.value ? both[1] : peak.value + (both[1] - peak.value) * min(1, dt / kTimingMemory);
}

}  // namespace

void measure_exchange(double interval, double delay, TimingMeter& meter) {
  if (!(interval > 0) || !(delay > 0) || !is_finite(interval) || !is_finite(delay)) return;
  meter.half += interval;
  if (meter.half >= kHalf) {
    meter.half = 0;
    for (RecentPeak* const peak : {&meter.interval, &meter.delay}) {
      // A bus so slow that no two exchanges fall into a half keeps the older one as well.
      peak->before = peak->now[1] > 0 ? peak->now : std::array<double, 2>{peak->now[0], peak->before[0]};
      peak->now = {};
    }
  }
  meter.usual = meter.count == 0 ? interval : meter.usual + (interval - meter.usual) * kUsual;
  follow(interval, interval, meter.interval);
  follow(delay, interval, meter.delay);
  ++meter.count;
}

bool is_measured(const TimingMeter& meter) { return meter.count >= 2; }

LoopTiming timing_of(const TimingMeter& meter) {
  LoopTiming timing;
  if (!is_measured(meter)) {
    timing.delay = std::numeric_limits<double>::infinity();
    return timing;
  }
  timing.period = min(meter.usual, meter.interval.value);
  timing.jitter = meter.interval.value - timing.period;
  timing.delay = meter.delay.value;
  return timing;
}

}  // namespace lumbrical
