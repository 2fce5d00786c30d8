// The field law's kernels for neon. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA neon
#include "disc_integrals.h"
#include "field_kernels.h"

namespace lumbrical::neon {

using Double = xsimd::batch<double, xsimd::neon64>;
const FieldKernels kFieldKernels{closed_terms<Double>};

}  // namespace lumbrical::neon
