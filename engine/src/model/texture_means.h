// Means of a texture over rectangles, of any size at one price: what a patch of skin feels of it.
//
// A texel is as grey all over, so the integral from a corner of the image is bilinear within each texel and
// known at their corners, where it is a sum of whole numbers and exact (Crow, Summed-area tables, 1984).
#pragma once

#include <cstdint>
#include <vector>

#include "lumbrical/math.h"
#include "lumbrical/surface.h"

namespace lumbrical {

struct TextureMeans {
  std::size_t width = 0, height = 0;  ///< texels; 0: none
  double texel = 0;                   ///< [m] side
  double black = 0, step = 0;         ///< value of black, and by how much one grey is more
  std::vector<std::uint64_t> sum;  ///< of grey below and left of each corner, (width + 1) a row, from below
};

TextureMeans texture_means(const Texture& texture);

/// Of the texture seen along the axis that the point is on (Texture): its mean over a rectangle about a point
/// (u, v) [m], half as wide as `half_u` and half as high as `half_v` [m], both above 0.
double mean_over(const TextureMeans& means, double u, double v, double half_u, double half_v);

/// Value at a point [m, O] of a surface with this normal, and its slope [1/m] along the surface, both as a
/// patch feels them whose pressure is a paraboloid of this radius [m]: the mean of both has the paraboloid's
/// moments. The three planes' textures are weighted by how much the surface faces each.
double value_under(const TextureMeans& means, Vec3 point, Vec3 normal, double radius);
Vec3 slope_under(const TextureMeans& means, Vec3 point, Vec3 normal, double radius);

}  // namespace lumbrical
