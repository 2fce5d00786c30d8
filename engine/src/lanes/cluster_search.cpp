#include "lanes/cluster_search.h"

#include <algorithm>
#include <cmath>

#include "lanes/lane_vectors.h"
#include "lanes/round_batch.h"
#include "model/swept_polygon.h"

namespace lumbrical {
namespace {

// Share by which single precision may move a coordinate of the query, generously.
constexpr double kFloatSlack = 1.6e-6;

float number(double value) { return static_cast<float>(value); }

double largest_part(Vec3 v) { return max(std::fabs(v.x), max(std::fabs(v.y), std::fabs(v.z))); }

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

CutShape<float> in_single(const CutShape<double>& cut) {
  CutShape<float> single;
  for (std::size_t i = 0; i < 3; ++i) single.normal[i] = number(cut.normal[i]);
  single.height = number(cut.height);
  for (std::size_t i = 0; i < 4; ++i) {
    single.x[i] = number(cut.x[i]);
    single.y[i] = number(cut.y[i]);
  }
  single.bow = number(cut.bow);
  single.slope = number(cut.slope);
  single.steep = number(cut.steep);
  return single;
}

ClusterQuery cluster_query(const ClusterTree& tree, const Primitives& hand, const Primitive& primitive,
                           double tolerance) {
  FieldShape<double> shape;
  const Vec3 origin = set_shape(primitive, hand.palm, shape), from = origin - tree.origin;
  ClusterQuery query;
  query.shape = in_single(shape);
  query.x = number(from.x);
  query.y = number(from.y);
  query.z = number(from.z);
  TileCuts cuts;
  set_cuts(hand, primitive, origin, cuts);
  query.cut_count = cuts.count;
  for (int k = 0; k < cuts.count; ++k) {
    query.cut[k] = in_single(cuts.cut[k]);
    query.margin[k] = number(cuts.margin[k]);
  }
  query.slack = number(kFloatSlack * (largest_part(from) + shape.length + shape.radius1));
  query.allowed = number((tolerance - kMomentRounding) * shape.size);
  // The normals of a cluster differ by about thickness / radius, and their twist has levers of its radius.
  query.twist = number(4 * shape.size * (tolerance - kMomentRounding) * shape.size);
  return query;
}

// The border that a tile's cut stands for (add_body in hand_pose.cpp); null where it is no more than a plane.
const JointBorder* border_at(const Primitives& hand, const Primitive& tile, std::size_t cut) {
  if (!(tile.overhang[cut] > 0)) return nullptr;
  const std::size_t i = tile.segment;
  return &hand.border[cut == 0 && i % 3 > 0 && hand.present[i - 1] ? i - 1 : i];
}

CutShape<double> plane_cut(const HalfSpace& space, Vec3 origin) {
  CutShape<double> cut;
  put_vector(space.normal, cut.normal);
  cut.height = dot(space.normal, space.point - origin);
  return cut;
}

// What lies beyond the border is the rival's; the joint's normal leads from the inner tile to the outer one.
CutShape<double> border_cut(const JointBorder& border, bool is_inner_tile, Vec3 origin) {
  CutShape<double> cut = plane_cut({is_inner_tile ? border.normal : -border.normal, border.centre}, origin);
  put_plane({border.x, border.centre}, origin, cut.x);
  put_plane({border.y, border.centre}, origin, cut.y);
  cut.bow = is_inner_tile ? -border.side : border.side;
  cut.slope = max(norm(border.x), norm(border.y));
  cut.steep = std::sqrt(1 + cut.slope * cut.slope);
  return cut;
}

}  // namespace

Vec3 set_shape(const Primitive& primitive, const SweptPolygon& palm, FieldShape<double>& shape) {
  const RoundHull hull = round_hull(primitive);
  shape.flat = primitive.shape == Shape::slab;
  put_vector(hull.axis, shape.axis);
  shape.length = hull.length;
  shape.radius1 = hull.radius1;
  shape.radius2 = hull.radius2;
  shape.sine = hull.sine;
  shape.cosine = hull.cosine;
  shape.jointed = hull.length > 0 ? 1 : 0;
  shape.size = shape.flat ? palm.radius : hull.radius1;
  if (shape.flat) put_plane(slab_of(palm, primitive).face[0], hull.origin, shape.face);
  return hull.origin;
}

void set_cuts(const Primitives& hand, const Primitive& primitive, Vec3 origin, TileCuts& cuts) {
  cuts.count = 0;
  const auto add = [&](const CutShape<double>& cut, double margin) {
    cuts.cut[cuts.count] = cut;
    cuts.margin[cuts.count++] = margin;
  };
  if (primitive.shape == Shape::slab) {
    const Slab slab = slab_of(hand.palm, primitive);
    for (int i = 1; i < slab.face_count; ++i)
      add(plane_cut(slab.face[static_cast<std::size_t>(i)], origin), 0);
    return;
  }
  for (std::size_t i = 0; i < primitive.cut_count; ++i) {
    const JointBorder* const border = border_at(hand, primitive, i);
    if (border != nullptr && border->near) {
      add(border_cut(*border, border == &hand.border[primitive.segment], origin), 0);
    } else {
      add(plane_cut(primitive.cut[i], origin), primitive.overhang[i]);
    }
  }
}

bool uses_clusters(const Model& model, const Primitives& hand, const Primitive& primitive) {
  if (model.clusters.triangle.empty() || primitive.law != Law::field) return false;
  if (primitive.shape == Shape::slab) return true;
  if (!suits_batch(primitive)) return false;
  const std::size_t place = primitive.segment % 3;
  return primitive.segment >= kPhalanxCount || place == 1 || !hand.folded[primitive.segment / 3];
}

FoundClusters find_clusters(const Model& model, const Primitives& hand, const Primitive& primitive,
                            const FieldKernels& kernels, SearchMemory& memory) {
  const ClusterTree& tree = model.clusters;
  constexpr std::uint32_t kWidth = ClusterBlock::kWidth;
  const ClusterQuery query = cluster_query(tree, hand, primitive, model.settings.tolerance);
  auto& [now, next] = memory.open_clusters;
  ClusterHits hits;
  hits.split = memory.split_leaves.data();
  FoundClusters found;
  found.size_count = tree.level.size() - 1;
  std::size_t size = found.size_count - 1;  // of the largest clusters
  std::size_t count = 0;
  for (std::uint32_t i = tree.level[size]; i < tree.level[size + 1]; i += kWidth) now[count++] = i / kWidth;
  for (;; --size) {
    hits.use = memory.used_clusters.data() + tree.level[size];
    hits.open = next.data();
    hits.use_count = hits.open_count = 0;
    hits.leaves = size == 0;
    kernels.cluster_kinds(tree.block.data(), query, now.data(), count, hits);
    found.used[size] = {hits.use, hits.use_count};
    if (size == 0) break;
    // The children of cluster i of a size are block i of the next one.
    count = hits.open_count;
    const std::uint32_t first = tree.level[size], below = tree.level[size - 1] / kWidth;
    for (std::size_t i = 0; i < count; ++i) now[i] = next[i] - first + below;
  }
  found.split = {hits.split, hits.split_count};
  found.open = {hits.open, hits.open_count};
  return found;
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
