// The exact rung's kernels for neon. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA neon
#include "exact/exact_table.h"

namespace lumbrical::neon {
const ExactKernels kExactKernels =
    table_of<xsimd::batch<double, xsimd::neon64>, xsimd::batch<float, xsimd::neon64>>();
}
