// How an object's surface feels beside its shape: round where facets stand for something round, bumpy, and
// not everywhere as rough.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lumbrical {

/// Most texels of an image; and of a file, most numbers.
inline constexpr std::size_t kMostTexels = std::size_t{1} << 22;

/// A grey image, rows from the top, 0 (black) .. 65535 (white).
struct GreyImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint16_t> grey;  ///< width times height
  friend bool operator==(const GreyImage&, const GreyImage&) = default;
};

/// An image repeated without end in each of the three planes of the object's axes, of which a surface takes
/// that which it faces, or a mean of them: meshes need no coordinates for it. The image's lower left corner
/// is at the origin; it goes right along x, or y where it is seen along x, and up along z, or y where it is
/// seen along z.
struct Texture {
  GreyImage image;              ///< without texels: there is none
  double period = 0.01;         ///< [m] width of the image, 1e-6 .. 10; texels are square
  double black = 0, white = 0;  ///< what its darkest and its brightest grey stand for
  friend bool operator==(const Texture&, const Texture&) = default;
};

/// Nothing of it: the surface is felt as its triangles are, and costs nothing.
struct Surface {
  /// [rad] 0 .. pi: triangles that meet at less than this are facets of something round, and the force on a
  /// segment has the direction that its normals would give (force shading). 0: none are.
  double crease_angle = 0;
  /// Of the object's friction, by triangle, 0 .. 10. None: 1 everywhere.
  std::vector<double> friction_factor;
  Texture grip;   ///< friction factor, too, 0 .. 10; both are multiplied
  Texture bumps;  ///< [m] height, -1 .. 1: its slope under the patch tilts the force, which stays as large
  friend bool operator==(const Surface&, const Surface&) = default;
};
inline bool is_plain(const Texture& texture) { return texture.image.grey.empty(); }
inline bool is_plain(const Surface& surface) {
  return surface.crease_angle == 0 && surface.friction_factor.empty() && is_plain(surface.grip) &&
         is_plain(surface.bumps);
}

}  // namespace lumbrical
