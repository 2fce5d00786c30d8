// The exact rung's kernels for avx512. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA avx512
#include "exact/exact_table.h"

namespace lumbrical::avx512 {
const ExactKernels kExactKernels =
    table_of<xsimd::batch<double, xsimd::avx512bw>, xsimd::batch<float, xsimd::avx512bw>>();
}
