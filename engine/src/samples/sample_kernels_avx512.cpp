// The kernels of samples for avx512. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA avx512
#include "samples/sample_table.h"

namespace lumbrical::avx512 {
const SampleKernels kSampleKernels = table_of<xsimd::batch<float, xsimd::avx512bw>>();
}
