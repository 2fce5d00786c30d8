// The exact rung's kernels for simd128. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA simd128
#include "exact/exact_table.h"

namespace lumbrical::simd128 {
const ExactKernels kExactKernels =
    table_of<xsimd::batch<double, xsimd::sse2>, xsimd::batch<float, xsimd::sse2>>();
}
