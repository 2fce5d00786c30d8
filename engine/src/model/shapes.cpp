// Makes the flat and round meshes of shapes.h: plane, height field, box, sphere. The mug has its own file.
#include <cmath>
#include <numbers>

#include "base/elementary.h"
#include "base/floating_point.h"
#include "lumbrical/shapes.h"
#include "model/vertex_merge.h"

namespace lumbrical {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr std::uint32_t kMaxCells = 16384;  // keeps all indices far below 2^32

bool is_length(double value) { return value > 0 && value < 1e6; }

bool are_cells(std::uint32_t cells) { return cells >= 1 && cells <= kMaxCells; }

/// SplitMix64 (Steele, Lea, Flood 2014): the same numbers everywhere, which <random>'s distributions do not
/// promise.
struct Random {
  std::uint64_t state;
  std::uint64_t bits() {
    std::uint64_t z = state += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return z ^ z >> 31;
  }
  /// In [0, 1), a multiple of 2^-53.
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
};

/// Coordinate of grid line i of `cells` over [-extent/2, extent/2]; symmetric, and exact at both ends.
double grid_line(double extent, std::uint32_t i, std::uint32_t cells) {
  return extent * ((2.0 * i - cells) / (2.0 * cells));
}

/// Vertices row by row (y), each row along x, z = 0.
Mesh grid_vertices(double extent, std::uint32_t cells) {
  Mesh mesh;
  mesh.vertices.reserve((cells + std::size_t{1}) * (cells + std::size_t{1}));
  for (std::uint32_t j = 0; j <= cells; ++j) {
    for (std::uint32_t i = 0; i <= cells; ++i) {
      mesh.vertices.push_back({grid_line(extent, i, cells), grid_line(extent, j, cells), 0});
    }
  }
  return mesh;
}

/// Two triangles, counter-clockwise; the corners a, b, c, d go round the square. The cut is a-c or b-d.
void append_square(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d,
                   bool cut_bd) {
  if (cut_bd) {
    mesh.triangles.push_back({a, b, d});
    mesh.triangles.push_back({b, c, d});
  } else {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
}

/// Cuts the squares of a grid of (cells + 1)^2 vertices that begins at vertex `base`.
template <class CutsOther>
void append_grid_triangles(Mesh& mesh, std::uint32_t base, std::uint32_t cells, CutsOther cuts_other) {
  const std::uint32_t row = cells + 1;
  mesh.triangles.reserve(mesh.triangles.size() + std::size_t{2} * cells * cells);
  for (std::uint32_t j = 0; j < cells; ++j) {
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = base + j * row + i;
      append_square(mesh, a, a + 1, a + row + 1, a + row, cuts_other());
    }
  }
}

/// A point drawn evenly from the unit disc.
Vec3 random_in_disc(Random& random) {
  for (;;) {
    const double x = 2.0 * random.unit() - 1.0, y = 2.0 * random.unit() - 1.0;
    if (x * x + y * y <= 1.0) return {x, y, 0};
  }
}

/// sin(2 pi turns + phase), cos likewise; whole turns are taken off first, so that any size will do.
SinCos wave(double turns, double phase) { return sin_cos(kTwoPi * (turns - std::floor(turns)) + phase); }

}  // namespace

Mesh make_plane(double extent, std::uint32_t cells, double irregularity, std::uint64_t seed) {
  const FloatingPointGuard guard;
  if (!is_length(extent) || !are_cells(cells) || !(irregularity >= 0 && irregularity <= 1)) return {};
  Mesh mesh = grid_vertices(extent, cells);
  Random random{seed};
  // The lowest height of a half square is 0.707 cells. Three corners that each move by 0.3 cells or less
  // bring it down by 0.6 at most, so that no triangle turns over, whichever way the square is cut.
  const double reach = 0.3 * irregularity * (extent / cells);
  if (irregularity > 0) {
    for (std::uint32_t j = 1; j < cells; ++j) {
      for (std::uint32_t i = 1; i < cells; ++i) {
        mesh.vertices[std::size_t{j} * (cells + 1) + i] += reach * random_in_disc(random);
      }
    }
  }
  append_grid_triangles(mesh, 0, cells, [&] { return random.unit() < 0.5 * irregularity; });
  return mesh;
}

Mesh make_height_field(double extent, std::uint32_t cells, double amplitude, double wavelength) {
  const FloatingPointGuard guard;
  if (!is_length(extent) || !are_cells(cells) || !(std::fabs(amplitude) < 1e6) || !is_length(wavelength))
    return {};
  Mesh mesh = grid_vertices(extent, cells);
  for (Vec3& p : mesh.vertices) {
    const double u = p.x / wavelength, v = p.y / wavelength;
    const double coarse = wave(u, 0).sin * wave(v, 0).cos;
    const double fine = wave(3.0 * u, 1.0).cos * wave(3.0 * v, 0.5).sin;
    p.z = amplitude * (0.85 * coarse + 0.15 * fine);
  }
  append_grid_triangles(mesh, 0, cells, [] { return false; });
  return mesh;
}

Mesh make_box(Vec3 size, std::uint32_t cells) {
  const FloatingPointGuard guard;
  constexpr std::uint32_t kMaxBoxCells = 8192;  // six faces
  if (!is_length(size.x) || !is_length(size.y) || !is_length(size.z) || !are_cells(cells) ||
      cells > kMaxBoxCells) {
    return {};
  }
  // Each face is a grid over two axes u, v whose cross product is its outward normal; the faces' common edges
  // get the same coordinates from the same formula, so that merging closes the box.
  struct Face {
    std::size_t u, v, w;
    double side;
  };
  constexpr Face kFaces[] = {{0, 1, 2, +1}, {1, 0, 2, -1}, {1, 2, 0, +1},
                             {2, 1, 0, -1}, {2, 0, 1, +1}, {0, 2, 1, -1}};
  const double extent[3] = {size.x, size.y, size.z};
  Mesh mesh;
  for (const Face& face : kFaces) {
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t j = 0; j <= cells; ++j) {
      for (std::uint32_t i = 0; i <= cells; ++i) {
        double p[3];
        p[face.u] = grid_line(extent[face.u], i, cells);
        p[face.v] = grid_line(extent[face.v], j, cells);
        p[face.w] = face.side * 0.5 * extent[face.w];
        mesh.vertices.push_back({p[0], p[1], p[2]});
      }
    }
    append_grid_triangles(mesh, base, cells, [] { return false; });
  }
  merge_vertices(mesh);
  return mesh;
}

Mesh make_sphere(double radius, std::uint32_t cells) {
  const FloatingPointGuard guard;
  if (!is_length(radius)) return {};
  Mesh mesh = make_box({2, 2, 2}, cells);
  for (Vec3& p : mesh.vertices) p = p * (radius / norm(p));
  return mesh;
}

}  // namespace lumbrical
