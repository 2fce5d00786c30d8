// Pairs of round primitives with triangles, gathered for the SIMD kernel (round_contacts.h).
#pragma once

#include <array>
#include <span>

#include "lanes/field_kernels.h"
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

/// Is the primitive one the kernel knows?
bool suits_batch(const Primitive& primitive);

/// Working memory of one thread, for flat pairs or for all others. `tolerance` is Settings::tolerance.
struct RoundBatch {
  RoundBatch(const FieldKernels& table, double tolerance, bool flat) : kernels(table) {
    pairs.tolerance = tolerance;
    pairs.flat = flat;
  }
  const FieldKernels& kernels;
  RoundTerms<double> pairs;
  RoundTerms<float> single;
  std::array<Vec3, RoundTerms<double>::kCapacity> origin;                ///< [m] W, of each pair's hull
  std::array<Contact*, RoundTerms<double>::kCapacity> contact, slivers;  ///< of each pair
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
/// `cuts` are the primitive's, or others in their place, up to two; a normal of 0 cuts nothing.
void add_to_batch(const RoundHull& hull, Vec3 a, Vec3 b, Vec3 c, std::span<const HalfSpace> cuts,
                  Contact& contact, RoundBatch& batch);

/// Pairs the kernel leaves something of to do.
struct RoundRest {
  std::span<Contact*> slivers;       ///< for `add_slivers`
  std::span<Contact* const> unsure;  ///< for `collide_section`
};

/// Computes the contacts of all pairs, but for their indices, and empties the batch; the area is 0 where
/// there is none. The rest is valid until the next call.
RoundRest finish_batch(RoundBatch& batch);

}  // namespace lumbrical
