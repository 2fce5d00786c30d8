// The contact of a leaf of clusters whose triangles are looked at one by one (leaf_forces.h), summed up.
#pragma once

#include <span>

#include "lanes/cluster_search.h"
#include "lumbrical/contact.h"
#include "model/primitive.h"

namespace lumbrical {

/// What of a primitive its leaves have in common; `terms` is working memory.
struct LeafQuery {
  Vec3 origin;  ///< [m] W, the primitive's larger end
  TileCuts cuts;
  LeafTerms terms;
};
void set_leaf_query(const Primitives& hand, const Primitive& primitive, LeafQuery& query);

/// Asks the memory for what the leaf's contact will need.
void prefetch_leaf(const Model& model, std::uint32_t leaf);

/// Sets all but the indices of the contact of the leaf that contact.triangle stands for; an area of zero
/// where there is none. False where a curved border runs through it that is not straight enough for the
/// tolerance: the triangles' contacts are to be computed and summed up.
[[nodiscard]] bool leaf_contact(const Model& model, const FieldKernels& kernels, LeafQuery& query,
                                Contact& contact);

/// The same from the contacts of the leaf's triangles, those with an area of zero left out.
void sum_leaf(const Model& model, const LeafQuery& query, std::span<const Contact> parts, Contact& contact);

}  // namespace lumbrical
