// Pairs of one round primitive with triangles: what the narrowphase hands to the SIMD kernel that sorts them
// (pair_kinds.h) and what it gets back. Structure of arrays; a pair is a lane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>

namespace lumbrical {

/// Which formulas of the field a triangle may meet, and how its plane cuts the side. A register takes the
/// time of all that any of its pairs meets, so pairs that meet the same share registers. Only matters to
/// time, but for `flat`: where cuts leave less of a triangle it may meet less.
enum class RoundZone : std::uint8_t {
  first_end,
  whole_side,  ///< all of the triangle lies inside, beside the axis
  side,
  slanted_side,  ///< whose rim is long in its plane
  second_end,
  inner,  ///< first end and side, or all
  outer,  ///< side and second end
  flat    ///< the axis lies nearly along the plane
};
inline constexpr std::size_t kRoundZones = 8;

struct KindTerms {
  static constexpr std::size_t kCapacity = 64;
  std::size_t count = 0;

  // The primitive, as in RoundTerms; points are relative to its first end.
  double axis[3] = {0, 0, 1};
  double first = 0, second = 0;  ///< [m] along the axis: where the planes through the zones' borders meet it
  double flat = 0, slanted = 0;  ///< cosines of the axis' angle to the normal: less is flat, or slanted
  double radius1 = 0, sine = 0, cosine = 1;

  /// The planes of its borders towards the wrist and away from it: near is dot(normal, p) - height within
  /// +-slab.
  struct Border {
    double normal[3] = {0, 0, 0}, height = 0, slab = -1;
  } border[2];

  alignas(64) double a[3][kCapacity], b[3][kCapacity], c[3][kCapacity];  ///< [m] W, corners

  // Results.
  alignas(64) double zone[kCapacity];     ///< RoundZone
  alignas(64) double near[2][kCapacity];  ///< 1: the triangle comes near that border's plane

  template <class Use>
  void for_each_row(const Use& use) {
    for (auto* vector : {a, b, c}) {
      for (int k = 0; k < 3; ++k) use(vector[k]);
    }
  }
};

}  // namespace lumbrical
