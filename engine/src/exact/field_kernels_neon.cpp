// The field law's kernels for neon. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA neon
#include "exact/field_table.h"

namespace lumbrical::neon {
const FieldKernels kFieldKernels =
    table_of<xsimd::batch<double, xsimd::neon64>, xsimd::batch<float, xsimd::neon64>>();
}
