// The largest of what a test measures.
#pragma once

#include <cmath>

namespace lumbrical::test {

/// NaN where either is, and so in no bound: std::max and std::fmax let it go by.
inline double largest(double a, double b) { return std::isnan(a) || a >= b ? a : b; }

}  // namespace lumbrical::test
