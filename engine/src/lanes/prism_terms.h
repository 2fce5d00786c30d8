// Pairs of the palm with many triangles under the field law: what the narrowphase hands to the SIMD kernels
// and what it gets back. Structure of arrays; a pair is a lane.
#pragma once

#include <cstddef>
#include <cstdint>

#include "model/primitive.h"

namespace lumbrical {

/// The faces, the palmar one first: dot(normal, p - origin) <= offset inside. W, unit; [m].
struct PrismFaces {
  int count = 0;
  double normal[Prism::kMaxFaces][3], offset[Prism::kMaxFaces];
};

/// What the kernels say of a pair.
inline constexpr double kPalmMissed = 0, kPalmTouched = 1;
/// Numbers don't hold: a face cuts the triangle or several are the way out (of `prism_contacts`), rounding
/// has made the polygon concave (of `prism_rims`).
inline constexpr double kPalmOpen = 2;

template <std::size_t N>
struct PalmResults {
  alignas(64) double status[N];
  alignas(64) double area[N];                       ///< [m^2]
  alignas(64) double volume[N];                     ///< [m^3] integral of the depth below the palmar face
  alignas(64) double depth[N];                      ///< [m] dl_max
  alignas(64) double normal[3][N];                  ///< W, unit
  alignas(64) double centroid[3][N], centre[3][N];  ///< [m] relative to the origin: of area, of depth
};

/// All pairs.
struct PrismTerms : PalmResults<256> {
  static constexpr std::size_t kCapacity = 256;
  std::size_t count = 0;
  PrismFaces faces;
  /// [m] W: the first corner relative to the origin, the others relative to the first, or small triangles
  /// would lose digits.
  alignas(64) double a[3][kCapacity], ab[3][kCapacity], ac[3][kCapacity];
  /// Result: bit k is set where face k has a corner on its outer side.
  alignas(64) double cut[kCapacity];
};

/// Those of them that are open, each with the faces that cut it.
struct RimTerms : PalmResults<128> {
  static constexpr std::size_t kCapacity = 128;
  /// More cuts have few triangles but those of a coarse mesh.
  static constexpr std::size_t kMostCuts = 6;
  std::size_t count = 0;
  const PrismFaces* faces = nullptr;
  alignas(64) double a[3][kCapacity], ab[3][kCapacity], ac[3][kCapacity];  ///< as above
  /// Ascending. The faces that cut a pair, then as many zeros as others of the register have cuts more.
  std::uint32_t cut_count[kCapacity];
  alignas(64) double cut_normal[kMostCuts][3][kCapacity], cut_offset[kMostCuts][kCapacity];
};

}  // namespace lumbrical
