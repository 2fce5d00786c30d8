// Pairs of round primitives with triangles, gathered for the SIMD kernel (round_contacts.h).
#pragma once

#include <array>
#include <span>

#include "base/fixed_list.h"
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
  std::array<Vec3, RoundTerms::kCapacity> origin;  ///< [m] W, of each pair's hull
  std::array<Contact*, RoundTerms::kCapacity> contact;
};

/// The slivers of all batches of one thread.
struct SliverBatch {
  explicit SliverBatch(const FieldKernels& table) : kernels(table) { uneven.terms.patient = true; }
  const FieldKernels& kernels;
  SliverQueue even, uneven;  ///< uneven: those that take many steps, kept apart from the rest
  FixedList<Contact*, 4 * RoundTerms::kCapacity> rest;  ///< what the lanes are unsure of
};

/// Which formulas of the field a triangle may meet. Pairs that meet the same ones share registers: a register
/// takes the time of all formulas any of its pairs meets.
enum class RoundZone : std::uint8_t { first_end, side, second_end, several, flat };
inline constexpr std::size_t kRoundZones = 5;

/// Pairs on their way through the kernel.
struct RoundBatch {
  static constexpr std::size_t kCapacity = RoundTerms::kCapacity;
  RoundTerms pairs;
  std::array<Vec3, kCapacity> origin;       ///< [m] W, of each pair's hull
  std::array<Contact*, kCapacity> contact;  ///< of each pair
};

/// Does the axis lie nearly along the plane of the triangle a, b, c [m, W]?
inline bool lies_flat(const RoundHull& hull, Vec3 a, Vec3 b, Vec3 c) {
  if (hull.is_sphere()) return false;
  const Vec3 normal = cross(b - a, c - a);
  const double along = dot(hull.axis, normal), least = hull.is_cone() ? kFlatCosineCone : kFlatCosine;
  return along * along < least * least * dot(normal, normal);
}

/// The zone of the pair with the triangle a, b, c [m, W]. What it says only matters to time, but for `flat`:
/// of cones, whose zones have curved borders, it is a guess.
inline RoundZone zone_of(const RoundHull& hull, Vec3 a, Vec3 b, Vec3 c) {
  if (hull.is_sphere()) return RoundZone::first_end;
  if (lies_flat(hull, a, b, c)) return RoundZone::flat;
  const double qa = dot(hull.axis, a - hull.origin), qb = dot(hull.axis, b - hull.origin),
               qc = dot(hull.axis, c - hull.origin);
  const double low = min(qa, min(qb, qc)), high = max(qa, max(qb, qc));
  const double first = hull.sine * hull.radius1, second = hull.length + hull.sine * hull.radius2;
  if (high < first) return RoundZone::first_end;
  if (low > second) return RoundZone::second_end;
  return low > first && high < second ? RoundZone::side : RoundZone::several;
}

/// Is there room for another pair with this hull? All of a batch are spheres, or capsules, or cones.
inline bool has_room(const RoundBatch& batch, const RoundHull& hull) {
  const RoundTerms& pairs = batch.pairs;
  return pairs.count == 0 || (pairs.count < RoundTerms::kCapacity && pairs.sphere == hull.is_sphere() &&
                              pairs.cone == hull.is_cone());
}

/// Adds the pair with triangle a, b, c [m, W], whose contact is to be written when the batch is computed.
/// `cuts` are the primitive's, or others in their place, up to three; a normal of 0 cuts nothing.
void add_to_batch(const RoundHull& hull, Vec3 a, Vec3 b, Vec3 c, std::span<const HalfSpace> cuts,
                  Contact& contact, RoundBatch& batch);

/// Computes the contacts of all pairs, but for their indices, and empties the batch; the area is 0 where
/// there is none. Returns the pairs that are for `collide_section`, valid until the next call. Contacts of
/// cones may go on lacking their slivers, which are queued, until these are finished.
/// What else is added to these before the next call here comes before their slivers.
std::span<Contact* const> finish_batch(RoundBatch& batch, SliverBatch& slivers);

/// Adds all slivers to their contacts. Returns pairs for `collide_section` likewise.
std::span<Contact* const> finish_slivers(SliverBatch& slivers);

}  // namespace lumbrical
