#include "lanes/cluster_batch.h"

#include "lanes/cluster_search.h"
#include "lanes/lane_vectors.h"

namespace lumbrical {
namespace {

// Kernels compute whole registers: the last one is filled with copies of a cluster.
void pad(ClusterTerms& terms) {
  const auto copy = [&](auto& row, std::size_t to) { row[to] = row[0]; };
  for (std::size_t k = terms.count; k % 8 != 0; ++k) {
    for (auto* vector : {&terms.centre, &terms.mean_normal, &terms.box, &terms.normal, &terms.first[0],
                         &terms.first[1], &terms.first[2], &terms.second[0], &terms.second[1],
                         &terms.second[2], &terms.second[3], &terms.second[4], &terms.second[5]}) {
      for (auto& row : *vector) copy(row, k);
    }
    for (auto* row : {&terms.radius, &terms.thickness, &terms.surface}) copy(*row, k);
  }
}

}  // namespace

void begin_batch(const Primitive& primitive, const SweptPolygon& palm, ClusterBatch& batch) {
  batch.origin = set_shape(primitive, palm, batch.terms.shape);
  batch.from_end = batch.tree.origin - batch.origin;
  batch.terms.count = 0;
}

void add_to_batch(Contact& contact, ClusterBatch& batch) {
  ClusterTerms& terms = batch.terms;
  const std::size_t k = terms.count++;
  const std::uint32_t cluster = cluster_of(contact.triangle);
  const ClusterBlock& block = batch.tree.block[cluster / ClusterBlock::kWidth];
  const ClusterMoments& moments = batch.tree.moments[cluster];
  const std::size_t lane = cluster % ClusterBlock::kWidth;
  put_vector(batch.from_end + Vec3{block.x[lane], block.y[lane], block.z[lane]}, k, terms.centre);
  put_vector({block.nx[lane], block.ny[lane], block.nz[lane]}, k, terms.mean_normal);
  put_vector({block.bx[lane], block.by[lane], block.bz[lane]}, k, terms.box);
  terms.radius[k] = block.r[lane];
  terms.thickness[k] = block.thickness[lane];
  terms.surface[k] = moments.area;
  put_vector(vector_of(moments.normal), k, terms.normal);
  for (std::size_t j = 0; j < 3; ++j) put_vector(vector_of(moments.first[j]), k, terms.first[j]);
  for (std::size_t m = 0; m < 6; ++m) put_vector(vector_of(moments.second[m]), k, terms.second[m]);
  batch.contact[k] = &contact;
}

void finish_batch(ClusterBatch& batch) {
  ClusterTerms& terms = batch.terms;
  if (terms.count == 0) return;
  pad(terms);
  batch.kernels.cluster_forces(terms);
  for (std::size_t k = 0; k < terms.count; ++k) {
    Contact& contact = *batch.contact[k];
    contact.depth = terms.depth[k];
    contact.area = terms.area[k];
    contact.volume = terms.volume[k];
    contact.error = terms.error[k];
    contact.centroid = batch.origin + vector_at(terms.centre, k);
    contact.centre = batch.origin + vector_at(terms.acting, k);
    contact.normal = vector_at(terms.direction, k);
  }
  terms.count = 0;
}

}  // namespace lumbrical
