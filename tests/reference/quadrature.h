// Adaptive Gauss-Kronrod quadrature of several functions at once over pieces between known breaks.
//
// Within a piece the variable is an angle, y = low + (high - low) sin^2(angle / 2): the square roots with
// which sections begin and end disappear.
#pragma once

#include <array>
#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <limits>
#include <vector>

namespace lumbrical::reference {

template <class T, std::size_t N>
using Values = std::array<T, N>;

/// Points of the Kronrod rule: odd, with an even Gauss rule inside.
template <class T>
constexpr unsigned kPoints = std::numeric_limits<T>::digits > 100 ? 61 : 21;

template <class T, std::size_t N>
struct Panel {
  Values<T, N> sum{}, error{};
};

/// Integral over the angles from .. to of the piece low .. high. Its error is taken to be that of the Gauss
/// rule inside, which is pessimistic by orders of magnitude, save next to a singularity no break is known of.
template <std::size_t N, class T, class Function>
Panel<T, N> panel(const Function& function, const T& low, const T& high, const T& from, const T& to) {
  using std::abs;
  using std::cos;
  using std::sin;
  using Kronrod = boost::math::quadrature::gauss_kronrod<T, kPoints<T>>;
  using Gauss = boost::math::quadrature::gauss<T, kPoints<T> / 2>;
  const T middle = (from + to) / 2, half = (to - from) / 2;
  Values<T, N> fine{}, coarse{};
  const auto add = [&](const T& angle, const T& weight, const T& gauss_weight) {
    const T sine = sin(angle / 2), cosine = cos(angle / 2), stretch = (high - low) * sine * cosine;
    const Values<T, N> value = function(T(low + (high - low) * sine * sine));
    for (std::size_t k = 0; k < N; ++k) {
      const T share = stretch * value[k];
      fine[k] += weight * share;
      coarse[k] += gauss_weight * share;
    }
  };
  for (unsigned i = 0; i < Kronrod::abscissa().size(); ++i) {
    const T step = half * Kronrod::abscissa()[i];
    const T weight = half * Kronrod::weights()[i],
            gauss = i % 2 == 1 ? T(half * Gauss::weights()[i / 2]) : T(0);
    add(T(middle + step), weight, gauss);
    if (i > 0) add(T(middle - step), weight, gauss);
  }
  Panel<T, N> result{fine, {}};
  for (std::size_t k = 0; k < N; ++k) result.error[k] = abs(fine[k] - coarse[k]);
  return result;
}

/// Splits a panel until its error is below the tolerance or there are no more to be had; the error tells.
template <std::size_t N, class T, class Function>
void refine(const Function& function, const T& low, const T& high, const T& from, const T& to,
            const Panel<T, N>& whole, const Values<T, N>& tolerance, int levels, int& panels_left,
            Panel<T, N>& total) {
  bool good = true;
  for (std::size_t k = 0; k < N; ++k) good = good && !(whole.error[k] > tolerance[k]);
  if (good || levels == 0 || panels_left <= 0) {
    for (std::size_t k = 0; k < N; ++k) {
      total.sum[k] += whole.sum[k];
      total.error[k] += whole.error[k];
    }
    return;
  }
  panels_left -= 2;
  const T middle = (from + to) / 2;
  const Panel<T, N> left = panel<N>(function, low, high, from, middle);
  const Panel<T, N> right = panel<N>(function, low, high, middle, to);
  refine(function, low, high, from, middle, left, tolerance, levels - 1, panels_left, total);
  refine(function, low, high, middle, to, right, tolerance, levels - 1, panels_left, total);
}

/// Integral over all pieces breaks[i] .. breaks[i + 1]. `tolerance_of` says from a first estimate of the
/// integrals how far off a panel may be.
template <std::size_t N, class T, class Function, class ToleranceOf>
Panel<T, N> integrate(const Function& function, const std::vector<T>& breaks,
                      const ToleranceOf& tolerance_of) {
  const T pi = boost::math::constants::pi<T>();
  std::vector<Panel<T, N>> coarse;
  Values<T, N> estimate{};
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    coarse.push_back(panel<N>(function, breaks[i], breaks[i + 1], T(0), pi));
    for (std::size_t k = 0; k < N; ++k) estimate[k] += coarse.back().sum[k];
  }
  const Values<T, N> tolerance = tolerance_of(estimate);
  Panel<T, N> total;
  int panels_left = 400;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    refine(function, breaks[i], breaks[i + 1], T(0), pi, coarse[i], tolerance, 40, panels_left, total);
  }
  return total;
}

}  // namespace lumbrical::reference
