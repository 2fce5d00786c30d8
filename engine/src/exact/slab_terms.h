// Pairs of one of the palm's slabs with many triangles under the field law: what the narrowphase hands to the
// SIMD kernels and what it gets back. Structure of arrays; a pair is a lane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>

#include "model/swept_polygon.h"

namespace lumbrical {

/// The faces, the skin first: dot(normal, p - origin) <= offset inside. W, unit; [m].
struct SlabFaces {
  std::uint32_t count = 0;
  double near = 0;  ///< [m] a triangle no farther from a face all but lies in it
  double normal[Slab::kMostFaces][3], offset[Slab::kMostFaces];
};

/// What the kernels say of a pair. Faces may cut the triangle, which is for `slab_rims` then. It is for
/// another way where it all but lies in a face (kAlongCut), or where rounding has made the polygon concave.
inline constexpr double kSlabMissed = 0, kSlabTouched = 1, kSlabCut = 2, kSlabUnclear = 3;

template <std::size_t N>
struct SlabResults {
  alignas(64) double status[N];
  alignas(64) double area[N];                       ///< [m^2]
  alignas(64) double volume[N];                     ///< [m^3] integral of the depth below the skin
  alignas(64) double depth[N];                      ///< [m] the largest such depth
  alignas(64) double normal[3][N];                  ///< W, unit
  alignas(64) double centroid[3][N], centre[3][N];  ///< [m] relative to the origin: of area, of depth
};

/// All pairs.
struct SlabTerms : SlabResults<64> {
  static constexpr std::size_t kCapacity = 64;
  std::size_t count = 0;
  SlabFaces faces;
  /// [m] W: the first corner relative to the origin, the others relative to the first, or small triangles
  /// would lose digits.
  alignas(64) double a[3][kCapacity], ab[3][kCapacity], ac[3][kCapacity];
  /// Result: bit k is set where face k has a corner on its outer side.
  alignas(64) double cut[kCapacity];

  template <class Use>
  void for_each_row(const Use& use) {
    for (auto* vector : {a, ab, ac}) {
      for (int k = 0; k < 3; ++k) use(vector[k]);
    }
  }
};

/// Those of them that are cut by so many faces.
struct RimTerms : SlabResults<64> {
  static constexpr std::size_t kCapacity = 64;
  /// More cuts have few triangles but those of a coarse mesh.
  static constexpr std::size_t kMostCuts = 6;
  std::size_t count = 0;
  const SlabFaces* faces = nullptr;
  alignas(64) double a[3][kCapacity], ab[3][kCapacity], ac[3][kCapacity];  ///< as above
  std::size_t cut_count = 0;
  alignas(64) double cut_normal[kMostCuts][3][kCapacity], cut_offset[kMostCuts][kCapacity];

  template <class Use>
  void for_each_row(const Use& use) {
    for (auto* vector : {a, ab, ac}) {
      for (int k = 0; k < 3; ++k) use(vector[k]);
    }
    for (std::size_t i = 0; i < cut_count; ++i) {
      for (double* row : cut_normal[i]) use(row);
      use(cut_offset[i]);
    }
  }
};

}  // namespace lumbrical
