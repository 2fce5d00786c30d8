// The SIMD vocabulary: what kernels may do with wide numbers, and the only header that names xsimd.
//
// A kernel is a template over its number type V and uses nothing but + - * /, comparisons, negation and the
// functions here; V is double or float (one lane) or a batch of them. Lanes never meet, so the width of V
// does not show in a result. Minimum and maximum are compare and select because the instructions of the
// various machines disagree on -0 and NaN.
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
inline double choose(bool which, double yes, double no) { return which ? yes : no; }
inline float choose(bool which, float yes, float no) { return which ? yes : no; }
inline bool some(bool which) { return which; }
inline bool both(bool a, bool b) { return a && b; }
inline bool either(bool a, bool b) { return a || b; }
inline unsigned bits_of(bool which, float) { return which ? 1u : 0u; }
inline double root(double value) { return std::sqrt(value); }
inline float root(float value) { return std::sqrt(value); }
inline double magnitude(double value) { return std::fabs(value); }
inline float magnitude(float value) { return std::fabs(value); }

#ifdef LUMBRICAL_XSIMD
template <class T, class A>
struct Lanes<xsimd::batch<T, A>> {
  using Number = T;
  static constexpr std::size_t kCount = xsimd::batch<T, A>::size;
};

template <class T, class A>
inline xsimd::batch<T, A> get(const T* at, xsimd::batch<T, A>) {
  return xsimd::batch<T, A>::load_aligned(at);
}
template <class T, class A>
inline void put(T* at, xsimd::batch<T, A> value) {
  value.store_aligned(at);
}
template <class T, class A>
inline xsimd::batch<T, A> choose(xsimd::batch_bool<T, A> which, xsimd::batch<T, A> yes,
                                 xsimd::batch<T, A> no) {
  return xsimd::select(which, yes, no);
}
template <class T, class A>
inline bool some(xsimd::batch_bool<T, A> which) {
  return xsimd::any(which);
}
// One bit per lane of floats, the first the lowest.
template <class A>
inline unsigned bits_of(xsimd::batch_bool<float, A> which, xsimd::batch<float, A> zero) {
#if defined(__x86_64__)
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
  static_cast<void>(zero);
#else
  constexpr std::size_t kCount = Lanes<xsimd::batch<float, A>>::kCount;
  alignas(64) float lane[kCount];
  xsimd::select(which, zero + 1.0f, zero).store_aligned(lane);
  unsigned bits = 0;
  for (std::size_t k = 0; k < kCount; ++k) bits |= static_cast<unsigned>(lane[k] != 0) << k;
  return bits;
#endif
}
template <class T, class A>
inline xsimd::batch_bool<T, A> both(xsimd::batch_bool<T, A> a, xsimd::batch_bool<T, A> b) {
  return a & b;
}
template <class T, class A>
inline xsimd::batch_bool<T, A> either(xsimd::batch_bool<T, A> a, xsimd::batch_bool<T, A> b) {
  return a | b;
}
template <class T, class A>
inline xsimd::batch<T, A> magnitude(xsimd::batch<T, A> value) {
  return xsimd::abs(value);
}
template <class T, class A>
inline xsimd::batch<T, A> root(xsimd::batch<T, A> value) {
#if defined(__ARM_NEON) && defined(__aarch64__)
  // xsimd's root and quotient of floats on NEON are estimates.
  if constexpr (sizeof(T) == 4) return xsimd::batch<T, A>(vsqrtq_f32(value));
#endif
  return xsimd::sqrt(value);
}
#endif

template <class V>
inline V quotient(V a, V b) {
#if defined(LUMBRICAL_XSIMD) && defined(__ARM_NEON) && defined(__aarch64__)
  if constexpr (Lanes<V>::kCount == 4) return V(vdivq_f32(a, b));
#endif
  return a / b;
}

// a < b ? a : b, and a > b ? a : b, for NaN and -0 too.
template <class V>
inline V lesser(V a, V b) {
  return choose(a < b, a, b);
}
template <class V>
inline V greater(V a, V b) {
  return choose(a > b, a, b);
}
#if defined(LUMBRICAL_XSIMD) && defined(__x86_64__)
// What x86's instructions do; other machines' disagree on NaN and -0.
template <class T, class A>
inline xsimd::batch<T, A> lesser(xsimd::batch<T, A> a, xsimd::batch<T, A> b) {
  return xsimd::min(a, b);
}
template <class T, class A>
inline xsimd::batch<T, A> greater(xsimd::batch<T, A> a, xsimd::batch<T, A> b) {
  return xsimd::max(a, b);
}
#endif
template <class V>
inline V between(V value, V low, V high) {
  return lesser(greater(value, low), high);
}

}  // namespace lumbrical::wide
