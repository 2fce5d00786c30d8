// The field law's kernels for scalar. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA scalar
#include "disc_integrals.h"
#include "field_kernels.h"

namespace lumbrical::scalar {

using Double = double;
const FieldKernels kFieldKernels{closed_terms<Double>};

}  // namespace lumbrical::scalar
