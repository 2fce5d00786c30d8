// The static query behind `lumbrical probe`: the narrowphase of a tick over every pair.
#include "lumbrical/probe.h"

#include <string>

#include "base/floating_point.h"
#include "borders/pair_contact.h"

namespace lumbrical {
namespace {

Status wrong(std::size_t index, const std::string& what) {
  return Status::error("primitive " + std::to_string(index) + ": " + what);
}

Status to_primitive(const ProbePrimitive& probe, std::size_t index, Law law, Primitive& primitive) {
  const bool sphere = probe.shape == ProbeShape::sphere;
  primitive.shape = probe.shape == ProbeShape::cylinder ? Shape::flat : Shape::round;
  primitive.law = law;
  primitive.end1 = probe.end1;
  primitive.end2 = sphere ? probe.end1 : probe.end2;
  primitive.radius1 = probe.radius1;
  primitive.radius2 = probe.shape == ProbeShape::capsule ? probe.radius2 : probe.radius1;
  if (!is_finite(primitive.end1) || !is_finite(primitive.end2))
    return wrong(index, "its coordinates must be finite");
  if (!(primitive.radius1 > 0 && primitive.radius1 < 1e6 && primitive.radius2 > 0 &&
        primitive.radius2 < 1e6)) {
    return wrong(index, "its radius must be more than 0 and less than 1e6 m");
  }
  if (primitive.shape == Shape::flat && !(norm(primitive.end2 - primitive.end1) > 0)) {
    return wrong(index, "a cylinder needs two different ends; for one point give a sphere");
  }
  return {};
}

}  // namespace

Status probe(const Mesh& mesh, std::span<const ProbePrimitive> primitives, Law law, double stiffness,
             std::vector<ProbeContact>& contacts) {
  if (!(stiffness > 0 && stiffness < 1e300))
    return Status::error("the stiffness must be a finite number above 0 [N/m^3]");
  const FloatingPointGuard guard;
  std::vector<Primitive> posed(primitives.size());
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    if (Status status = to_primitive(primitives[i], i, law, posed[i]); !status.ok()) return status;
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t corner : mesh.triangles[i]) {
      if (corner >= mesh.vertices.size() || !is_finite(mesh.vertices[corner])) {
        return Status::error("triangle " + std::to_string(i) +
                             " names a vertex that is missing or not finite");
      }
    }
  }
  contacts.clear();
  const ExactKernels& kernels = exact_kernels(widest_isa());
  for (std::size_t i = 0; i < posed.size(); ++i) {
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
      const auto& [a, b, c] = mesh.triangles[k];
      const Corners at{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
      Contact contact;
      if (!collide(posed[i], {Settings{}.point_area, nullptr, kernels}, at, contact)) {
        continue;
      }
      contacts.push_back({static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(i), contact.depth,
                          contact.area, contact.volume, contact.error, contact.centroid, contact.centre,
                          contact.normal, (stiffness * contact.volume) * contact.normal});
    }
  }
  return {};
}

}  // namespace lumbrical
