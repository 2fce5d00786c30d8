#include "lanes/leaf_contact.h"

#include <algorithm>
#include <cmath>

#include "lanes/cluster_search.h"
#include "lanes/lane_vectors.h"

namespace lumbrical {
namespace {

// Of the square of a leaf's radius: what corners in single precision take away from the areas of eight
// triangles.
constexpr double kCornerRounding = 4e-6;

// [1/m] the bend of a border at its apex: so much that nothing is left to be trusted.
constexpr double kSharp = 1e30;

void put_corners(const LeafCorners& corners, LeafTerms& terms) {
  const float* const from = &corners.at[0][0][0];
  double* const to = &terms.corner[0][0][0];
  for (std::size_t k = 0; k < 9 * LeafTerms::kCapacity; ++k) to[k] = from[k];
}

// Cuts that may run through the leaf.
void put_cuts(const LeafQuery& query, Vec3 centre, double radius, LeafTerms& terms) {
  terms.cut_count = 0;
  for (int i = 0; i < query.cuts.count && terms.cut_count < LeafTerms::kCutCapacity; ++i) {
    const CutShape<double>& cut = query.cuts.cut[i];
    const double height = dot(vector_of(cut.normal), centre) - cut.height;
    double bow = 0, bend = 0;
    if (cut.bow != 0) {
      const double x = height_over(cut.x, centre), y = height_over(cut.y, centre);
      bow = std::sqrt(x * x + y * y);
      const double least = bow - cut.slope * radius;
      bend = least > 0 ? cut.slope * cut.slope / least : kSharp;
    }
    if (height + cut.bow * bow <= -cut.steep * radius) continue;
    terms.cut[terms.cut_count] = &cut;
    terms.bend[terms.cut_count++] = bend;
  }
}

// Returns how far from the axis the leaf's centre is. [m]
double put_bend(Vec3 centre, LeafTerms& terms) {
  const FieldShape<double>& shape = terms.shape;
  const Vec3 axis = vector_of(shape.axis);
  const double z = dot(centre, axis), ahead = z - clamp(z, 0, shape.length);
  const Vec3 off = centre - z * axis;
  const double square = dot(off, off), rho = std::sqrt(square);
  const double first = shape.cosine * z - shape.sine * rho;
  const bool at_end1 = !(shape.jointed > 0) || first<0, at_end2 = first> shape.cosine * shape.length;
  const Vec3 from = at_end1 ? centre : at_end2 ? centre - shape.length * axis : off;
  const double length = norm(from), per = length > 0 ? 1 / length : 0;
  put_vector(per * from, terms.across);
  terms.side = at_end1 || at_end2 ? 0 : 1;
  terms.field_bend = shape.flat ? 0 : at_end1 || at_end2 ? per : shape.cosine * per;
  return std::sqrt(square + ahead * ahead);
}

double sum_of(const double (&row)[LeafTerms::kCapacity]) {
  return ((row[0] + row[1]) + (row[2] + row[3])) + ((row[4] + row[5]) + (row[6] + row[7]));
}

// The cluster's wrench as one force beside its centre; returns the couple that it can't carry.
double put_force(Vec3 force, Vec3 couple, Vec3 centre, double radius, Contact& contact) {
  contact.volume = norm(force);
  const double per = contact.volume > 1e-150 ? 1 / contact.volume : 0;
  contact.normal = per > 0 ? per * force : Vec3{0, 0, 1};
  Vec3 shift = per * cross(contact.normal, couple);
  const double square = dot(shift, shift);
  if (square > radius * radius) shift = (radius / std::sqrt(square)) * shift;
  contact.centre = centre + shift;
  return norm(couple - cross(shift, force));
}

}  // namespace

void set_leaf_query(const Primitives& hand, const Primitive& primitive, LeafQuery& query) {
  query.origin = set_shape(primitive, hand.palm, query.terms.shape);
  set_cuts(hand, primitive, query.origin, query.cuts);
}

void prefetch_leaf(const Model& model, std::uint32_t leaf) {
  const ClusterTree& tree = model.clusters;
  const ClusterBlock& block = tree.block[leaf / ClusterBlock::kWidth];
  __builtin_prefetch(&block.x);
  __builtin_prefetch(&block.bx);
  const char* const corners = reinterpret_cast<const char*>(&tree.corners[leaf]);
  for (std::size_t line = 0; line < sizeof(LeafCorners); line += 64) __builtin_prefetch(corners + line);
}

bool leaf_contact(const Model& model, const FieldKernels& kernels, LeafQuery& query, Contact& contact) {
  const std::uint32_t leaf = cluster_of(contact.triangle);
  const ClusterBlock& block = model.clusters.block[leaf / ClusterBlock::kWidth];
  const std::size_t lane = leaf % ClusterBlock::kWidth;
  const double radius = block.r[lane];
  LeafTerms& terms = query.terms;
  const FieldShape<double>& shape = terms.shape;
  const Vec3 centre =
      (model.clusters.origin - query.origin) + Vec3{block.x[lane], block.y[lane], block.z[lane]};
  put_vector(centre, terms.centre);
  put_cuts(query, centre, radius, terms);
  const double gap = put_bend(centre, terms) - radius;
  put_corners(model.clusters.corners[leaf], terms);
  kernels.leaf_forces(terms);

  const auto& result = terms.result;
  double most = result[LeafTerms::highest][0], sum[LeafTerms::row_count];
  for (const double value : result[LeafTerms::highest]) most = max(most, value);
  for (std::size_t row = 0; row < LeafTerms::row_count; ++row) sum[row] = sum_of(result[row]);
  const double surface = sum[LeafTerms::surface];
  // The field bends by at most one over the distance from the axis, so over a triangle it rises over the
  // corners' plane by half the square of the radius of a circle round it over that: at most a sixth of the
  // square of its longest edge, or half of that of the leaf's radius.
  // The mean of that, by the second derivative at the leaf's centre, is added: never more than the whole.
  const double bend = shape.flat ? 0 : 1 / gap;
  const double edge = block.edge[lane], off = bend * min(0.5 * radius * radius, edge * edge / 6);
  contact.area = most > -off ? max(sum[LeafTerms::area], 1e-6 * surface) : 0;
  if (!(contact.area > 0)) return true;
  const double height = max(0, most) + off;
  const double doubtful = sum[LeafTerms::doubtful] * height;
  const double rounding = kMomentRounding * shape.size * surface + kCornerRounding * height * radius * radius;
  const double error = off * surface + rounding + doubtful;
  if (doubtful > 0 && error > model.settings.tolerance * shape.size * surface) return false;
  const auto at = [&](std::size_t row) { return Vec3{sum[row], sum[row + 1], sum[row + 2]}; };
  const double left = put_force(at(LeafTerms::force), at(LeafTerms::couple), centre, radius, contact);
  contact.error = max(error, (2 * radius * error + left) / (4 * shape.size));
  contact.depth = max(0, most);
  contact.centre += query.origin;
  contact.centroid = query.origin + centre;
  if (sum[LeafTerms::area] > 1e-6 * surface)
    contact.centroid += (1 / sum[LeafTerms::area]) * at(LeafTerms::area_first);
  return true;
}

void sum_leaf(const Model& model, const LeafQuery& query, std::span<const Contact> parts, Contact& contact) {
  const ClusterTree& tree = model.clusters;
  const std::uint32_t leaf = cluster_of(contact.triangle);
  const ClusterBlock& block = tree.block[leaf / ClusterBlock::kWidth];
  const std::size_t lane = leaf % ClusterBlock::kWidth;
  const double radius = block.r[lane], size = query.terms.shape.size;
  const Vec3 centre = tree.origin + Vec3{block.x[lane], block.y[lane], block.z[lane]};
  Vec3 force, couple, area_first;
  double error = 0;
  contact.area = contact.depth = 0;
  for (const Contact& part : parts) {
    if (!(part.area > 0)) continue;
    const Vec3 push = part.volume * part.normal;
    force += push;
    couple += cross(part.centre - centre, push);
    area_first += part.area * (part.centroid - centre);
    contact.area += part.area;
    contact.depth = max(contact.depth, part.depth);
    error += part.error;
  }
  if (!(contact.area > 0)) return;
  const double left = put_force(force, couple, centre, radius, contact);
  // Each part's error has a lever of its own, up to two radii from the contact's.
  contact.error = error * (1 + radius / (2 * size)) + left / (4 * size);
  contact.centroid = centre + (1 / contact.area) * area_first;
}

}  // namespace lumbrical
