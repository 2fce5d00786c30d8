// The SIMD vocabulary: what kernels may do with wide numbers, and the only header that names xsimd.
//
// A kernel is a template over its number type V and uses nothing but + - * /, comparisons, && || and the
// functions here; V is double or float (one lane) or a batch of them. Lanes never meet, so the width of V
// does not show in a result. Minimum and maximum are compare and select because the instructions of the
// various machines disagree on -0 and NaN.
//
// An unqualified call on batches finds xsimd's functions of the same names too: those here are the more
// constrained, and so are the ones that are taken.
#pragma once

#include <cmath>
#include <cstddef>

#ifdef LUMBRICAL_XSIMD
#include <xsimd/xsimd.hpp>
#endif

namespace lumbrical::wide {

template <class V>
struct Lanes {
  using Number = V;
  static constexpr std::size_t kCount = 1;
};

template <class T>
inline T get(const T* at, T) {
  return *at;
}
inline void put(double* at, double value) { *at = value; }
inline void put(float* at, float value) { *at = value; }
inline double select(bool which, double yes, double no) { return which ? yes : no; }
inline float select(bool which, float yes, float no) { return which ? yes : no; }
inline bool any(bool which) { return which; }
inline bool is_not(bool which) { return !which; }
inline unsigned bits_of(bool which) { return which ? 1u : 0u; }
inline double sqrt(double value) { return std::sqrt(value); }
inline float sqrt(float value) { return std::sqrt(value); }
inline double abs(double value) { return std::fabs(value); }
inline float abs(float value) { return std::fabs(value); }
// a < b ? a : b, and a > b ? a : b, for NaN and -0 too.
inline double min(double a, double b) { return a < b ? a : b; }
inline float min(float a, float b) { return a < b ? a : b; }
inline double max(double a, double b) { return a > b ? a : b; }
inline float max(float a, float b) { return a > b ? a : b; }

#ifdef LUMBRICAL_XSIMD
template <class T, class A>
struct Lanes<xsimd::batch<T, A>> {
  using Number = T;
  static constexpr std::size_t kCount = xsimd::batch<T, A>::size;
};

template <class T>
concept Real = sizeof(T) == 4 || sizeof(T) == 8;

template <class T, class A>
inline xsimd::batch<T, A> get(const T* at, xsimd::batch<T, A>) {
  return xsimd::batch<T, A>::load_aligned(at);
}
template <class T, class A>
inline void put(T* at, xsimd::batch<T, A> value) {
  value.store_aligned(at);
}
template <class T, class A>
requires Real<T>
inline xsimd::batch<T, A> select(xsimd::batch_bool<T, A> const& which, xsimd::batch<T, A> const& yes,
                                 xsimd::batch<T, A> const& no) noexcept {
  return xsimd::select(which, yes, no);
}
template <class T, class A>
requires Real<T>
inline bool any(xsimd::batch_bool<T, A> const& which) noexcept { return xsimd::any(which); }
// What `!` is; that of xsimd compares masks half by half on AVX.
template <class T, class A>
requires Real<T>
inline xsimd::batch_bool<T, A> is_not(xsimd::batch_bool<T, A> const& which) noexcept { return ~which; }
// One bit per lane of floats, the first the lowest.
template <class A>
inline unsigned bits_of(xsimd::batch_bool<float, A> which) {
#if defined(__x86_64__) || defined(__wasm__)
  if constexpr (Lanes<xsimd::batch<float, A>>::kCount == 4) {
    return static_cast<unsigned>(_mm_movemask_ps(which.data));
#if defined(__AVX__)
  } else if constexpr (Lanes<xsimd::batch<float, A>>::kCount == 8) {
    return static_cast<unsigned>(_mm256_movemask_ps(which.data));
#endif
#if defined(__AVX512F__)
  } else {
    return static_cast<unsigned>(which.data);
#endif
  }
#else
  const xsimd::batch<float, A> zero(0.0f);
  constexpr std::size_t kCount = Lanes<xsimd::batch<float, A>>::kCount;
  alignas(64) float lane[kCount];
  xsimd::select(which, zero + 1.0f, zero).store_aligned(lane);
  unsigned bits = 0;
  for (std::size_t k = 0; k < kCount; ++k) bits |= static_cast<unsigned>(lane[k] != 0) << k;
  return bits;
#endif
}
template <class T, class A>
requires Real<T>
inline xsimd::batch<T, A> abs(xsimd::batch<T, A> const& value) noexcept { return xsimd::abs(value); }
template <class T, class A>
requires Real<T>
inline xsimd::batch<T, A> sqrt(xsimd::batch<T, A> const& value) noexcept {
#if defined(__ARM_NEON) && defined(__aarch64__)
  // xsimd's root and quotient of floats on NEON are estimates.
  if constexpr (sizeof(T) == 4) return xsimd::batch<T, A>(vsqrtq_f32(value));
#endif
  return xsimd::sqrt(value);
}
// x86's instructions do the same; other machines' disagree on NaN and -0.
template <class T, class A>
requires Real<T>
inline xsimd::batch<T, A> min(xsimd::batch<T, A> const& a, xsimd::batch<T, A> const& b) noexcept {
#if defined(__x86_64__)
  return xsimd::min(a, b);
#else
  return xsimd::select(a < b, a, b);
#endif
}
template <class T, class A>
requires Real<T>
inline xsimd::batch<T, A> max(xsimd::batch<T, A> const& a, xsimd::batch<T, A> const& b) noexcept {
#if defined(__x86_64__)
  return xsimd::max(a, b);
#else
  return xsimd::select(a > b, a, b);
#endif
}
#endif

template <class V>
inline V divide(V a, V b) {
#if defined(LUMBRICAL_XSIMD) && defined(__ARM_NEON) && defined(__aarch64__)
  if constexpr (Lanes<V>::kCount == 4) return V(vdivq_f32(a, b));
#endif
  return a / b;
}
template <class V>
inline V clamp(V value, V low, V high) {
  return min(max(value, low), high);
}

}  // namespace lumbrical::wide
