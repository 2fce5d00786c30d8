// Which instruction sets this build has kernels for (LUMBRICAL_XSIMD) and this processor and its operating
// system can run.
#include "lumbrical/model.h"

namespace lumbrical {

bool available(Isa isa) {
  switch (isa) {
    case Isa::automatic:
    case Isa::scalar:
      return true;
#if defined(LUMBRICAL_XSIMD) && defined(__x86_64__)
    // The compiler's own check asks the operating system as well (XGETBV).
    case Isa::sse2:
      return true;
    case Isa::avx2:
      return __builtin_cpu_supports("avx2") != 0;
    case Isa::avx512:
      return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
             __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512cd") != 0;
#elif defined(LUMBRICAL_XSIMD) && defined(__aarch64__)
    case Isa::neon:
      return true;
#elif defined(LUMBRICAL_XSIMD) && defined(__wasm__)
    case Isa::simd128:
      return true;
#endif
    default:
      return false;
  }
}

Isa widest_isa() {
  for (const Isa isa : {Isa::avx512, Isa::avx2, Isa::sse2, Isa::neon, Isa::simd128}) {
    if (available(isa)) return isa;
  }
  return Isa::scalar;
}

}  // namespace lumbrical
