// The search for clusters of triangles that are one contact of a primitive each, from the largest down.
#pragma once

#include <array>
#include <span>

#include "lanes/field_kernels.h"
#include "lumbrical/search_memory.h"
#include "model/primitive.h"

namespace lumbrical {

/// Sets the field of `primitive`, of a hand with this palm; returns what it is seen from: the larger end.
/// [m] W
Vec3 set_shape(const Primitive& primitive, const SweptPolygon& palm, FieldShape<double>& shape);

/// What a primitive is cut by besides a slab's skin.
struct TileCuts {
  int count = 0;
  CutShape<double> cut[ClusterQuery::kCutCapacity];
  double margin[ClusterQuery::kCutCapacity];  ///< [m] so near a cut the space may be a neighbour's, or not
};
/// Sets them as seen from `origin` [m, W].
void set_cuts(const Primitives& hand, const Primitive& primitive, Vec3 origin, TileCuts& cuts);

/// Are clusters used for this primitive? Those under the field law, but for phalanges that another one of
/// their finger is folded upon.
bool uses_clusters(const Model& model, const Primitives& hand, const Primitive& primitive);

struct FoundClusters {
  static constexpr std::size_t kMaxSizes = 16;
  std::size_t size_count = 0;
  /// Clusters by their size, the leaves first; each is a contact, if it has an area.
  std::array<std::span<const std::uint32_t>, kMaxSizes> used;
  std::span<const std::uint32_t> split;  ///< leaves; the same, but triangle by triangle
  std::span<const std::uint32_t> open;   ///< leaves, whose triangles have to be looked at one by one
};

/// Triangles of the primitive's contacts are in the one or the other. All numbers are ascending, so those of
/// larger clusters are larger. A function of model and primitive only.
/// The answer is in `memory` until the next call.
FoundClusters find_clusters(const Model& model, const Primitives& hand, const Primitive& primitive,
                            const FieldKernels& kernels, SearchMemory& memory);

/// Sizes the working memory.
void size_clusters(const Model& model, SearchMemory& memory);

}  // namespace lumbrical
