// Pairs of round primitives of one kind with triangles: what the narrowphase hands to the SIMD kernels and
// what it gets back. Structure of arrays; a pair is a lane.
//
// `round_contacts` sets all results, `paper_contacts` all but the volume, with the deepest point for a
// centre. `cone_slivers`, for those that `round_contacts` leaves without, sets the status, kContact or
// kUnclear; the volume, what the slivers add to it; and the centre, what they add to the volume's first
// moment [m^4].
#pragma once

#include <cstddef>
#include <initializer_list>

namespace lumbrical {

/// What became of a pair: no common area; computed; computed but for a cone's slivers (cone_slivers.h); or
/// the way taken would lose digits and the pair is for another.
inline constexpr double kNoContact = 0, kContact = 1, kSlivers = 2, kUnclear = 3;

/// Cosines of the axis' angle to the normal below which a pair is flat. The closed form of the side divides
/// rounding by that cosine, in the moments by its square, and a cone's terms are larger from the start.
inline constexpr double kFlatCosine = 1e-3, kFlatCosineCone = 4e-3;

struct RoundTerms {
  static constexpr std::size_t kCapacity = 64;
  std::size_t count = 0;

  // Of all pairs.
  bool sphere = false, cone = false;  ///< the primitives' kind; neither: capsules
  bool flat = false;                  ///< their axes lie nearly along the planes
  bool depths = false;                ///< dl_max is asked of `round_contacts`
  bool patient = false;               ///< slivers take as many steps as they need
  static constexpr int kMostCuts = 3;
  int cut_count = 0;  ///< half-spaces that bound them besides, at most

  // The primitive of each pair. The first end is the larger one; a sphere has length 0.
  alignas(64) double axis[3][kCapacity];                      ///< W, unit, from the first end to the second
  alignas(64) double length[kCapacity];                       ///< [m] between the ends
  alignas(64) double radius1[kCapacity], radius2[kCapacity];  ///< [m] radius1 >= radius2
  alignas(64) double sine[kCapacity], cosine[kCapacity];      ///< of the cone's half angle

  alignas(64) double a[3][kCapacity], b[3][kCapacity],
      c[3][kCapacity];  ///< [m] W, corners relative to the first end
  // The half-spaces: kept is dot(normal, p - end1) <= offset. W, unit, or 0 where nothing is cut; [m].
  alignas(64) double cut_normal[kMostCuts][3][kCapacity], cut_offset[kMostCuts][kCapacity];

  // Results; only of contacts but for the status. Points are relative to the first end.
  alignas(64) double status[kCapacity];
  alignas(64) double area[kCapacity];                               ///< [m^2]
  alignas(64) double volume[kCapacity];                             ///< [m^3] integral of phi
  alignas(64) double depth[kCapacity];                              ///< [m] dl_max, or 0
  alignas(64) double error[kCapacity];                              ///< [m^3] how far the volume may be off
  alignas(64) double normal[3][kCapacity];                          ///< W, unit
  alignas(64) double centroid[3][kCapacity], centre[3][kCapacity];  ///< [m] of the area, of phi

  template <class Use>
  void for_each_row(const Use& use) {
    for (double* row : {length, radius1, radius2, sine, cosine}) use(row);
    for (auto* vector : {axis, a, b, c}) {
      for (int k = 0; k < 3; ++k) use(vector[k]);
    }
    for (int i = 0; i < cut_count; ++i) {
      for (double* row : cut_normal[i]) use(row);
      use(cut_offset[i]);
    }
  }
};

}  // namespace lumbrical
