// The kernels of samples for sse2. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA sse2
#include "samples/sample_table.h"

namespace lumbrical::sse2 {
const SampleKernels kSampleKernels = table_of<xsimd::batch<float, xsimd::sse2>>();
}
