// See sensor_pace.h.
#include "device/sensor_pace.h"

#include <cmath>

#include "base/steady_clock.h"
#include "lumbrical/math.h"

namespace lumbrical {
namespace {

// [rad] Of less a joint that moves slowly may just not have come to its encoder's next step, whatever the
// profile says of that.
constexpr double kWay = 0.004;
constexpr double kSteps = 4;

}  // namespace

void note_angle(float angle, std::int64_t asked, double step, AnglePace& pace) {
  ++pace.asked;
  if (pace.changed != 0 && angle == pace.value) return;
  const double way = pace.changed == 0 ? 0 : static_cast<double>(angle) - static_cast<double>(pace.value);
  // Of a joint that stood still before nobody knows when it began to move.
  const bool goes_on = way * pace.way > 0;
  if (goes_on && min(std::fabs(way), std::fabs(pace.way)) > max(kWay, kSteps * step)) {
    ++pace.changes;
    pace.answers += pace.asked;
    pace.between += in_seconds(asked - pace.changed);
  }
  pace.value = angle;
  pace.changed = asked;
  pace.asked = 0;
  pace.way = way;
}

double slow_pace(const AnglePace& pace) {
  if (pace.changes < kEnoughChanges || pace.answers < 2 * pace.changes) return 0;
  return pace.between / pace.changes;
}

}  // namespace lumbrical
