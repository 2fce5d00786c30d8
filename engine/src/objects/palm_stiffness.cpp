#include "objects/palm_stiffness.h"

#include <cmath>
#include <numbers>

#include "stages/feel_model.h"

namespace lumbrical {
namespace {

// How much deeper: so many times what the palm would be in if it lay flat on something large, for it is in at
// least as deep as that. Then what touches flat is felt flat, and the rest is moved by a small part of its
// depth.
constexpr double kDepths = 2;
constexpr double kLeast = 1e-6;  // [m]
constexpr double kMost = 0.1;    // of the palm's radius

// [m^2] Of the palm's shadow, its rim included.
double area_of(const SweptPolygon& palm) {
  double area = std::numbers::pi * palm.radius * palm.radius;
  Vec3 last = palm.corner[0];
  for (std::size_t i = palm.corner_count; i-- > 0;) {
    const Vec3 corner = palm.corner[i];
    area += 0.5 * dot(palm.normal, cross(corner - palm.corner[0], last - palm.corner[0])) +
            palm.radius * norm(corner - last);
    last = corner;
  }
  return area;
}

// dt^2 K of a whole palm, as a share of a mass, from which on a step has to know: an explicit one is stable
// up to 4, and knowing costs as much as feeling the object does.
constexpr double kLightShare = 0.5;

double hardness_of(const Pad& pad) {
  double hardness = 1;
  for (const PadLayer& layer : pad.layer) hardness += max(0, layer.stiffness);
  return hardness;
}

// [N/m] Of all of the palm, flat on something large.
double stiffest(const Model& model, const SweptPolygon& palm) {
  return model.settings.stiffness * hardness_of(model.settings.pad) * area_of(palm);
}

}  // namespace

bool asks_for_palm_stiffness(const Model& model, const Mechanism& mechanism, const Primitives& hand,
                             double dt) {
  if (mechanism.mobility == Mobility::hinge || mechanism.mobility == Mobility::ball) return true;
  return dt * dt * stiffest(model, hand.palm) > kLightShare * mechanism.body.mass;
}

PalmStiffness palm_stiffness(const Model& model, Vec3 field, Vec3 force, Vec3 normal, Scratch& felt,
                             std::uint64_t& evaluations) {
  const SweptPolygon palm = felt.primitives->palm;
  if (palm.corner_count == 0) return {};
  const double whole = area_of(palm), flat = norm(field) / (model.settings.stiffness * whole);
  const double step = clamp(kDepths * flat, kLeast, kMost * palm.radius);
  std::uint32_t flags = 0;
  const Vec3 deeper = palm_force_moved(model, -step * normal, felt, evaluations, flags);
  // Where there is no room to feel deeper, too stiff is safe: a step stays stable, and no touch pulls.
  const double along =
      (flags & kCandidateOverflow) != 0 ? stiffest(model, palm) : max(0, dot(deeper - force, normal) / step);
  const double area = min(along / model.settings.stiffness, whole);
  return {along, along * area / 12, 0.5 * std::sqrt(area)};
}

}  // namespace lumbrical
