// Pairs of a slab of the palm with triangles: through the kernel of all (slab_contacts.h), and where faces
// cut them through that of rims (slab_rims.h).
#pragma once

#include <span>

#include "exact/pair_slots.h"

namespace lumbrical {

/// Sets all of the contacts in slots `list` but their indices. Those left to `collide_slab` are added to
/// `alone`.
void collide_slab_pairs(const PairSlots& pairs, const Slab& slab, std::span<const std::uint32_t> list,
                        PairList& alone);

}  // namespace lumbrical
