#include "objects/object_forces.h"

#include <cmath>

#include "base/fixed_list.h"
#include "objects/body_motion.h"
#include "objects/contact_patch.h"
#include "objects/friction.h"
#include "objects/move_on.h"
#include "objects/surface_feel.h"
#include "proxy/proxy_hand.h"
#include "samples/sampled_forces.h"
#include "stages/contact_force.h"
#include "stages/hand_pose.h"
#include "stages/joint_torques.h"
#include "tick/felt_forces.h"

namespace lumbrical {
namespace {

// [m], and the least cosine of half the angle: a given object that moves farther in a tick has not been
// moved, but lost.
constexpr double kFarthestStep = 0.1, kWidestTurn = 0.9;

/// What a segment feels of an object.
struct Touch {
  std::size_t segment = 0;
  Wrench wrench;  ///< W, about the segment's base joint
  Spring spring;  ///< as the object has it
};

/// Of all segments, in their order.
using Touches = FixedList<Touch, kSegmentCount>;

std::uint32_t take_frame(const ObjectFrame* frame, const Settings& settings, Vec3 centre, ObjectState& state,
                         bool& anew) {
  state.velocity = state.angular_velocity = {};
  if (frame == nullptr) return kObjectMissing;
  const Quat q = frame->pose.orientation;
  const double square = dot(q, q);
  if (!is_finite(frame->pose.position) || !(square > 0.25 && square < 4)) return kObjectImplausible;
  const Pose pose{frame->pose.position, normalized(q)};
  const bool jumped = norm(pose.position - state.pose.position) > kFarthestStep ||
                      std::fabs(dot(pose.orientation, state.pose.orientation)) < kWidestTurn;
  const bool first = !(state.told > 0);
  if (settings.pad.damping > 0 && !first && !jumped) {
    const Twist speed = speed_between(state.pose, pose, settings.rate);
    state.angular_velocity = speed.angular_velocity;
    state.velocity = speed.velocity + cross(speed.angular_velocity, rotate(pose.orientation, centre));
  }
  anew = anew || first;
  state.pose = pose;
  state.told = 1;
  return jumped && !first ? kObjectImplausible : 0u;
}

bool may_reach(const ApartObject& object, const Pose& X_WO, const Hand& hand, const Primitives& placed) {
  const Vec3 middle = transform(X_WO, object.middle), reach{object.radius, object.radius, object.radius};
  return may_meet(hand, placed, {middle - reach, middle + reach});
}

Wrench operator+(const Wrench& a, const Wrench& b) { return {a.force + b.force, a.torque + b.torque}; }
Wrench operator-(const Wrench& a) { return {-a.force, -a.torque}; }
Wrench rotated(Quat q, const Wrench& a) { return {rotate(q, a.force), rotate(q, a.torque)}; }

/// The same about a point that lies `arm` before it.
Wrench about(Vec3 arm, const Wrench& a) { return {a.force, a.torque + cross(arm, a.force)}; }

// A finger that an object leaves must not hold it back: it gives way no more than it pushes.
double stiffness_kept(const ContactPatch& patch, double leaving, double dt) {
  return leaving > 0 ? min(patch.stiffness, patch.force / (dt * leaving)) : patch.stiffness;
}

Spring spring_of(const ApartObject& object, const ContactPatch& patch, const Friction& friction, double dt,
                 const ObjectState& state) {
  const Pose& X_WO = state.pose;
  const Vec3 arm = rotate(X_WO.orientation, patch.centre - object.mechanism.body.centre);
  const Vec3 normal = rotate(X_WO.orientation, patch.normal), speed = velocity_at(state, arm);
  const double leaving = -dot(normal, speed);
  Spring spring{arm, normal, stiffness_kept(patch, leaving, dt)};
  if (!rubs(object.material)) return spring;
  // The skin goes with the object until that is more than friction holds.
  spring.across = object.material.shear_stiffness;
  spring.about = twist_stiffness(object.material);
  const Twist own{speed, state.angular_velocity};
  const Wrench drawn =
      rotated(conjugate(X_WO.orientation), -change_of({{}, normal, 0, spring.across, spring.about}, own, dt));
  const double share = share_that_sticks(friction, drawn.force, drawn.torque);
  spring.across *= share;
  spring.about *= share;
  return spring;
}

void let_go(GripState& grip) {
  if (grip.holds > 0) grip = {};
}

/// An object that is in the hand's reach, and what holds the hand's proxy back, if it has one.
struct Reached {
  const ApartObject& object;
  std::uint8_t number = 0;  ///< Gap::object
  const GapList* pushing = nullptr;
};

// How fast a segment moves relative to an object, both in W.
Twist relative_speed(const ObjectTick& tick, std::size_t segment, const ApartObject& object,
                     const ObjectState& state) {
  const Vec3 arm = tick.hand.base_joint[segment] - transform(state.pose, object.mechanism.body.centre);
  const auto& [velocity, angular_velocity] = tick.speeds[segment];
  return {velocity - velocity_at(state, arm), angular_velocity - state.angular_velocity};
}

// What pads make of the field's patch: layers are in `pressed` [O] already, damping is added. Returns the
// damper [N s/m] they then are along the patch's normal.
double press(const ObjectTick& tick, const ApartObject& object, std::size_t segment, const ObjectState& state,
             Wrench& pressed, ContactPatch& patch) {
  const Pad& pad = object.shape->settings.pad;
  if (object.shape->layers.empty() && !(pad.damping > 0)) return 0;
  patch.force = patch.force > 0 ? norm(pressed.force) : 0;
  if (!(pad.damping > 0)) return 0;
  const double share = damping_share(pad.damping, rotated(state.pose.orientation, pressed),
                                     relative_speed(tick, segment, object, state));
  const double damper = std::fabs(share) < 1 ? pad.damping * patch.force : 0;
  pressed = {(1 + share) * pressed.force, (1 + share) * pressed.torque};
  patch.force *= 1 + share;
  return damper;
}

// The solver takes a damper as a spring that is slack now: what it does at the speed the object already has
// is taken out of the wrench. `arm` [W] is that of the patch from the segment's base joint.
void add_damper(double damper, Vec3 arm, double dt, const ObjectState& state, Touch& touch) {
  Spring& spring = touch.spring;
  const double speed = dot(spring.normal, velocity_at(state, spring.arm));
  const Vec3 force = (-damper * speed) * spring.normal;
  touch.wrench = touch.wrench + Wrench{force, cross(arm, force)};
  spring.along += damper / dt;
}

void touch_object(const ObjectTick& tick, const Reached& reached, double dt, Scratch& felt,
                  ObjectState& state, Touches& touches, Findings& findings, std::uint32_t& flags) {
  const auto& [object, number, pushing] = reached;
  const Model& shape = *object.shape;
  const Primitives& hand = tick.hand;
  const Pad& pad = shape.settings.pad;
  Primitives& own = *felt.primitives;
  place_hand(shape.hand, shape.settings, hand.joints, inverse(state.pose), own);
  const HandForces field = feel(shape, felt, flags);
  HandForces forces = field;
  add_layers(shape, felt, flags, forces);
  findings += findings_of(shape, felt);
  SurfaceSums sums;
  if (object.felt) sums = sum_surface(*object.felt, felt, flags);
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const CorePush push = pushing != nullptr ? push_on(*pushing, number, hand, i) : CorePush{};
    const Wrench pushed = rotated(conjugate(state.pose.orientation), push.wrench);
    Wrench pressed = forces.segment[i] + pushed;
    ContactPatch patch = contact_patch(own, i, field.segment[i] + pushed, shape.settings.stiffness, pad);
    patch.stiffness += push.stiffness;
    const double damper = press(tick, object, i, state, pressed, patch);
    GripState& grip = state.grip[i];
    if (!(patch.force > 0)) {
      let_go(grip);
      // Faces that push opposite ways leave a torque.
      if (norm(pressed.torque) > 0) touches.push_back({i, rotated(state.pose.orientation, pressed), {}});
      continue;
    }
    Material material = object.material;
    if (object.felt) {
      const SurfacePart part{sums.turn[i], sums.rub[i], field.segment[i].force};
      material = material_at(*object.felt, part, patch, material);
      turn_force(*object.felt, part, own.base_joint[i], patch, pressed);
    }
    Friction friction;
    if (rubs(object.material)) friction = rub(material, patch, base_pose(own, i), dt, grip);
    const Vec3 arm = patch.centre - own.base_joint[i];
    const Wrench rubbed{friction.force, friction.torque + cross(arm, friction.force)};
    Touch touch{i, rotated(state.pose.orientation, pressed + rubbed),
                spring_of(object, patch, friction, dt, state)};
    if (moves_by_itself(object.mechanism))
      add_damper(damper, rotate(state.pose.orientation, arm), dt, state, touch);
    touches.push_back(touch);
  }
}

// What the hand does to the object, about its centre of mass.
Wrench wrench_on_object(const Touches& touches, const Primitives& hand, Vec3 centre) {
  Wrench sum;
  for (const Touch& touch : touches)
    sum = sum + -about(hand.base_joint[touch.segment] - centre, touch.wrench);
  return sum;
}

// As the object gives way, so do the forces.
void give_way(const Twist& speed, double dt, const Primitives& hand, Vec3 centre, Touches& touches) {
  for (Touch& touch : touches) {
    const Vec3 arm = centre + touch.spring.arm - hand.base_joint[touch.segment];
    touch.wrench = touch.wrench + about(arm, -change_of(touch.spring, speed, dt));
  }
}

void move_object(const Model& model, const ApartObject& object, const Primitives& hand, double dt,
                 const ObjectState& handle, Touches& touches, ObjectState& state) {
  const MassProperties& body = object.mechanism.body;
  const Vec3 centre = transform(state.pose, body.centre);
  Springs springs;
  for (const Touch& touch : touches) springs.push_back(touch.spring);
  Wrench wrench = wrench_on_object(touches, hand, centre);
  const Twist speed = move_on(model, object, wrench, handle, springs, state);
  give_way(speed, dt, hand, centre, touches);
}

}  // namespace

