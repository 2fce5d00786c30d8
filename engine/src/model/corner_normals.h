// Normals at the corners of triangles, as if the mesh stood for something round where it is not creased.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "lumbrical/mesh.h"

namespace lumbrical {

/// Edges, three to a triangle, are counted in 32 bits.
inline constexpr std::size_t kMostSmoothed = (~0u - 1) / 3;

/// [unit] Of each triangle at its three corners: the mean of the triangles that hang together there across
/// edges of less than `crease_angle` [rad], weighted by their angles (Thuermer and Wuethrich 1998). So
/// normals interpolated within triangles are continuous across all edges but creases; an edge that not
/// exactly two triangles share, and run through opposite ways, is a crease. A corner at which the mean is
/// more than 60 degrees off the triangle keeps the triangle's own, as do all of a mesh without creases and
/// curvature. Slivers, less than 1e-5 of their longest edge high, keep theirs, but count for the triangle
/// that lies across that edge: filled T-junctions are as smooth as a mesh without. 0 where a triangle has
/// none.
std::vector<std::array<Vec3, 3>> corner_normals(const Mesh& mesh, double crease_angle);

/// Unit, outward; 0 of a degenerate triangle.
Vec3 triangle_normal(const Mesh& mesh, const Triangle& triangle);

}  // namespace lumbrical
