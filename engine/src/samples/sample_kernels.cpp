// See sample_kernels.h.
#include "samples/sample_kernels.h"

namespace lumbrical {

const SampleKernels& sample_kernels(Isa isa) {
  switch (isa) {
#if defined(LUMBRICAL_XSIMD) && defined(__x86_64__)
    case Isa::sse2:
      return sse2::kSampleKernels;
    case Isa::avx2:
      return avx2::kSampleKernels;
    case Isa::avx512:
      return avx512::kSampleKernels;
#elif defined(LUMBRICAL_XSIMD) && defined(__aarch64__)
    case Isa::neon:
      return neon::kSampleKernels;
#elif defined(LUMBRICAL_XSIMD) && defined(__wasm__)
    case Isa::simd128:
      return simd128::kSampleKernels;
#endif
    default:
      return scalar::kSampleKernels;
  }
}

}  // namespace lumbrical
