#include "lumbrical/jacobian.h"

#include <cassert>

#include "base/floating_point.h"
#include "base/set_bits.h"
#include "base/small_turn.h"
#include "base/vector6.h"
#include "base/wrench.h"
#include "borders/border_cut.h"
#include "borders/contact_differences.h"
#include "model/corners.h"
#include "proxy/proxy_hand.h"
#include "samples/sampled_forces.h"
#include "section/contact_jacobian.h"
#include "stages/feel_model.h"

namespace lumbrical {

namespace {

// In closed form, along borders that cross the triangle once and plainly. False where that doesn't do.
bool add_plain_triangle(const ExactKernels& kernels, const Primitives& hand, const Contact& contact,
                        Vec3 joint, const Corners& at, Matrix6& value) {
  const Primitive& primitive = hand.primitive[contact.primitive];
  if (primitive.shape == Shape::slab)
    return add_contact_jacobian(slab_of(hand.palm, primitive), contact, joint, at, value);
  const TileBorders near = borders_in_reach(hand, primitive, at);
  const BorderCut cut = cut_at_borders(kernels, hand, primitive, near, at);
  if (cut.kind == CutKind::planes) return add_contact_jacobian(primitive, contact, joint, at, value);
  SlopeMoments bulge;
  return cut.kind == CutKind::other && bulge_slope(hand, primitive, cut, at, bulge) &&
         add_contact_jacobian(tile_cut_so(primitive, cut.cut), contact, joint, at, value, bulge);
}

// Of the contacts of some segments.
void add_exact(const Model& model, const Scratch& scratch, std::uint32_t segments,
               std::array<SegmentJacobian, kSegmentCount>& jacobians) {
  const Primitives& hand = *scratch.primitives;
  const ExactKernels& kernels = exact_kernels(model.execution.isa);
  for (std::size_t i = 0; i < scratch.contact_count; ++i) {
    const Contact& contact = scratch.contacts[i];
    const Primitive& primitive = hand.primitive[contact.primitive];
    SegmentJacobian& jacobian = jacobians[primitive.segment];
    if (!has_bit(segments, primitive.segment) || !jacobian.known) continue;
    // What rounding has left beyond a cut, or of a triangle without area.
    const double radius = max(primitive.radius1, primitive.radius2);
    if (contact.area < 1e-12 * radius * radius) continue;
    const Vec3 joint = hand.base_joint[primitive.segment];
    const Corners at = corners_of(model.triangles, contact.triangle);
    jacobian.known = add_plain_triangle(kernels, hand, contact, joint, at, jacobian.value) ||
                     add_contact_differences(kernels, hand, contact, joint, at, jacobian.value);
  }
}

// ---- Segments that are felt by samples: differences of the very sum ----

// So far a body is moved to either side [m], [rad]: single precision then shows in the fourth digit, and so
// does the third derivative.
constexpr double kStep = 1e-5, kTurn = 2e-4;

// A hand whose phalanges `first` .. `last`, or whose palm, are moved by a small translation and turned about
// `pivot` by a small angle, joints included.
void move_segments(std::size_t first, std::size_t last, Vec3 pivot, Vec3 shift, Vec3 angle,
                   const Primitives& from, Primitives& to) {
  const Quat turn = normalized(small_rotation(angle));
  const auto moved = [&](Vec3 p) { return pivot + shift + rotate(turn, p - pivot); };
  for (std::size_t i = first; i <= last; ++i) {
    to.base_joint[i] = moved(from.base_joint[i]);
    if (i == kPalmSegment) {
      to.palm.normal = rotate(turn, from.palm.normal);
      for (std::size_t k = 0; k < from.palm.corner_count; ++k) {
        to.palm.corner[k] = moved(from.palm.corner[k]);
        to.palm.outward[k] = rotate(turn, from.palm.outward[k]);
      }
      continue;
    }
    to.capsule[i].end1 = moved(from.capsule[i].end1);
    to.capsule[i].end2 = moved(from.capsule[i].end2);
    to.direction[i] = rotate(turn, from.direction[i]);
  }
}

// Where joints that are not tracked are no one knows, and far from the finger turns would be long ways.
std::size_t first_placed(const Primitives& hand, std::size_t first, std::size_t last) {
  while (first < last && !hand.present[first]) ++first;
  return first;
}

// The segments of one body, which move together: a finger's that are asked for, or the palm.
void add_sampled_body(const Model& model, const Primitives& hand, std::size_t first, std::size_t last,
                      std::uint32_t segments, SampleMemory& memory,
                      std::array<SegmentJacobian, kSegmentCount>& jacobians) {
  const Vec3 pivot = hand.base_joint[first_placed(hand, first, last)];
  std::array<Matrix6, kSegmentCount> about_pivot{};
  for (std::size_t column = 0; column < 6; ++column) {
    const bool shifts = column < 3;
    const double step = shifts ? kStep : kTurn;
    SampledForces ahead, behind;
    for (const double side : {1.0, -1.0}) {
      Primitives moved = hand;
      const Vec3 by = along_axis(column % 3, side * step);
      move_segments(first, last, pivot, shifts ? by : Vec3{}, shifts ? Vec3{} : by, hand, moved);
      if (!sample_forces(model, moved, segments, memory, side > 0 ? ahead : behind,
                         fineness_of(memory.forces))) {
        for (std::size_t i = first; i <= last; ++i) jacobians[i].known = false;
        return;
      }
    }
    for (std::size_t i = first; i <= last; ++i) {
      const Vector6 change = vector_of((0.5 / step) * (ahead.segment[i] - behind.segment[i]));
      for (std::size_t row = 0; row < 6; ++row) about_pivot[i][row][column] += change[row];
    }
  }
  for (std::size_t i = first; i <= last; ++i) {
    if (!has_bit(segments, i)) continue;
    // A turn about the segment's own joint is one about the pivot and a shift of it.
    const Vec3 arm = pivot - hand.base_joint[i];
    for (std::size_t row = 0; row < 6; ++row) {
      const auto& from = about_pivot[i][row];
      auto& to = jacobians[i].value[row];
      for (std::size_t column = 0; column < 6; ++column) to[column] += from[column];
      to[3] += from[2] * arm.y - from[1] * arm.z;
      to[4] += from[0] * arm.z - from[2] * arm.x;
      to[5] += from[1] * arm.x - from[0] * arm.y;
    }
  }
}

void add_sampled(const Model& model, const Primitives& hand, std::uint32_t segments, SampleMemory& memory,
                 std::array<SegmentJacobian, kSegmentCount>& jacobians) {
  segments &= sampled_segments(model);
  if (!hand.in_reach) return;
  for (std::size_t finger = 0; finger < kFingerCount; ++finger) {
    const std::uint32_t own = 7u << 3 * finger;
    if ((segments & own) != 0) {
      // Neighbours share out space, so the whole finger is there even where only a part is asked for.
      add_sampled_body(model, hand, 3 * finger, 3 * finger + 2, own & sampled_segments(model), memory,
                       jacobians);
    }
  }
  if (has_bit(segments, kPalmSegment))
    add_sampled_body(model, hand, kPalmSegment, kPalmSegment, 1u << kPalmSegment, memory, jacobians);
}

void add(const SegmentJacobian& more, SegmentJacobian& jacobian) {
  jacobian.known = jacobian.known && more.known;
  add_matrix(more.value, jacobian.value);
}

// From the integral of phi to forces; what is not known is 0.
void scale(double stiffness, SegmentJacobian& jacobian) {
  if (!jacobian.known) jacobian.value = {};
  for (auto& row : jacobian.value) {
    for (double& entry : row) entry *= stiffness;
  }
}

// What a pad's layer feels besides.
void add_layer(const Model& layer, Scratch& scratch, std::uint32_t segments,
               std::array<SegmentJacobian, kSegmentCount>& jacobians) {
  std::array<SegmentJacobian, kSegmentCount> more;
  segment_jacobians(layer, scratch, more, segments);
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    if (!has_bit(segments, i)) continue;
    add(more[i], jacobians[i]);
    if (!jacobians[i].known) jacobians[i].value = {};
  }
}

// A core that is held pushes back along the normal; together no more stiffly than each by itself.
void add_pushes(const PushList& pushing, const Primitives& hand, std::uint32_t segments,
                std::array<SegmentJacobian, kSegmentCount>& jacobians) {
  for (const Gap& gap : pushing) {
    if (!has_bit(segments, gap.segment) || !jacobians[gap.segment].known) continue;
    const Vec3 turn = cross(gap.point - hand.base_joint[gap.segment], gap.normal);
    add_square(-gap.stiffness, vector_of(gap.normal, turn), jacobians[gap.segment].value);
  }
}

}  // namespace

