#include "lumbrical/jacobian.h"

#include "base/floating_point.h"
#include "borders/border_cut.h"
#include "index/cluster_tree.h"
#include "model/corners.h"
#include "section/contact_jacobian.h"
#include "section/prism.h"
#include "stages/narrowphase.h"

namespace lumbrical {

namespace {

// What is left of the tile in one triangle is as `cut` says.
void add_triangle(const Primitives& hand, const Primitive& primitive, const BorderCut& cut,
                  const Contact& contact, Vec3 joint, const Corners& at, Matrix6& value) {
  if (primitive.shape == Shape::prism) {
    add_contact_jacobian(hand.palm, contact, joint, at.a, at.b, at.c, value);
    return;
  }
  const bool other = cut.kind == CutKind::other;
  const SlopeMoments bulge = other ? bulge_slope(hand, primitive, cut, at.a, at.b, at.c) : SlopeMoments{};
  add_contact_jacobian(other ? tile_cut_so(primitive, cut.cut) : primitive, contact, joint, at.a, at.b, at.c,
                       value, bulge);
}

BorderCut cut_of(const FieldKernels& kernels, const Primitives& hand, const Primitive& primitive,
                 const Corners& at) {
  if (primitive.shape == Shape::prism) return {};
  return cut_at_borders(kernels, hand, primitive, borders_in_reach(hand, primitive, at.a, at.b, at.c), at.a,
                        at.b, at.c);
}

// A cluster is a contact for the force; for its slope every triangle in it is looked at.
void add_cluster(const Model& model, const Primitives& hand, const Primitive& primitive,
                 std::uint32_t cluster, Vec3 joint, Matrix6& value) {
  const FieldKernels& kernels = field_kernels(model.execution.isa);
  const ContactQuery query{Law::field, model.settings.point_area, nullptr, kernels};
  Boundary boundary;
  for (const std::uint32_t triangle : triangles_of(model.clusters, cluster)) {
    const Corners at = corners_of(model.triangles, triangle);
    const BorderCut cut = cut_of(kernels, hand, primitive, at);
    if (cut.kind == CutKind::gone) continue;
    const Primitive part = cut.kind == CutKind::other ? tile_cut_so(primitive, cut.cut) : primitive;
    Contact contact;
    const bool meets =
        primitive.shape == Shape::prism
            ? collide_prism(hand.palm, primitive.law, model.settings.point_area, at.a, at.b, at.c, contact)
            : collide(part, query, at.a, at.b, at.c, boundary, contact);
    if (!meets) continue;
    if (cut.crosses) add_bulge(cut.bulge, contact);
    add_triangle(hand, primitive, cut, contact, joint, at, value);
  }
}

}  // namespace

void segment_jacobians(const Model& model, const Scratch& scratch,
                       std::array<SegmentJacobian, kSegmentCount>& jacobians, std::uint32_t segments) {
  const FloatingPointGuard guard;
  const auto asked = [segments](std::size_t segment) { return (segments >> segment & 1u) != 0; };
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    if (asked(i)) jacobians[i] = {{}, model.settings.law[i] == Law::field};
  }
  const Primitives& hand = *scratch.primitives;
  const FieldKernels& kernels = field_kernels(model.execution.isa);
  const Triangles& world = model.triangles;
  for (std::size_t i = 0; i < scratch.contact_count; ++i) {
    const Contact& contact = scratch.contacts[i];
    const Primitive& primitive = hand.primitive[contact.primitive];
    SegmentJacobian& jacobian = jacobians[primitive.segment];
    if (!asked(primitive.segment) || !jacobian.known) continue;
    const Vec3 joint = hand.base_joint[primitive.segment];
    if ((contact.triangle & kClusterBit) == 0) {
      const Corners at = corners_of(world, contact.triangle);
      add_triangle(hand, primitive, cut_of(kernels, hand, primitive, at), contact, joint, at, jacobian.value);
    } else {
      add_cluster(model, hand, primitive, cluster_of(contact.triangle), joint, jacobian.value);
    }
  }
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    if (!asked(i)) continue;
    for (auto& row : jacobians[i].value) {
      for (double& entry : row) entry *= model.settings.stiffness;
    }
  }
}

}  // namespace lumbrical
