// Elementary functions with the same bits on every machine: + - * / sqrt and bit moves only, no libm
// (whose results change with its version and with the CPU). Errors are stated in units in the last place.
#pragma once

#include <span>

namespace lumbrical {

struct SinCos {
  double sin, cos;
};

/// Sine and cosine of x [rad]. Error <= 2 ulp of 1 for |x| <= 1e5; beyond that, and for NaN, sin 0 and cos 1.
SinCos sin_cos(double x);

/// The same of every x; `result` is as long.
void sin_cos(std::span<const double> x, std::span<SinCos> result);

/// Arc tangent [rad]. Error <= 5 ulp for every finite x; +-pi/2 for infinities.
double arc_tan(double x);

/// Angle of the point (x, y) against the +x axis [rad], in (-pi, pi]; 0 at the origin. Error <= 4 ulp.
double arc_tan2(double y, double x);

/// ln(1 + x) for x > -1. Error <= 4 ulp.
double log_1p(double x);

/// Inverse hyperbolic sine. Error <= 6 ulp.
double arc_sinh(double x);

}  // namespace lumbrical
