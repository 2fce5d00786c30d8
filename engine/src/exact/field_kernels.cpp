// See field_kernels.h.
#include "exact/field_kernels.h"

namespace lumbrical {

const FieldKernels& field_kernels(Isa isa) {
  switch (isa) {
#if defined(LUMBRICAL_XSIMD) && defined(__x86_64__)
    case Isa::sse2:
      return sse2::kFieldKernels;
    case Isa::avx2:
      return avx2::kFieldKernels;
    case Isa::avx512:
      return avx512::kFieldKernels;
#elif defined(LUMBRICAL_XSIMD) && defined(__aarch64__)
    case Isa::neon:
      return neon::kFieldKernels;
#elif defined(LUMBRICAL_XSIMD) && defined(__wasm__)
    case Isa::simd128:
      return simd128::kFieldKernels;
#endif
    default:
      return scalar::kFieldKernels;
  }
}

}  // namespace lumbrical
