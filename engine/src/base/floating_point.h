// Rounding mode and denormal handling as the arithmetic contract wants them, for the length of a scope.
#pragma once

#include <cstdint>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace lumbrical {

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
  static constexpr std::uint64_t kDefault = 0x1f80;  // MXCSR at process start
  static std::uint64_t get() { return _mm_getcsr(); }
  static void set(std::uint64_t mode) { _mm_setcsr(static_cast<unsigned>(mode)); }
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
