// The exact rung's kernels for scalar. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA scalar
#include "exact/exact_table.h"

namespace lumbrical::scalar {
const ExactKernels kExactKernels = table_of<double, float>();
}