std::uint32_t move_given(const Model& model, std::span<const ObjectFrame> given, State& state, bool& anew) {
  std::uint32_t flags = 0;
  std::size_t told = 0;
  for (std::size_t i = 0; i < model.apart.size(); ++i) {
    if (model.apart[i].mechanism.mobility != Mobility::given) continue;
    flags |= take_frame(told < given.size() ? &given[told] : nullptr, model.settings,
                        model.apart[i].mechanism.body.centre, state.objects[i], anew);
    ++told;
  }
  return flags;
}

Findings feel_objects(const ObjectTick& tick, State& state, Scratch& scratch, HandForces& forces,
                      std::uint32_t& flags) {
  const Model& model = tick.model;
  const double dt = 1 / model.settings.rate;
  if (tick.trusted) place_axes(tick.hand);
  Findings findings;
  for (std::size_t i = 0; i < model.apart.size(); ++i) {
    const ApartObject& object = model.apart[i];
    ObjectState& own = state.objects[i];
    const Pose felt_at = own.pose;
    Touches touches;
    if (tick.trusted && may_reach(object, own.pose, model.hand, tick.hand)) {
      const Reached reached{object, static_cast<std::uint8_t>(i + 1),
                            scratch.proxy ? &scratch.proxy->pushing : nullptr};
      touch_object(tick, reached, dt, *scratch.apart, own, touches, findings, flags);
    } else {
      for (GripState& grip : own.grip) let_go(grip);
    }
    const double coordinate = own.coordinate;
    if (moves_by_itself(object.mechanism))
      move_object(model, object, tick.hand, dt, state.objects[object.latch], touches, own);
    for (const Touch& touch : touches) {
      Wrench& segment = forces.segment[touch.segment];
      segment = segment + touch.wrench;
    }
    scratch.object_output[i] = {felt_at, wrench_on_object(touches, tick.hand, felt_at.position), coordinate};
  }
  if (tick.trusted) sum_joint_torques(tick.hand, forces);
  return findings;
}

}  // namespace lumbrical
