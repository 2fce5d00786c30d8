// The table of kernels for two types of lanes.
#pragma once

#include "lanes/border_bulges.h"
#include "lanes/certain_misses.h"
#include "lanes/cone_slivers.h"
#include "lanes/field_across.h"
#include "lanes/field_kernels.h"
#include "lanes/pair_kinds.h"
#include "lanes/round_contacts.h"
#include "lanes/slab_contacts.h"
#include "lanes/slab_rims.h"
#include "lanes/sphere_hits.h"
#include "lanes/strip_integrals.h"

namespace lumbrical::LUMBRICAL_ISA {

template <class Double, class Single>
constexpr FieldKernels table_of() {
  return {pair_kinds<Double>,    round_contacts<Double>, strip_nodes<Double>,    cone_slivers<Double>,
          field_across<Double>,  border_bulges<Double>,  certain_misses<Double>, sphere_hits<Single>,
          slab_contacts<Double>, slab_rims<Double>};
}

}  // namespace lumbrical::LUMBRICAL_ISA
