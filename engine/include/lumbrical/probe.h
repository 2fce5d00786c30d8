// One static question: what would these primitives feel in this mesh? The mechanics of a tick without hand or
// time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/mesh.h"
#include "lumbrical/model.h"
#include "lumbrical/status.h"

namespace lumbrical {

enum class ProbeShape : std::uint8_t {
  sphere,    ///< centre `end1`, radius `radius1`
  cylinder,  ///< flat ends at `end1` and `end2`, radius `radius1`
  capsule,   ///< round ends; with two radii the convex hull of the two end spheres
};

struct ProbePrimitive {
  ProbeShape shape = ProbeShape::sphere;
  Vec3 end1, end2;                  ///< [m]
  double radius1 = 0, radius2 = 0;  ///< [m] > 0; radius2 for capsules
};

struct ProbeContact {
  std::uint32_t triangle = 0;   ///< index in the mesh
  std::uint32_t primitive = 0;  ///< index of the probe primitive
  double depth = 0;             ///< [m] dl_max, along -normal to the primitive's surface
  double area = 0;              ///< [m^2]
  double volume = 0;  ///< [m^3] the law's depth summed over the area: force = stiffness * volume * normal
  double error = 0;   ///< [m^3] bound of what the volume may be off, exact laws
  Vec3 centroid;      ///< [m] of the contacted area
  Vec3 centre;        ///< [m] centre of pressure
  Vec3 normal;        ///< unit, outward
  Vec3 force;         ///< [N] on the primitive
};

/// Contacts in the order of primitive, then triangle. Every primitive stands alone: none shares out space
/// with another. Refuses non-finite coordinates, radii not > 0, a stiffness not > 0, a cylinder without
/// length, and meshes whose triangles name vertices that are not there. Uses every triangle in turn (no
/// search structure).
Status probe(const Mesh& mesh, std::span<const ProbePrimitive> primitives, Law law, double stiffness,
             std::vector<ProbeContact>& contacts);

}  // namespace lumbrical
