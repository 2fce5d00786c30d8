// Pairs of round primitives with triangles on their way into the SIMD kernels (round_contacts.h,
// cone_slivers.h) and out of them.
#pragma once

#include <array>
#include <span>

#include "exact/exact_kernels.h"
#include "exact/kind_terms.h"
#include "lumbrical/contact.h"
#include "model/corners.h"
#include "model/primitive.h"
#include "simd/lane_vectors.h"

namespace lumbrical {

/// A half-space seen from some point: dot(normal, p) <= offset is kept; a normal of 0 cuts nothing.
struct CutPlane {
  Vec3 normal;        ///< W
  double offset = 0;  ///< [m]
};
CutPlane seen_from(Vec3 origin, const HalfSpace& space);

/// A round primitive from its larger end. Where the smaller sphere lies inside the larger nothing else is
/// left: length 0.
struct RoundHull {
  Vec3 origin;                      ///< [m] W, centre of the larger end
  Vec3 axis;                        ///< unit, to the smaller end
  double length, radius1, radius2;  ///< [m]
  double sine, cosine;              ///< of the cone's half angle
  int cut_count;
  static_assert(RoundTerms::kMostCuts >= static_cast<int>(Primitive::kMostCuts));
  std::array<CutPlane, Primitive::kMostCuts> cut;  ///< seen from `origin`
  [[nodiscard]] bool is_sphere() const { return length == 0; }
  [[nodiscard]] bool is_cone() const { return sine != 0; }
};
RoundHull round_hull(const Primitive& primitive);

/// Is the primitive a part of a finger whose force the paper takes from the largest depth? (By `centroid`
/// it does from another, which is for the general path.)
inline bool follows_paper(const Primitive& primitive) {
  return (primitive.law == Law::max_depth || primitive.law == Law::point) && primitive.phalanx[0] >= 0;
}

/// Is the primitive one the kernels know?
bool suits_lanes(const Primitive& primitive);

/// What the pairs of a register have in common: spheres, capsules or cones, their zone, and whether they
/// follow the paper.
struct RoundKind {
  static constexpr std::size_t kCount = 2 * 3 * kRoundZones;
  bool sphere = false, cone = false;
  RoundZone zone = RoundZone::first_end;
  bool paper = false;
  [[nodiscard]] constexpr std::uint8_t number() const {
    const std::size_t shape = (sphere ? 0u : cone ? 2u : 1u) + (paper ? 3u : 0u);
    return static_cast<std::uint8_t>(shape * kRoundZones + static_cast<std::size_t>(zone));
  }
};
constexpr RoundKind round_kind(std::size_t number) {
  const std::size_t shape = number / kRoundZones;
  return {shape % 3 == 0, shape % 3 == 2, static_cast<RoundZone>(number % kRoundZones), shape >= 3};
}

/// The primitive whose pairs are to be sorted; its borders are left as they are.
void set_hull(const RoundHull& hull, KindTerms& terms);

/// The kind of a pair by itself, seen from the hull's origin.
RoundKind kind_of(const ExactKernels& kernels, const RoundHull& hull, const Corners& at);

/// The triangle seen from `origin` [m, W].
inline Corners seen_from(Vec3 origin, const Corners& at) {
  return {at.a - origin, at.b - origin, at.c - origin};
}

/// Writes a triangle, seen from the hull's origin, to lane k of a kernel's terms.
template <class Terms>
void put_corners(const Corners& at, std::size_t k, Terms& terms) {
  put_vector(at.a, k, terms.a);
  put_vector(at.b, k, terms.b);
  put_vector(at.c, k, terms.c);
}

/// The same with the hull.
template <class Terms>
void put_hull(const RoundHull& hull, const Corners& at, std::size_t k, Terms& terms) {
  put_vector(hull.axis, k, terms.axis);
  terms.length[k] = hull.length;
  terms.radius1[k] = hull.radius1;
  terms.radius2[k] = hull.radius2;
  terms.sine[k] = hull.sine;
  terms.cosine[k] = hull.cosine;
  put_corners(at, k, terms);
}

/// What all of the terms' pairs have in common; none has more cuts than that.
void set_kind(RoundKind kind, int cut_count, RoundTerms& terms);

/// Writes a pair, seen from the hull's origin, to lane k, cut by the hull's planes or others in their place.
inline void put_pair(const RoundHull& hull, const Corners& at, std::span<const CutPlane> cuts, std::size_t k,
                     RoundTerms& terms) {
  put_hull(hull, at, k, terms);
  for (std::size_t i = 0; i < static_cast<std::size_t>(terms.cut_count); ++i) {
    const CutPlane cut = i < cuts.size() ? cuts[i] : CutPlane{};
    put_vector(cut.normal, k, terms.cut_normal[i]);
    terms.cut_offset[i][k] = cut.offset;
  }
}

/// Sets all of the contact but its indices to what was found in lane k.
inline void read_contact(const RoundTerms& terms, std::size_t k, Vec3 origin, Contact& contact) {
  contact.area = terms.area[k];
  contact.volume = terms.volume[k];
  contact.depth = terms.depth[k];
  contact.error = terms.error[k];
  contact.normal = vector_at(terms.normal, k);
  contact.centroid = origin + vector_at(terms.centroid, k);
  contact.centre = origin + vector_at(terms.centre, k);
}

/// Adds the sliver found in lane k.
void add_sliver(const RoundTerms& terms, std::size_t k, Vec3 origin, Contact& contact);

}  // namespace lumbrical
