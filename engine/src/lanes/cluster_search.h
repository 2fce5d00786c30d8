// The search for clusters of triangles that are one contact of a primitive each, from the largest down.
#pragma once

#include <span>

#include "lanes/field_kernels.h"
#include "lumbrical/search_memory.h"
#include "model/primitive.h"

namespace lumbrical {

/// Sets the field of `primitive`, of which the palm is `palm`; returns what it is seen from: the larger end.
/// [m] W
Vec3 set_shape(const Primitive& primitive, const Prism& palm, FieldShape<double>& shape);

/// Are clusters used for this primitive? Those under the field law, but for phalanges that another one of
/// their finger is folded upon.
bool uses_clusters(const Model& model, const Primitives& hand, const Primitive& primitive);

struct FoundClusters {
  std::span<const std::uint32_t> used;   ///< clusters; each is a contact, if it has an area
  std::span<const std::uint32_t> split;  ///< leaves; the same, but triangle by triangle
  std::span<const std::uint32_t> open;   ///< leaves, whose triangles have to be looked at one by one
};

/// Triangles of the primitive's contacts are in the one or the other. A function of model and primitive only.
/// The answer is in `memory` until the next call.
FoundClusters find_clusters(const Model& model, const Primitives& hand, const Primitive& primitive,
                            const FieldKernels& kernels, SearchMemory& memory);

/// Sizes the working memory.
void size_clusters(const Model& model, SearchMemory& memory);

}  // namespace lumbrical
