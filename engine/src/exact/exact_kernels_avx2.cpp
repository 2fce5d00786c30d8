// The exact rung's kernels for avx2. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA avx2
#include "exact/exact_table.h"

namespace lumbrical::avx2 {
const ExactKernels kExactKernels =
    table_of<xsimd::batch<double, xsimd::avx2>, xsimd::batch<float, xsimd::avx2>>();
}
