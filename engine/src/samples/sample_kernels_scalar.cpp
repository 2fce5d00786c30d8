// The kernels of samples for scalar. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA scalar
#include "samples/sample_table.h"

namespace lumbrical::scalar {
const SampleKernels kSampleKernels = table_of<float>();
}
