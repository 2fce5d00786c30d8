#include "objects/friction.h"

#include <cmath>

#include "base/small_turn.h"

namespace lumbrical {
namespace {

// [m/s] At this speed mu is half way from static to kinetic.
constexpr double kStribeckSpeed = 0.02;

// [s] Skin takes so long to notice that it slides, or has stopped: mu goes from one end to the other no
// faster.
constexpr double kSlideLag = 0.03;

// [m] How far from the normal the skin's stiffness sits that resists a twist: half a fingertip's radius.
constexpr double kTwistArm = 0.004;

Vec3 across(Vec3 v, Vec3 normal) { return v - dot(normal, v) * normal; }

// mu at a speed of sliding [m/s]: from the static to the kinetic one as it starts to slide.
double friction_at(const Material& material, double speed) {
  const double x = speed / kStribeckSpeed, more = material.static_friction - material.kinetic_friction;
  return material.kinetic_friction + more / (1 + x * x) + material.viscosity * speed;
}

// [m/s] That skin notices `dt` [s] after it has noticed `slip`, having slid at `speed` under `force` [N].
// Skin that is let go slides back and so lets itself go, all at once where it is drawn far: however fast it
// slides, mu falls by no more than its share of the lag. What viscosity adds holds it back, and would tremble
// from tick to tick if skin answered before its spring does.
double noticed(const Material& material, double slip, double speed, double force, double dt) {
  const double fastest = kStribeckSpeed + slip * slip / kStribeckSpeed;
  const double held_back = material.viscosity * force / (material.shear_stiffness * kSlideLag);
  return slip + min(1, dt / kSlideLag) * min(speed - slip, fastest) / (1 + held_back);
}

// Takes a vector drawn at right angles to another normal into the plane of this one, as long as it was.
Vec3 into_plane(Vec3 drawn, Vec3 normal) {
  const Vec3 flat = across(drawn, normal);
  const double before = dot(drawn, drawn), after = dot(flat, flat);
  return after > 0.25 * before && after > 0 ? std::sqrt(before / after) * flat : flat;
}

}  // namespace

double twist_stiffness(const Material& material) {
  return material.shear_stiffness * (kTwistArm * kTwistArm);
}

Friction rub(const Material& material, const ContactPatch& patch, const Pose& X_OS, double dt,
             GripState& grip) {
  if (!(patch.force > 0)) {
    grip = {};
    return {};
  }
  if (!(grip.holds > 0)) {
    grip = {};
    grip.holds = 1;
  } else {
    // Where the skin that is now in the patch's middle was.
    const Vec3 was = transform(grip.segment, transform(inverse(X_OS), patch.centre));
    grip.shear = into_plane(grip.shear, patch.normal) + across(patch.centre - was, patch.normal);
    grip.twist += dot(patch.normal, small_turn(grip.segment.orientation, X_OS.orientation));
  }
  grip.segment = X_OS;

  const double most = friction_at(material, grip.slip) * patch.force, about = twist_stiffness(material);
  const double most_shear = most / material.shear_stiffness,
               most_twist = max(most * patch.radius / about, 1e-12);
  const double shear = most_shear > 0 ? norm(grip.shear) / most_shear : 2, twist = grip.twist / most_twist;
  const double beyond = std::sqrt(shear * shear + twist * twist);
  const double kept = most_shear > 0 ? (beyond > 1 ? 1 / beyond : 1) : 0;
  const double turned = patch.radius * grip.twist, drawn = dot(grip.shear, grip.shear) + turned * turned;
  grip.slip = noticed(material, grip.slip, (1 - kept) * std::sqrt(drawn) / dt, patch.force, dt);
  grip.shear = kept * grip.shear;
  grip.twist = kept * grip.twist;
  return {-material.shear_stiffness * grip.shear, (-about * grip.twist) * patch.normal, most,
          about * most_twist};
}

double share_within(double now, double product, double more) {
  const double left = max(0, 1 - now), root = std::sqrt(product * product + more * left);
  const double share = product > 0 ? left / (product + root) : more > 0 ? (root - product) / more : 1;
  return min(1, share);
}

double share_that_sticks(const Friction& friction, Vec3 force, Vec3 torque) {
  if (!(friction.most > 0)) return 0;
  const double pull = 1 / friction.most, twist = 1 / friction.most_torque;
  const auto product = [&](Vec3 f, Vec3 g, Vec3 t, Vec3 u) {
    return pull * pull * dot(f, g) + twist * twist * dot(t, u);
  };
  return share_within(product(friction.force, friction.force, friction.torque, friction.torque),
                      product(friction.force, force, friction.torque, torque),
                      product(force, force, torque, torque));
}

// The step ends with a speed as one over 1 + share times a stiffness, so along one way the share found is a
// straight line over that taken, and two steps tell where both are the same. Without that, skin stiff for a
// light thing would let go in every step and be drawn from one end to the other.
Share next_share(const Share& sticks, double found) {
  const double taken = sticks.now;
  if (taken < 0) return {found};
  Share next{found, taken, found};
  if (sticks.taken < 0 || found == taken || taken == sticks.taken) return next;
  const double slope = (found - sticks.found) / (taken - sticks.taken);
  if (slope < 1)
    next.now = clamp((found - slope * taken) / (1 - slope), 0, 1);
  else if (found > taken)
    next.now = 1;
  return next;
}

}  // namespace lumbrical
