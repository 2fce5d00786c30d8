// The exact rung's kernels for sse2. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA sse2
#include "exact/exact_table.h"

namespace lumbrical::sse2 {
const ExactKernels kExactKernels =
    table_of<xsimd::batch<double, xsimd::sse2>, xsimd::batch<float, xsimd::sse2>>();
}
