// Area and moment of a conic's arc over its chord as series in u = gamma delta^2 / (4 Q^2)
// (section_area.cpp).
#pragma once

#include <cstddef>

namespace lumbrical {

/// S(u) = 3 sum C_k u^k / (2k + 3) with C_k = binomial(2k, k) / 4^k, and W(u) = (1 - sqrt(1 - u) S(u)) / u.
template <std::size_t N>
struct BulgeSeries {
  double s[N], w[N];
};

template <std::size_t N>
constexpr BulgeSeries<N> bulge_series() {
  BulgeSeries<N> series{};
  double s[N + 1] = {}, root[N + 1] = {}, central = 1, r = 1;
  for (std::size_t k = 0; k <= N; ++k) {
    const double n = static_cast<double>(k);
    s[k] = 3 * central / (2 * n + 3);
    central *= (2 * n + 1) / (2 * n + 2);
    root[k] = r;
    r *= (n - 0.5) / (n + 1);
  }
  for (std::size_t k = 0; k < N; ++k) {
    series.s[k] = s[k];
    for (std::size_t j = 0; j <= k + 1; ++j) series.w[k] -= root[j] * s[k + 1 - j];
  }
  return series;
}

}  // namespace lumbrical
