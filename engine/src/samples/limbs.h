// Where a hand is, as far as it has to be known to tell what may be near it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "index/sphere_tree.h"
#include "model/corners.h"
#include "model/primitive.h"

namespace lumbrical {

/// A hand's phalanges as thick segments, and its palm [m, W].
struct HandPlace {
  struct Phalanx {
    Vec3 end1, end2;
    double radius = 0;
  };
  std::size_t phalanx_count = 0;
  std::array<Phalanx, kPhalanxCount> phalanx;
  SweptPolygon palm;
};

HandPlace place_of(const Primitives& hand);

/// Is no part of it farther than so much [m] from where it was?
bool is_within(double reach, const HandPlace& was, const HandPlace& hand);

/// A hand that may be farther by `spare` [m]: thick segments and a palm, a bit each. In doubt all is near.
class Limbs {
 public:
  Limbs(const HandPlace& hand, double spare);

  /// Round all of them.
  [[nodiscard]] const Sphere& ball() const { return ball_; }
  [[nodiscard]] const Box& box() const { return box_; }
  [[nodiscard]] std::uint32_t all() const { return (2u << count_) - 1; }
  /// Those that are near a triangle's plane.
  [[nodiscard]] std::uint32_t near_plane(const Corners& at) const;
  /// Those of some that are near a sphere [m, W].
  [[nodiscard]] std::uint32_t near(const Sphere& sphere, std::uint32_t limbs) const;

 private:
  struct Segment {
    Vec3 end, axis;
    double inverse, reach;  // [1/m^2] 1 / |axis|^2, [m]
  };
  [[nodiscard]] bool meets_palm(Vec3 centre, double within) const;

  std::size_t count_;
  std::array<Segment, kPhalanxCount> segment_;
  SweptPolygon palm_;
  double palm_reach_ = 0;
  Box box_;
  Sphere ball_;
};

}  // namespace lumbrical
