// Which closed parts of a mesh lie inside others.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "lumbrical/mesh.h"

namespace lumbrical {

inline constexpr std::uint32_t kFewestEnclosing = 4;  ///< triangles that can enclose a volume

/// Triangles joined through their edges, wound one way.
struct MeshPart {
  std::uint32_t triangles = 0;  ///< copies of others not counted
  double area = 0;              ///< [m^2]
  double volume = 0;            ///< [m^3] signed, by the winding of the part's first triangle; holes filled
  double hole_area = 0;         ///< [m^2] of flat cones that would fill its holes
  double area_as_first = 0;     ///< [m^2] of triangles wound as the first one is
  bool twisted = false;         ///< can't be wound one way
  Vec3 origin;                  ///< [m] a vertex, from which volumes are measured
  Box box;
  std::array<Vec3, 6> extreme{};  ///< [m] vertices on the sides of the box: -x +x -y +y -z +z
  [[nodiscard]] bool closed() const;
};

inline constexpr std::uint32_t kNoPart = 0xffffffff;  ///< of triangles without edges, and copies of others

/// A part inside the solid or the void that another one encloses.
struct Nested {
  std::uint32_t inner = 0, outer = 0;
  friend auto operator<=>(const Nested&, const Nested&) = default;
};

/// All such pairs of closed parts, sorted: the outer one winds round all extreme vertices of the inner one.
/// `part_of` names each triangle's part, `reversed` tells those wound otherwise than their part's first
/// triangle; triangles of parts that are not closed count for nothing. False, and nothing found, where that
/// would take too long or too much memory: parts by the hundred thousand, all in line, or a thousand and
/// more, each inside the next.
bool find_nested(const Mesh& mesh, const std::vector<std::uint32_t>& part_of,
                 const std::vector<std::uint8_t>& reversed, const std::vector<MeshPart>& parts,
                 std::vector<Nested>& nested);

}  // namespace lumbrical
