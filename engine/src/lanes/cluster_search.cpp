#include "lanes/cluster_search.h"

#include <algorithm>
#include <cmath>

#include "lanes/lane_vectors.h"
#include "lanes/round_batch.h"

namespace lumbrical {
namespace {

// Share by which single precision may move a coordinate of the query, generously.
constexpr double kFloatSlack = 1.6e-6;

float number(double value) { return static_cast<float>(value); }

double largest_part(Vec3 v) { return max(std::fabs(v.x), max(std::fabs(v.y), std::fabs(v.z))); }

void add_plane(const HalfSpace& space, Vec3 origin, double margin, ClusterQuery& query) {
  const Vec3 n = space.normal;
  query.plane[query.plane_count++] = {number(n.x), number(n.y), number(n.z),
                                      number(dot(n, space.point - origin)), number(margin)};
}

FieldShape<float> in_single(const FieldShape<double>& shape) {
  FieldShape<float> single;
  single.flat = shape.flat;
  for (std::size_t i = 0; i < 3; ++i) single.axis[i] = number(shape.axis[i]);
  single.length = number(shape.length);
  single.radius1 = number(shape.radius1);
  single.radius2 = number(shape.radius2);
  single.sine = number(shape.sine);
  single.cosine = number(shape.cosine);
  single.jointed = number(shape.jointed);
  for (std::size_t i = 0; i < 4; ++i) single.face[i] = number(shape.face[i]);
  single.size = number(shape.size);
  return single;
}

ClusterQuery cluster_query(const ClusterTree& tree, const Prism& palm, const Primitive& primitive,
                           double tolerance) {
  FieldShape<double> shape;
  const Vec3 origin = set_shape(primitive, palm, shape), from = origin - tree.origin;
  ClusterQuery query;
  query.shape = in_single(shape);
  query.x = number(from.x);
  query.y = number(from.y);
  query.z = number(from.z);
  if (shape.flat) {
    for (int i = 1; i < palm.face_count; ++i)
      add_plane(palm.face[static_cast<std::size_t>(i)], origin, 0, query);
  } else {
    for (std::size_t i = 0; i < primitive.cut_count; ++i)
      add_plane(primitive.cut[i], origin, primitive.overhang[i], query);
  }
  query.slack = number(kFloatSlack * (largest_part(from) + shape.length + shape.radius1));
  query.allowed = number((tolerance - kMomentRounding) * shape.size);
  // The normals of a cluster differ by about thickness / radius, and their twist has levers of its radius.
  query.twist = number(4 * shape.size * (tolerance - kMomentRounding) * shape.size);
  return query;
}

// Half the palm's thickness: what stands for R in its errors and tolerance. [m]
double half_thickness(const Prism& palm) {
  return palm.face_count < 2
             ? 0
             : 0.5 * std::fabs(dot(palm.face[0].normal, palm.face[0].point - palm.face[1].point));
}

}  // namespace

Vec3 set_shape(const Primitive& primitive, const Prism& palm, FieldShape<double>& shape) {
  const RoundHull hull = round_hull(primitive);
  shape.flat = primitive.shape == Shape::prism;
  put_vector(hull.axis, shape.axis);
  shape.length = hull.length;
  shape.radius1 = hull.radius1;
  shape.radius2 = hull.radius2;
  shape.sine = hull.sine;
  shape.cosine = hull.cosine;
  shape.jointed = hull.length > 0 ? 1 : 0;
  shape.size = shape.flat ? half_thickness(palm) : hull.radius1;
  if (shape.flat) put_plane(palm.face[0], hull.origin, shape.face);
  return hull.origin;
}

bool uses_clusters(const Model& model, const Primitives& hand, const Primitive& primitive) {
  if (model.clusters.triangle.empty() || primitive.law != Law::field) return false;
  if (primitive.shape == Shape::prism) return half_thickness(hand.palm) > 0;
  if (!suits_batch(primitive)) return false;
  const std::size_t place = primitive.segment % 3;
  return primitive.segment >= kPhalanxCount || place == 1 || !hand.folded[primitive.segment / 3];
}

FoundClusters find_clusters(const Model& model, const Primitives& hand, const Primitive& primitive,
                            const FieldKernels& kernels, SearchMemory& memory) {
  const ClusterTree& tree = model.clusters;
  constexpr std::uint32_t kWidth = ClusterBlock::kWidth;
  const ClusterQuery query = cluster_query(tree, hand.palm, primitive, model.settings.tolerance);
  auto& [now, next] = memory.open_clusters;
  ClusterHits hits;
  hits.use = memory.used_clusters.data();
  hits.split = memory.split_leaves.data();
  std::size_t size = tree.level.size() - 2;  // of the largest clusters
  std::size_t count = 0;
  for (std::uint32_t i = tree.level[size]; i < tree.level[size + 1]; i += kWidth) now[count++] = i / kWidth;
  for (;; --size) {
    hits.open = next.data();
    hits.open_count = 0;
    hits.leaves = size == 0;
    kernels.cluster_kinds(tree.block.data(), query, now.data(), count, hits);
    if (size == 0) break;
    // The children of cluster i of a size are block i of the next one.
    count = hits.open_count;
    const std::uint32_t first = tree.level[size], below = tree.level[size - 1] / kWidth;
    for (std::size_t i = 0; i < count; ++i) now[i] = next[i] - first + below;
  }
  return {{hits.use, hits.use_count}, {hits.split, hits.split_count}, {hits.open, hits.open_count}};
}

void size_clusters(const Model& model, SearchMemory& memory) {
  const ClusterTree& tree = model.clusters;
  if (tree.triangle.empty()) return;
  const std::size_t leaves = tree.level[1];
  for (auto& open : memory.open_clusters) open.resize(leaves);
  memory.used_clusters.resize(tree.level.back());
  memory.split_leaves.resize(leaves);
  if (!tree.place.empty()) memory.open_leaves.assign((leaves + 63) / 64, 0);
}

}  // namespace lumbrical
