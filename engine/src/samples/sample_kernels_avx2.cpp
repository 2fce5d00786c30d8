// The kernels of samples for avx2. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA avx2
#include "samples/sample_table.h"

namespace lumbrical::avx2 {
const SampleKernels kSampleKernels = table_of<xsimd::batch<float, xsimd::avx2>>();
}
