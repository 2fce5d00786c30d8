// The table of kernels for two types of lanes, of which samples take the second.
#pragma once

#include "samples/block_kernels.h"
#include "samples/body_hits.h"
#include "samples/classify.h"
#include "samples/deepest_kernels.h"
#include "samples/palm_kernels.h"
#include "samples/parts_kernels.h"
#include "samples/tile_kernels.h"

namespace lumbrical::LUMBRICAL_ISA {

template <class, class V>
constexpr SampleKernels table_of() {
  return {sort_blocks<V>,     sort_palm_blocks<V>, classify_finger<V>, classify_palm<V>, tile_lattice<V>,
          shared_lattice<V>,  tile_rule<V>,        tile_blocks<V>,     palm_blocks<V>,   palm_through<V>,
          palm_side<V>,       palm_lattice<V>,     finger_hits<V>,     palm_hits<V>,     outdone_lanes<V>,
          deepest_lattice<V>, parts_lattice<V>};
}

}  // namespace lumbrical::LUMBRICAL_ISA
