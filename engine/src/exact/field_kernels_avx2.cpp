// The field law's kernels for avx2. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA avx2
#include "exact/field_table.h"

namespace lumbrical::avx2 {
const FieldKernels kFieldKernels =
    table_of<xsimd::batch<double, xsimd::avx2>, xsimd::batch<float, xsimd::avx2>>();
}
