// The contact of a leaf of clusters whose triangles are looked at one by one (leaf_forces.h), summed up.
#pragma once

#include "lanes/field_kernels.h"
#include "lumbrical/contact.h"
#include "model/primitive.h"

namespace lumbrical {

/// What of a primitive its leaves have in common; `terms` is working memory.
struct LeafQuery {
  Vec3 origin;          ///< [m] W, the primitive's larger end
  int plane_count = 0;  ///< half-spaces the primitive lies in, from there: unit normal and height
  double plane[18][4];
  LeafTerms terms;
};
void set_leaf_query(const Primitive& primitive, const Prism& palm, LeafQuery& query);

/// Asks the memory for what the leaf's contact will need: `far` ahead its own records, nearer the corners'
/// numbers.
void prefetch_leaf(const Model& model, std::uint32_t leaf, bool far);

/// Sets all but the indices of the contact of the leaf that contact.triangle stands for; an area of zero
/// where there is none.
void leaf_contact(const Model& model, const FieldKernels& kernels, LeafQuery& query, Contact& contact);

}  // namespace lumbrical
