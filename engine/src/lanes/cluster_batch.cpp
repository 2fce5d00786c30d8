#include "lanes/cluster_batch.h"

#include "lanes/cluster_search.h"
#include "lanes/round_batch.h"

namespace lumbrical {
namespace {

constexpr std::size_t kCapacity = ClusterTerms::kCapacity;

void put_vector(const float (&v)[3], std::size_t k, double (&to)[3][kCapacity]) {
  for (std::size_t axis = 0; axis < 3; ++axis) to[axis][k] = v[axis];
}

Vec3 vector_at(const double (&from)[3][kCapacity], std::size_t k) {
  return {from[0][k], from[1][k], from[2][k]};
}

// Kernels compute whole registers: the last one is filled with copies of a cluster.
void pad(ClusterTerms& terms) {
  const auto copy = [&](auto& row, std::size_t to) { row[to] = row[0]; };
  for (std::size_t k = terms.count; k % 8 != 0; ++k) {
    for (auto* vector : {&terms.centre, &terms.mean_normal, &terms.normal, &terms.first[0], &terms.first[1],
                         &terms.first[2], &terms.second[0], &terms.second[1], &terms.second[2],
                         &terms.second[3], &terms.second[4], &terms.second[5]}) {
      for (auto& row : *vector) copy(row, k);
    }
    for (auto* row : {&terms.radius, &terms.thickness, &terms.surface}) copy(*row, k);
  }
}

}  // namespace

void begin_batch(const Primitive& primitive, const Prism& palm, ClusterBatch& batch) {
  const RoundHull hull = round_hull(primitive);
  ClusterTerms& terms = batch.terms;
  batch.origin = hull.origin;
  batch.from_end = batch.tree.origin - hull.origin;
  terms.count = 0;
  terms.flat = primitive.shape == Shape::prism;
  terms.axis[0] = hull.axis.x;
  terms.axis[1] = hull.axis.y;
  terms.axis[2] = hull.axis.z;
  terms.length = hull.length;
  terms.radius1 = hull.radius1;
  terms.radius2 = hull.radius2;
  terms.sine = hull.sine;
  terms.cosine = hull.cosine;
  terms.jointed = hull.length > 0 ? 1 : 0;
  terms.size = terms.flat ? half_thickness(palm) : hull.radius1;
  if (!terms.flat) return;
  const HalfSpace& face = palm.face[0];
  terms.face[0] = face.normal.x;
  terms.face[1] = face.normal.y;
  terms.face[2] = face.normal.z;
  terms.face[3] = dot(face.normal, face.point - hull.origin);
}

void add_to_batch(Contact& contact, ClusterBatch& batch) {
  ClusterTerms& terms = batch.terms;
  const std::size_t k = terms.count++;
  const std::uint32_t cluster = cluster_of(contact.triangle);
  const ClusterBlock& block = batch.tree.block[cluster / ClusterBlock::kWidth];
  const ClusterMoments& moments = batch.tree.moments[cluster];
  const std::size_t lane = cluster % ClusterBlock::kWidth;
  terms.centre[0][k] = batch.from_end.x + block.x[lane];
  terms.centre[1][k] = batch.from_end.y + block.y[lane];
  terms.centre[2][k] = batch.from_end.z + block.z[lane];
  terms.radius[k] = block.r[lane];
  terms.mean_normal[0][k] = block.nx[lane];
  terms.mean_normal[1][k] = block.ny[lane];
  terms.mean_normal[2][k] = block.nz[lane];
  terms.thickness[k] = block.thickness[lane];
  terms.surface[k] = moments.area;
  put_vector(moments.normal, k, terms.normal);
  for (std::size_t j = 0; j < 3; ++j) put_vector(moments.first[j], k, terms.first[j]);
  for (std::size_t m = 0; m < 6; ++m) put_vector(moments.second[m], k, terms.second[m]);
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
