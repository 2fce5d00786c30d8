// Pairs of round primitives with triangles, gathered for the SIMD kernel (round_contacts.h).
#pragma once

#include <array>
#include <span>

#include "lanes/field_kernels.h"
#include "lanes/lane_vectors.h"
#include "lumbrical/contact.h"
#include "model/primitive.h"

namespace lumbrical {

/// A round primitive from its larger end. Where the smaller sphere lies inside the larger nothing else is
/// left: length 0.
struct RoundHull {
  Vec3 origin;                      ///< [m] W, centre of the larger end
  Vec3 axis;                        ///< unit, to the smaller end
  double length, radius1, radius2;  ///< [m]
  double sine, cosine;              ///< of the cone's half angle
  [[nodiscard]] bool is_sphere() const { return length == 0; }
  [[nodiscard]] bool is_cone() const { return sine != 0; }
};
RoundHull round_hull(const Primitive& primitive);

/// Writes the hull and the triangle a, b, c [m, W], seen from its origin, to lane k of a kernel's terms.
template <class Terms>
void put_pair(const RoundHull& hull, Vec3 a, Vec3 b, Vec3 c, std::size_t k, Terms& terms) {
  put_vector(hull.axis, k, terms.axis);
  terms.length[k] = hull.length;
  terms.radius1[k] = hull.radius1;
  terms.radius2[k] = hull.radius2;
  terms.sine[k] = hull.sine;
  terms.cosine[k] = hull.cosine;
  put_vector(a - hull.origin, k, terms.a);
  put_vector(b - hull.origin, k, terms.b);
  put_vector(c - hull.origin, k, terms.c);
}

/// Is the primitive one the kernel knows?
bool suits_batch(const Primitive& primitive);

/// Contacts of cones that lack their slivers, of any number of batches.
struct SliverQueue {
  SliverTerms terms;
  std::array<Vec3, RoundTerms<double>::kCapacity> origin;  ///< [m] W, of each pair's hull
  std::array<Contact*, RoundTerms<double>::kCapacity> contact;
};

/// Working memory of one thread, for flat pairs or for all others. `tolerance` is Settings::tolerance.
struct RoundBatch {
  static constexpr std::size_t kCapacity = RoundTerms<double>::kCapacity;
  RoundBatch(const FieldKernels& table, double tolerance, bool flat) : kernels(table) {
    pairs.tolerance = tolerance;
    pairs.flat = flat;
    uneven.terms.patient = true;
  }
  const FieldKernels& kernels;
  RoundTerms<double> pairs;
  RoundTerms<float> single;
  std::array<Vec3, kCapacity> origin;       ///< [m] W, of each pair's hull
  std::array<Contact*, kCapacity> contact;  ///< of each pair
  SliverQueue slivers, uneven;              ///< uneven: those that take many steps, kept apart from the rest
  std::size_t rest_count = 0;
  std::array<Contact*, 4 * kCapacity> rest;
};

/// Does the axis lie nearly along the plane of the triangle a, b, c [m, W]?
inline bool lies_flat(const RoundHull& hull, Vec3 a, Vec3 b, Vec3 c) {
  if (hull.is_sphere()) return false;
  const Vec3 normal = cross(b - a, c - a);
  const double along = dot(hull.axis, normal), least = hull.is_cone() ? kFlatCosineCone : kFlatCosine;
  return along * along < least * least * dot(normal, normal);
}

/// Is there room for another pair with this hull? All of a batch are spheres, or capsules, or cones.
inline bool has_room(const RoundBatch& batch, const RoundHull& hull) {
  const RoundTerms<double>& pairs = batch.pairs;
  return pairs.count == 0 || (pairs.count < RoundTerms<double>::kCapacity &&
                              pairs.sphere == hull.is_sphere() && pairs.cone == hull.is_cone());
}

/// Adds the pair with triangle a, b, c [m, W], whose contact is to be written when the batch is computed.
/// `cuts` are the primitive's, or others in their place, up to three; a normal of 0 cuts nothing.
void add_to_batch(const RoundHull& hull, Vec3 a, Vec3 b, Vec3 c, std::span<const HalfSpace> cuts,
                  Contact& contact, RoundBatch& batch);

/// Computes the contacts of all pairs, but for their indices, and empties the batch; the area is 0 where
/// there is none. Returns the pairs that are for `collide_section`, valid until the next call. Contacts of
/// cones may go on lacking their slivers, and are still pointed to, until `finish_slivers`; what else is
/// added to them before the next call here comes before their slivers.
std::span<Contact* const> finish_batch(RoundBatch& batch);

/// Adds the slivers to all contacts of former batches. Returns pairs for `collide_section` likewise.
std::span<Contact* const> finish_slivers(RoundBatch& batch);

}  // namespace lumbrical
