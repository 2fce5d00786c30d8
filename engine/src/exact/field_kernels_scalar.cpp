// The field law's kernels for scalar. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA scalar
#include "exact/field_table.h"

namespace lumbrical::scalar {
const FieldKernels kFieldKernels = table_of<double, float>();
}
