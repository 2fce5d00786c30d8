// The table of kernels for two types of lanes.
#pragma once

#include "exact/border_bulges.h"
#include "exact/cone_slivers.h"
#include "exact/exact_kernels.h"
#include "exact/field_across.h"
#include "exact/pair_kinds.h"
#include "exact/paper_contacts.h"
#include "exact/round_contacts.h"
#include "exact/slab_contacts.h"
#include "exact/slab_rims.h"
#include "exact/strip_integrals.h"
#include "search/certain_misses.h"
#include "search/sphere_hits.h"

namespace lumbrical::LUMBRICAL_ISA {

template <class Double, class Single>
constexpr ExactKernels table_of() {
  return {pair_kinds<Double>,   round_contacts<Double>, paper_contacts<Double>, strip_nodes<Double>,
          cone_slivers<Double>, field_across<Double>,   border_bulges<Double>,  certain_misses<Double>,
          sphere_hits<Single>,  slab_contacts<Double>,  slab_rims<Double>};
}

}  // namespace lumbrical::LUMBRICAL_ISA
