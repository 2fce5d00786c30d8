// A root of a continuous function between two points where its signs differ.
#pragma once

#include <cmath>

#include "lumbrical/math.h"

namespace lumbrical {

/// Where f changes its sign between a and b, to `tolerance`; fa = f(a) and fb = f(b) must not have the same
/// sign. Secant steps, the stale end's value scaled down as after Anderson and Bjorck, and bisection where
/// they do not halve the bracket in three steps: at most 200 evaluations, always the same ones.
template <class F>
double find_root(F&& f, double a, double fa, double b, double fb, double tolerance) {
  double last_width = std::fabs(b - a);
  for (int step = 0; step < 200; ++step) {
    const double width = std::fabs(b - a);
    if (fa == 0) return a;
    if (fb == 0 || width <= tolerance) break;
    double x = b - fb * ((b - a) / (fb - fa));
    if (step % 3 == 2) {
      if (!(width < 0.5 * last_width)) x = 0.5 * (a + b);
      last_width = width;
    }
    // Not closer to an end than the tolerance: the next bracket may then be that small.
    const double low = min(a, b), high = max(a, b), edge = 0.5 * min(tolerance, width);
    x = clamp(x, low + edge, high - edge);
    const double fx = f(x);
    if ((fx > 0) != (fb > 0)) {
      a = b;
      fa = fb;
    } else {
      const double share = fb != 0 ? 1 - fx / fb : 0.5;
      fa *= share > 0 ? share : 0.5;
    }
    b = x;
    fb = fx;
  }
  return b;
}

}  // namespace lumbrical