void segment_jacobians(const Model& model, Scratch& scratch,
                       std::array<SegmentJacobian, kSegmentCount>& jacobians, std::uint32_t segments) {
  assert(is_made_for(model, scratch) && "of its last tick");
  const FloatingPointGuard guard;
  const bool own = is_made_for(model, scratch);
  const std::uint32_t by_samples = sampled_segments(model);
  // How what the exact rung leaves to deeper bodies changes isn't known.
  const std::uint32_t unknown = scratch.no_jacobian & ~by_samples;
  const auto asked = [segments](std::size_t segment) { return has_bit(segments, segment); };
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    if (asked(i)) jacobians[i] = {{}, own && model.settings.law[i] == Law::field && !has_bit(unknown, i)};
  }
  if (!own) return;
  const Primitives& hand = *scratch.primitives;
  add_exact(model, scratch, segments & ~by_samples, jacobians);
  if ((segments & by_samples) != 0) {
    std::array<SegmentJacobian, kSegmentCount> sampled;
    sampled.fill({{}, true});
    add_sampled(model, hand, segments, *scratch.samples, sampled);
    for (std::size_t i = 0; i < kSegmentCount; ++i) {
      if (asked(i)) add(sampled[i], jacobians[i]);
    }
  }
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    if (asked(i)) scale(model.settings.stiffness, jacobians[i]);
  }
  for (std::size_t i = 0; i < model.layers.size(); ++i)
    add_layer(*model.layers[i], scratch.layers[i], segments, jacobians);
  if (scratch.proxy) add_pushes(scratch.proxy->pushing, hand, segments, jacobians);
}

}  // namespace lumbrical
