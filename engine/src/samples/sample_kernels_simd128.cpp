// The kernels of samples for simd128. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA simd128
#include "samples/sample_table.h"

namespace lumbrical::simd128 {
const SampleKernels kSampleKernels = table_of<xsimd::batch<float, xsimd::sse2>>();
}
