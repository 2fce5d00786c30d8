// The kernels of samples for neon. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA neon
#include "samples/sample_table.h"

namespace lumbrical::neon {
const SampleKernels kSampleKernels = table_of<xsimd::batch<float, xsimd::neon64>>();
}
