// The palm's field at any point, in double precision.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "model/primitive.h"
#include "section/section.h"

namespace lumbrical {

/// The palm's polygon in its own plane, of a palm that there is.
class PalmPolygon {
 public:
  explicit PalmPolygon(const SweptPolygon& palm)
      : from_(palm.corner[0]), z_(palm.normal), radius_(palm.radius) {
    y_ = palm.outward[0];
    x_ = cross(y_, z_);
    count_ = palm.corner_count;
    for (std::size_t k = 0; k < count_; ++k) {
      const Vec3 from = palm.corner[k] - from_, edge = palm.corner[(k + 1) % count_] - palm.corner[k];
      edge_[k] = {in_plane(from), in_plane(palm.outward[k]), norm(edge)};
    }
  }
  [[nodiscard]] double field(Vec3 p) const {
    const Point2 foot = in_plane(p - from_);
    const double height = dot(z_, p - from_);
    double outside = -1e300, square = 1e300;
    for (std::size_t k = 0; k < count_; ++k) {
      const auto& [corner, out, length] = edge_[k];
      const Point2 from = foot - corner;
      const double across = dot(out, from), along = cross(out, from),
                   beyond = along - clamp(along, 0, length);
      outside = max(outside, across);
      square = min(square, across * across + beyond * beyond);
    }
    return radius_ - std::sqrt(height * height + (outside > 0 ? square : 0));
  }

 private:
  struct Edge {
    Point2 corner, out;  // it runs a quarter turn to the left of `out`
    double length;
  };
  [[nodiscard]] Point2 in_plane(Vec3 p) const { return {dot(x_, p), dot(y_, p)}; }

  Vec3 from_, x_, y_, z_;
  double radius_;
  std::size_t count_;
  std::array<Edge, SweptPolygon::kMostCorners> edge_;
};

}  // namespace lumbrical
