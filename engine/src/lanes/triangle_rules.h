// Quadrature over a triangle: the three midpoints (degree 2) and Radon's seven points (degree 5).
#pragma once

namespace lumbrical {

struct Barycentric {
  double a, b, c, weight;
};
inline constexpr Barycentric kThreePoints[] = {
    {0, 0.5, 0.5, 1.0 / 3}, {0.5, 0, 0.5, 1.0 / 3}, {0.5, 0.5, 0, 1.0 / 3}};
// (6 -+ sqrt 15) / 21 and (155 -+ sqrt 15) / 1200.
inline constexpr double kNear = 0.10128650732345633880, kNearWeight = 0.12593918054482715260;
inline constexpr double kFar = 0.47014206410511508977, kFarWeight = 0.13239415278850618074;
inline constexpr Barycentric kSevenPoints[] = {
    {1.0 / 3, 1.0 / 3, 1.0 / 3, 0.225},         {1 - 2 * kNear, kNear, kNear, kNearWeight},
    {kNear, 1 - 2 * kNear, kNear, kNearWeight}, {kNear, kNear, 1 - 2 * kNear, kNearWeight},
    {1 - 2 * kFar, kFar, kFar, kFarWeight},     {kFar, 1 - 2 * kFar, kFar, kFarWeight},
    {kFar, kFar, 1 - 2 * kFar, kFarWeight}};

}  // namespace lumbrical
