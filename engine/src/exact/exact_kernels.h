// The exact rung's kernels, one table per instruction set.
#pragma once

#include "exact/border_terms.h"
#include "exact/crossing_terms.h"
#include "exact/kind_terms.h"
#include "exact/round_terms.h"
#include "exact/slab_terms.h"
#include "exact/strip_terms.h"
#include "lumbrical/model.h"
#include "search/miss_terms.h"
#include "search/sphere_query.h"

namespace lumbrical {

/// Each computes the results of all terms; arrays are padded to 64 bytes with harmless copies. Every
/// table gives the same bits.
struct ExactKernels {
  void (*pair_kinds)(KindTerms&);
  void (*round_contacts)(RoundTerms&);
  void (*paper_contacts)(RoundTerms&);
  void (*strip_nodes)(const StripSection&, StripNodes&);
  void (*cone_slivers)(RoundTerms&);
  void (*field_across)(CrossingTerms&);
  void (*border_bulges)(BorderTerms&);
  void (*certain_misses)(MissTerms&);
  std::size_t (*sphere_hits)(const SphereBlock* spheres, const SphereQuery&, const std::uint32_t* blocks,
                             std::size_t block_count, std::uint32_t* hits);
  void (*slab_contacts)(SlabTerms&);
  void (*slab_rims)(RimTerms&);
};

namespace scalar {
extern const ExactKernels kExactKernels;
}
namespace sse2 {
extern const ExactKernels kExactKernels;
}
namespace avx2 {
extern const ExactKernels kExactKernels;
}
namespace avx512 {
extern const ExactKernels kExactKernels;
}
namespace neon {
extern const ExactKernels kExactKernels;
}
namespace simd128 {
extern const ExactKernels kExactKernels;
}

/// The table of an instruction set that is available.
const ExactKernels& exact_kernels(Isa isa);

}  // namespace lumbrical
