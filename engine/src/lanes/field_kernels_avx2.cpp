// The field law's kernels for avx2. Nothing else may be compiled with this file's flags.
#define LUMBRICAL_ISA avx2
#include "lanes/border_bulges.h"
#include "lanes/certain_misses.h"
#include "lanes/cluster_forces.h"
#include "lanes/cluster_kinds.h"
#include "lanes/cone_slivers.h"
#include "lanes/field_across.h"
#include "lanes/field_kernels.h"
#include "lanes/leaf_forces.h"
#include "lanes/round_contacts.h"
#include "lanes/slab_contacts.h"
#include "lanes/slab_rims.h"
#include "lanes/sphere_hits.h"
#include "lanes/strip_integrals.h"

namespace lumbrical::avx2 {

using Double = xsimd::batch<double, xsimd::avx2>;
using Single = xsimd::batch<float, xsimd::avx2>;
const FieldKernels kFieldKernels{round_contacts<Double>, strip_nodes<Double>,   cone_slivers<Double>,
                                 field_across<Double>,   border_bulges<Double>, certain_misses<Double>,
                                 sphere_hits<Single>,    cluster_kinds<Single>, cluster_forces<Double>,
                                 leaf_forces<Double>,    slab_contacts<Double>, slab_rims<Double>};

}  // namespace lumbrical::avx2
