// Pairs of one round primitive with many triangles under the field law: what the narrowphase hands to the
// SIMD kernel and what it gets back. Structure of arrays; a pair is a lane.
#pragma once

#include <cstddef>

namespace lumbrical {

/// What became of a pair: no common area; computed; computed but for a cone's slivers (cone_slivers.h); or
/// the closed form would lose digits and the pair is for `collide_section`.
inline constexpr double kApart = 0, kContact = 1, kSlivers = 2, kUnsure = 3;

template <class T>
struct RoundTerms {
  static constexpr std::size_t kCapacity = 64;
  std::size_t count = 0;

  // The primitive. The first end is the larger one; a sphere has length 0.
  T axis[3] = {0, 0, 1};       ///< W, unit, from the first end to the second
  T length = 0;                ///< [m] between the ends
  T radius1 = 0, radius2 = 0;  ///< [m] radius1 >= radius2
  T sine = 0, cosine = 1;      ///< of the cone's half angle
  int cut_count = 0;           ///< half-spaces that bound it besides
  T tolerance = 0;             ///< Settings::tolerance

  alignas(64) T a[3][kCapacity], b[3][kCapacity],
      c[3][kCapacity];  ///< [m] W, corners relative to the first end
  // The half-spaces: kept is dot(normal, p - end1) <= offset. W, unit, or 0 where nothing is cut; [m].
  alignas(64) T cut_normal[2][3][kCapacity], cut_offset[2][kCapacity];

  // Results; only of contacts but for the status. Points are relative to the first end.
  alignas(64) T status[kCapacity];
  alignas(64) T area[kCapacity];                               ///< [m^2]
  alignas(64) T volume[kCapacity];                             ///< [m^3] integral of phi
  alignas(64) T depth[kCapacity];                              ///< [m] dl_max
  alignas(64) T error[kCapacity];                              ///< [m^3] how far the volume may be off
  alignas(64) T normal[3][kCapacity];                          ///< W, unit
  alignas(64) T centroid[3][kCapacity], centre[3][kCapacity];  ///< [m] of the area, of phi
};

}  // namespace lumbrical
