// See exact_kernels.h.
#include "exact/exact_kernels.h"

namespace lumbrical {

const ExactKernels& exact_kernels(Isa isa) {
  switch (isa) {
#if defined(LUMBRICAL_XSIMD) && defined(__x86_64__)
    case Isa::sse2:
      return sse2::kExactKernels;
    case Isa::avx2:
      return avx2::kExactKernels;
    case Isa::avx512:
      return avx512::kExactKernels;
#elif defined(LUMBRICAL_XSIMD) && defined(__aarch64__)
    case Isa::neon:
      return neon::kExactKernels;
#elif defined(LUMBRICAL_XSIMD) && defined(__wasm__)
    case Isa::simd128:
      return simd128::kExactKernels;
#endif
    default:
      return scalar::kExactKernels;
  }
}

}  // namespace lumbrical
