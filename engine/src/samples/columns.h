// From records of floats to lanes: four floats of four records at a time, by shuffles that every machine has.
#pragma once

#include <cstddef>
#include <cstring>

#include "simd/wide.h"

namespace lumbrical::LUMBRICAL_ISA {

using Four = float __attribute__((vector_size(16)));

inline Four four_at(const float* at) {
  Four four;
  std::memcpy(&four, at, sizeof four);
  return four;
}

/// As many floats as half a register holds, and as doubles, which fill one.
template <std::size_t N>
struct HalfRegister;
template <>
struct HalfRegister<2> {
  using Floats = float __attribute__((vector_size(8)));
  using Doubles = double __attribute__((vector_size(16)));
};
template <>
struct HalfRegister<4> {
  using Floats = Four;
  using Doubles = double __attribute__((vector_size(32)));
};

template <std::size_t N>
inline typename HalfRegister<N>::Doubles as_doubles(typename HalfRegister<N>::Floats floats) {
#if defined(LUMBRICAL_XSIMD) && defined(__AVX__)  // one instruction, of which g++ makes four
  if constexpr (N == 4) return _mm256_cvtps_pd(floats);
#endif
  return __builtin_convertvector(floats, typename HalfRegister<N>::Doubles);
}

/// Adds half a register's floats to doubles, each first rounded to a multiple of what the last place of
/// `rounder` is worth. Spelt out: g++ makes vectors of a loop of sixteen, but leaves one of eight to scalars.
template <std::size_t N>
inline void add_half_rounded(const float* from, double rounder, double* to) {
  typename HalfRegister<N>::Floats added;
  typename HalfRegister<N>::Doubles sum;
  std::memcpy(&added, from, sizeof added);
  std::memcpy(&sum, to, sizeof sum);
  sum += (as_doubles<N>(added) + rounder) - rounder;
  std::memcpy(to, &sum, sizeof sum);
}

/// Row k is to hold the k-th numbers of the four.
inline void transpose(Four (&of)[4]) {
  const Four ab = __builtin_shufflevector(of[0], of[1], 0, 4, 1, 5),
             ab_end = __builtin_shufflevector(of[0], of[1], 2, 6, 3, 7),
             cd = __builtin_shufflevector(of[2], of[3], 0, 4, 1, 5),
             cd_end = __builtin_shufflevector(of[2], of[3], 2, 6, 3, 7);
  of[0] = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
  of[1] = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
  of[2] = __builtin_shufflevector(ab_end, cd_end, 0, 1, 4, 5);
  of[3] = __builtin_shufflevector(ab_end, cd_end, 2, 3, 6, 7);
}

/// The same of vectors' rows, from the `first` of all their numbers on.
template <std::size_t kWidth>
inline void put_fours(const Four* from, std::size_t count, float (*vectors)[3][kWidth], std::size_t first,
                      std::size_t lane) {
  for (std::size_t k = 0; k < count; ++k)
    std::memcpy(vectors[(first + k) / 3][(first + k) % 3] + lane, from + k, sizeof(Four));
}

/// Puts `count` fours into four lanes of that many rows.
template <std::size_t kWidth>
inline void put_fours(const Four* from, std::size_t count, float (*rows)[kWidth], std::size_t lane) {
  for (std::size_t k = 0; k < count; ++k) std::memcpy(rows[k] + lane, from + k, sizeof(Four));
}

}  // namespace lumbrical::LUMBRICAL_ISA
