// Meshes made by the engine itself: the demo's mug and the scenes that tests, benchmarks and tools share.
// All are the same bits on every machine. Arguments out of range give an empty mesh.
#pragma once

#include <cstdint>

#include "lumbrical/mesh.h"

namespace lumbrical {

/// A mug standing on z = 0, its axis along +z: a body of revolution with rounded rim and a closed bottom, and
/// a swept handle towards +x whose ends are sunk into the wall. Two closed parts, outward oriented.
struct MugShape {
  double radius = 0.037;         ///< [m] outer
  double height = 0.095;         ///< [m]
  double wall = 0.005;           ///< [m]
  double handle_radius = 0.006;  ///< [m] of the handle's round section
  double handle_reach = 0.033;   ///< [m] how far the handle's centre line stands off the wall
  std::uint32_t segments = 32;   ///< round the axis, 8..2048; other edges are as long as the outermost
};
/// The handle needs room: it must fit between bottom and rim, bend no tighter than its own radius, and its
/// ends must vanish in the wall.
Mesh make_mug(const MugShape& shape);

/// Square patch of the plane z = 0, normal +z, centred on the origin, side `extent` [m], cut into `cells`^2
/// squares of two triangles; `cells` in 1..16384. `irregularity` in 0..1 moves the inner vertices within the
/// plane (at 1 by up to 0.3 cells) and flips diagonals (at 1 half of them), from a fixed seed; no triangle
/// turns over.
Mesh make_plane(double extent, std::uint32_t cells, double irregularity = 0, std::uint64_t seed = 1);

/// Bumpy height field over the same square: scene A (fixed extent) and scene B (fixed cell size). Lengths in
/// [m]; with u = 2 pi x / wavelength and v = 2 pi y / wavelength, z = amplitude (0.85 sin(u) cos(v) + 0.15
/// cos(3u + 1) sin(3v + 0.5)).
Mesh make_height_field(double extent, std::uint32_t cells, double amplitude, double wavelength);

/// Axis-aligned closed box centred on the origin, sides `size` [m], each face cut into `cells`^2 squares,
/// `cells` in 1..8192.
Mesh make_box(Vec3 size, std::uint32_t cells);

/// Closed sphere centred on the origin: a box of `cells` per edge blown up to `radius` [m].
Mesh make_sphere(double radius, std::uint32_t cells);

}  // namespace lumbrical
