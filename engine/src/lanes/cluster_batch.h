// Clusters of one primitive, gathered for the kernel that makes contacts of them (cluster_forces.h).
#pragma once

#include <array>

#include "lanes/field_kernels.h"
#include "lumbrical/contact.h"
#include "model/primitive.h"

namespace lumbrical {

/// Working memory of one thread.
struct ClusterBatch {
  ClusterBatch(const ClusterTree& clusters, const FieldKernels& table) : tree(clusters), kernels(table) {}
  const ClusterTree& tree;
  const FieldKernels& kernels;
  Vec3 origin;    ///< [m] W, the primitive's larger end
  Vec3 from_end;  ///< [m] from there to the tree's origin
  ClusterTerms terms;
  std::array<Contact*, ClusterTerms::kCapacity> contact;  ///< of each
};

/// Asks the memory for what a contact of this cluster will need.
inline void prefetch_cluster(const ClusterTree& tree, std::uint32_t cluster) {
  const auto* const moments = reinterpret_cast<const char*>(&tree.moments[cluster]);
  const auto* const block = reinterpret_cast<const char*>(&tree.block[cluster / ClusterBlock::kWidth]);
  for (const char* line : {moments, moments + 64, block, block + 64, block + 128}) __builtin_prefetch(line);
}

/// Empties the batch for clusters of `primitive`.
void begin_batch(const Primitive& primitive, const SweptPolygon& palm, ClusterBatch& batch);

inline bool is_full(const ClusterBatch& batch) { return batch.terms.count == ClusterTerms::kCapacity; }

/// Adds the cluster contact.triangle stands for.
void add_to_batch(Contact& contact, ClusterBatch& batch);

/// Computes the contacts, but for their indices, and empties the batch.
void finish_batch(ClusterBatch& batch);

}  // namespace lumbrical
