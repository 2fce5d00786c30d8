// Rounding mode and denormal handling as the arithmetic contract wants them, for the length of a scope: of
// whatever makes numbers that a result depends on, from reading a file to a tick.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace lumbrical {

/// What a conversion to float may meet: neither infinite nor none, nor beyond its range.
inline bool fits_float(double value) {
  return std::fabs(value) <= static_cast<double>(std::numeric_limits<float>::max());
}

/// Round to nearest, denormals kept, exceptions masked; the embedder's own modes return at the end of the
/// scope.
class FloatingPointGuard {
 public:
  FloatingPointGuard() : saved_(get()) { set(kDefault); }
  ~FloatingPointGuard() { set(saved_); }
  FloatingPointGuard(const FloatingPointGuard&) = delete;
  FloatingPointGuard& operator=(const FloatingPointGuard&) = delete;

 private:
#if defined(__x86_64__)
  // As at process start: MXCSR below; above it the control word of the x87, by which the C library's strtod
  // rounds.
  static constexpr std::uint64_t kDefault = 0x037f'0000'1f80;
  static std::uint64_t get() {
    std::uint16_t x87 = 0;
    asm volatile("fnstcw %0" : "=m"(x87));
    return std::uint64_t{x87} << 32 | _mm_getcsr();
  }
  static void set(std::uint64_t mode) {
    const auto x87 = static_cast<std::uint16_t>(mode >> 32);
    asm volatile("fldcw %0" : : "m"(x87));
    _mm_setcsr(static_cast<unsigned>(mode));
  }
#elif defined(__aarch64__)
  static constexpr std::uint64_t kDefault = 0;  // FPCR: round to nearest, no flush to zero
  static std::uint64_t get() {
    std::uint64_t mode = 0;
    asm volatile("mrs %0, fpcr" : "=r"(mode));
    return mode;
  }
  static void set(std::uint64_t mode) { asm volatile("msr fpcr, %0" : : "r"(mode)); }
#else
  static constexpr std::uint64_t kDefault = 0;
  static std::uint64_t get() { return 0; }
  static void set(std::uint64_t) {}
#endif
  std::uint64_t saved_;
};

}  // namespace lumbrical
