#include "lumbrical/jacobian.h"

#include "base/floating_point.h"
#include "borders/border_cut.h"
#include "section/contact_jacobian.h"

namespace lumbrical {

void segment_jacobians(const Model& model, const Scratch& scratch,
                       std::array<SegmentJacobian, kSegmentCount>& jacobians, std::uint32_t segments) {
  const FloatingPointGuard guard;
  const auto asked = [segments](std::size_t segment) { return (segments >> segment & 1u) != 0; };
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    if (asked(i)) jacobians[i] = {{}, model.settings.law[i] == Law::field};
  }
  const Primitives& hand = *scratch.primitives;
  const Triangles& world = model.triangles;
  for (std::size_t i = 0; i < scratch.contact_count; ++i) {
    const Contact& contact = scratch.contacts[i];
    const Primitive& primitive = hand.primitive[contact.primitive];
    SegmentJacobian& jacobian = jacobians[primitive.segment];
    if (!asked(primitive.segment) || !jacobian.known) continue;
    const Vec3 joint = hand.base_joint[primitive.segment];
    const Vec3 a = world.vertex(world.a[contact.triangle]), b = world.vertex(world.b[contact.triangle]),
               c = world.vertex(world.c[contact.triangle]);
    if (primitive.shape == Shape::prism) {
      add_contact_jacobian(hand.palm, contact, joint, a, b, c, jacobian.value);
    } else {
      const BorderCut cut = cut_at_borders(hand, primitive, a, b, c);
      const bool other = cut.kind == BorderCut::other;
      const SlopeMoments bulge = other ? bulge_slope(hand, primitive, cut, a, b, c) : SlopeMoments{};
      add_contact_jacobian(other ? tile_cut_so(primitive, cut) : primitive, contact, joint, a, b, c,
                           jacobian.value, bulge);
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
