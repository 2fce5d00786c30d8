#include "lanes/leaf_contact.h"

#include <algorithm>
#include <cmath>

#include "lanes/cluster_search.h"
#include "lanes/lane_vectors.h"

namespace lumbrical {
namespace {

// Triangles of the leaf; empty lanes hold a point.
double put_corners(const Model& model, std::uint32_t leaf, Vec3 origin, LeafTerms& terms) {
  const Triangles& world = model.triangles;
  const ClusterTree& tree = model.clusters;
  const std::size_t first = std::size_t{leaf} * ClusterTree::kLeafSize;
  for (std::size_t k = 0; k < LeafTerms::kCapacity; ++k) {
    const std::uint32_t triangle = tree.triangle[first + k < tree.triangle.size() ? first + k : first];
    const bool there = first + k < tree.triangle.size();
    const std::uint32_t vertex[] = {world.a[triangle], there ? world.b[triangle] : world.a[triangle],
                                    there ? world.c[triangle] : world.a[triangle]};
    for (std::size_t c = 0; c < 3; ++c) {
      terms.corner[c][0][k] = world.x[vertex[c]] - origin.x;
      terms.corner[c][1][k] = world.y[vertex[c]] - origin.y;
      terms.corner[c][2][k] = world.z[vertex[c]] - origin.z;
    }
  }
  return tree.moments[leaf].area;
}

// Planes that may run through the leaf; where there are fewer, one that everything is inside of.
void put_planes(const LeafQuery& query, Vec3 centre, double radius, LeafTerms& terms) {
  terms.plane_count = 0;
  for (double(&plane)[4] : terms.plane) {
    plane[0] = plane[1] = plane[2] = 0;
    plane[3] = 1;
  }
  for (int i = 0; i < query.plane_count && terms.plane_count < LeafTerms::kPlaneCapacity; ++i) {
    const auto& plane = query.plane[i];
    const double height = dot(centre, {plane[0], plane[1], plane[2]}) - plane[3];
    if (height <= -radius) continue;
    for (int k = 0; k < 4; ++k) terms.plane[terms.plane_count][k] = plane[k];
    ++terms.plane_count;
  }
}

double sum_of(const double (&row)[LeafTerms::kCapacity]) {
  double sum = 0;
  for (const double value : row) sum += value;
  return sum;
}

// The cluster's wrench as one force beside its centre; returns the couple that it can't carry.
double put_force(Vec3 force, Vec3 couple, Vec3 centre, double radius, Contact& contact) {
  contact.volume = norm(force);
  contact.normal = unit_or(force, {0, 0, 1});
  Vec3 shift;
  if (contact.volume > 0) shift = cross(contact.normal, couple) / contact.volume;
  const double way = norm(shift);
  if (way > radius) shift = (radius / way) * shift;
  contact.centre = centre + shift;
  return norm(couple - cross(shift, force));
}

}  // namespace

void set_leaf_query(const Primitive& primitive, const Prism& palm, LeafQuery& query) {
  query.origin = set_shape(primitive, palm, query.terms.shape);
  query.plane_count = 0;
  const auto add = [&](const HalfSpace& space) {
    put_plane(space, query.origin, query.plane[query.plane_count++]);
  };
  if (query.terms.shape.flat) {
    for (int i = 1; i < palm.face_count; ++i) add(palm.face[static_cast<std::size_t>(i)]);
  } else {
    for (std::size_t i = 0; i < primitive.cut_count; ++i) add(primitive.cut[i]);
  }
}

void prefetch_leaf(const Model& model, std::uint32_t leaf, bool far) {
  const std::uint32_t* const triangle = &model.clusters.triangle[std::size_t{leaf} * ClusterTree::kLeafSize];
  if (far) {
    __builtin_prefetch(triangle);
    __builtin_prefetch(&model.clusters.block[leaf / ClusterBlock::kWidth]);
    __builtin_prefetch(&model.clusters.moments[leaf].area);
    return;
  }
  const std::size_t last =
      std::min(model.clusters.triangle.size() - std::size_t{leaf} * ClusterTree::kLeafSize,
               std::size_t{ClusterTree::kLeafSize}) -
      1;
  // Triangles of a leaf are neighbours in most meshes: two of them bring most of the lines.
  for (const std::uint32_t t : {triangle[0], triangle[last]}) {
    __builtin_prefetch(&model.triangles.a[t]);
    __builtin_prefetch(&model.triangles.b[t]);
    __builtin_prefetch(&model.triangles.c[t]);
  }
}

void leaf_contact(const Model& model, const FieldKernels& kernels, LeafQuery& query, Contact& contact) {
  const std::uint32_t leaf = cluster_of(contact.triangle);
  const ClusterBlock& block = model.clusters.block[leaf / ClusterBlock::kWidth];
  const std::size_t lane = leaf % ClusterBlock::kWidth;
  const double radius = block.r[lane];
  LeafTerms& terms = query.terms;
  const FieldShape<double>& shape = terms.shape;
  const Vec3 centre =
      (model.clusters.origin - query.origin) + Vec3{block.x[lane], block.y[lane], block.z[lane]};
  put_vector(centre, terms.centre);
  put_planes(query, centre, radius, terms);
  const double surface = put_corners(model, leaf, query.origin, terms);
  kernels.leaf_forces(terms);

  double most = terms.result[10][0], sum[10];
  for (const double value : terms.result[10]) most = max(most, value);
  for (std::size_t row = 0; row < 10; ++row) sum[row] = sum_of(terms.result[row]);
  // The field bends by at most one over the distance from the axis, so it rises over the corners' plane by
  // half the square of the radius over that.
  const Vec3 axis = vector_of(shape.axis);
  const Vec3 nearest = clamp(dot(centre, axis), 0, shape.length) * axis;
  const double gap = norm(centre - nearest) - radius;
  const double off = shape.flat ? 0 : 0.5 * radius * radius / gap;
  contact.area = most > -off ? max(sum[6], 1e-6 * surface) : 0;
  if (!(contact.area > 0)) return;
  const double left = put_force({sum[0], sum[1], sum[2]}, {sum[3], sum[4], sum[5]}, centre, radius, contact);
  const double error = (off + kMomentRounding * shape.size) * surface;
  contact.error = max(error, (2 * radius * error + left) / (4 * shape.size));
  contact.depth = max(0, most);
  contact.centre += query.origin;
  contact.centroid = query.origin + centre;
  if (sum[6] > 1e-6 * surface) contact.centroid += (1 / sum[6]) * Vec3{sum[7], sum[8], sum[9]};
}

}  // namespace lumbrical
