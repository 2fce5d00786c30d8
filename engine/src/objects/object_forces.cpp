#include "objects/object_forces.h"

#include <cmath>

#include "base/wrench.h"
#include "objects/body_motion.h"
#include "objects/contact_patch.h"
#include "objects/move_on.h"
#include "objects/palm_stiffness.h"
#include "objects/surface_feel.h"
#include "objects/told_pose.h"
#include "objects/touches.h"
#include "proxy/proxy_hand.h"
#include "samples/sampled_forces.h"
#include "stages/contact_force.h"
#include "stages/feel_model.h"
#include "stages/hand_pose.h"
#include "stages/joint_torques.h"
#include "stages/pad_damping.h"

namespace lumbrical {
namespace {

// Of a force that damping would end: what friction remembers does not end with it.
constexpr double kLeastKept = 1e-9;

// Of an object whose centre [O] went to `pose`; W. `mean` is what was known of it a tick before.
Twist told_speed(const Twist& mean, const Pose& from, const Pose& pose, Vec3 centre, double rate) {
  Twist now = speed_between(from, pose, rate);
  now.velocity = now.velocity + cross(now.angular_velocity, rotate(pose.orientation, centre));
  return steadied(mean, now, rate);
}

std::uint32_t take_frame(const ObjectFrame* frame, const Settings& settings, Vec3 centre, ObjectState& state,
                         bool& anew) {
  const Twist mean{state.velocity, state.angular_velocity};
  const auto set_speed = [&state](const Twist& speed) {
    state.velocity = speed.velocity;
    state.angular_velocity = speed.angular_velocity;
  };
  set_speed({});
  if (frame == nullptr) {  // as one that is told the same again: some are told in every other tick only
    set_speed(steadied(mean, {}, settings.rate));
    return kObjectMissing;
  }
  if (!is_pose(frame->pose)) return kObjectImplausible;
  const Pose pose{frame->pose.position, normalized(frame->pose.orientation)};
  const bool jumped = is_jump(state.pose, pose);
  const bool first = !(state.told > 0);
  if (settings.pad.damping > 0 && !first && !jumped)
    set_speed(told_speed(mean, state.pose, pose, centre, settings.rate));
  anew = anew || first;
  state.pose = pose;
  state.told = 1;
  return jumped && !first ? kObjectImplausible : 0u;
}

bool may_reach(const ApartObject& object, const Pose& X_WO, const Hand& hand, const Primitives& placed) {
  const Vec3 middle = transform(X_WO, object.middle), reach{object.radius, object.radius, object.radius};
  return may_meet(hand, placed, {middle - reach, middle + reach});
}

Spring spring_of(const ApartObject& object, const ContactPatch& patch, const Twist& skin, Quat orientation) {
  Spring spring{rotate(orientation, patch.centre - object.mechanism.body.centre),
                rotate(orientation, patch.normal), patch.stiffness};
  spring.anchor = skin;
  if (!rubs(object.material)) return spring;
  spring.across = object.material.shear_stiffness;
  spring.about = twist_stiffness(object.material);
  return spring;
}

void let_go(GripState& grip) {
  if (grip.holds > 0) grip = {};
}

/// An object that is in the hand's reach, and what holds the hand's proxy back, if it has one.
struct Reached {
  const ApartObject& object;
  std::uint8_t number = 0;  ///< Gap::object
  const PushList* pushing = nullptr;
};

/// How an object is felt, and what of it.
struct Pressing {
  const ObjectTick& tick;
  const Reached& reached;
  double dt;
  Scratch& felt;
  ObjectState& state;        ///< of the object
  HandForces field, forces;  ///< O, of the object by itself, and with its pads' layers
  SurfaceSums sums;

  [[nodiscard]] const ApartObject& object() const { return reached.object; }
  [[nodiscard]] const Model& shape() const { return *reached.object.shape; }
  [[nodiscard]] const Primitives& hand() const { return *felt.primitives; }  ///< O
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
double press(const Pressing& pressing, std::size_t segment, Wrench& pressed, ContactPatch& patch) {
  const Model& shape = pressing.shape();
  const Pad& pad = shape.settings.pad;
  if (shape.layers.empty() && !(pad.damping > 0)) return 0;
  patch.force = patch.force > 0 ? norm(pressed.force) : 0;
  if (!(pad.damping > 0)) return 0;
  const auto [velocity, turn] = relative_speed(pressing.tick, segment, pressing.object(), pressing.state);
  const Quat to_object = conjugate(pressing.state.pose.orientation);
  const double wanted = damping_wanted(pad.damping, pressing.hand(), segment, pressed,
                                       {rotate(to_object, velocity), rotate(to_object, turn)});
  const double kept = max(kLeastKept, 1 + damping_share(wanted));
  // Beyond its bounds it grows no more: what counts is the way from there to an object that goes along.
  const double damper = pad.damping * patch.force / max(1, std::fabs(wanted));
  pressed = kept * pressed;
  patch.force *= kept;
  return damper;
}

// What a segment feels that is pressed so [O] at a patch.
Touch make_touch(const Pressing& pressing, std::size_t i, const Wrench& pressed, const ContactPatch& patch,
                 const Friction& friction) {
  const ObjectTick& tick = pressing.tick;
  const Quat orientation = pressing.state.pose.orientation;
  const Vec3 arm = patch.centre - pressing.hand().base_joint[i], arm_in_world = rotate(orientation, arm);
  Touch touch{i,
              tick.hand.base_joint[i],
              rotated(orientation, pressed + about(arm, {friction.force, friction.torque})),
              arm_in_world,
              spring_of(pressing.object(), patch, skin_speed(tick.speeds, i, arm_in_world), orientation),
              friction};
  touch.across = touch.spring.across;
  touch.about = touch.spring.about;
  return touch;
}

// Is the palm moved and felt again, to know how stiff its touch is?
bool asks_palm(const Pressing& pressing, std::size_t segment, const ContactPatch& patch) {
  const Mechanism& mechanism = pressing.object().mechanism;
  return segment == kPalmSegment && moves_by_itself(mechanism) && patch.force > 0 &&
         asks_for_palm_stiffness(pressing.shape(), mechanism, pressing.hand(), pressing.dt);
}

// The palm's is the last segment to be felt: this moves the hand in `felt`.
void ask_palm(const Pressing& pressing, Vec3 normal, Findings& findings, Touch& touch) {
  add_palm(palm_stiffness(pressing.shape(), pressing.field.segment[kPalmSegment].force,
                          pressing.forces.segment[kPalmSegment].force, normal, pressing.felt,
                          findings.evaluations),
           touch);
}

void press_segment(const Pressing& pressing, std::size_t i, Touches& touches, Findings& findings) {
  const auto& [object, number, pushing] = pressing.reached;
  const Model& shape = pressing.shape();
  const Primitives &hand = pressing.tick.hand, &own = pressing.hand();
  ObjectState& state = pressing.state;
  const CorePush push = pushing != nullptr ? push_on(*pushing, number, hand, i) : CorePush{};
  const Wrench pushed = rotated(conjugate(state.pose.orientation), push.wrench);
  Wrench pressed = pressing.forces.segment[i] + pushed;
  ContactPatch patch =
      contact_patch(own, i, pressing.field.segment[i] + pushed, shape.settings.stiffness, shape.settings.pad);
  const bool is_asked = asks_palm(pressing, i, patch);
  if (is_asked) patch.stiffness = 0;  // below
  const double guess = i == kPalmSegment ? patch.stiffness : 0;
  patch.stiffness += push.stiffness;
  const double damper = press(pressing, i, pressed, patch);
  GripState& grip = state.grip[i];
  if (!(patch.force > 0)) {
    let_go(grip);
    // Faces that push opposite ways leave a torque.
    if (norm(pressed.torque) > 0)
      touches.push_back({i, hand.base_joint[i], rotated(state.pose.orientation, pressed), {}, {}, {}});
    return;
  }
  Material material = object.material;
  if (object.felt) {
    const SurfacePart part{pressing.sums.turn[i], pressing.sums.rub[i], pressing.field.segment[i].force};
    material = material_at(*object.felt, part, patch, material);
    turn_force(*object.felt, part, own.base_joint[i], patch, pressed);
  }
  Friction friction;
  if (rubs(object.material)) friction = rub(material, patch, base_pose(own, i), pressing.dt, grip);
  Touch& touch = touches.push_back(make_touch(pressing, i, pressed, patch, friction));
  touch.damper = damper;
  touch.guess = guess;
  if (moves_by_itself(object.mechanism)) slacken_damper(pressing.dt, state, touch);
  if (is_asked) ask_palm(pressing, patch.normal, findings, touch);
}

// Fills in what of the object is felt, too.
void touch_object(Pressing& pressing, Touches& touches, Findings& findings, std::uint32_t& flags) {
  const Model& shape = pressing.shape();
  Scratch& felt = pressing.felt;
  place_hand(shape.hand, shape.settings, pressing.tick.hand.joints, inverse(pressing.state.pose),
             *felt.primitives);
  pressing.field = feel(shape, felt, findings.evaluations, flags);
  pressing.forces = pressing.field;
  add_layers(shape, felt, findings.evaluations, flags, pressing.forces);
  findings += findings_of(shape, felt);
  if (pressing.object().felt) pressing.sums = sum_surface(*pressing.object().felt, shape, felt, flags);
  for (std::size_t i = 0; i < kSegmentCount; ++i) press_segment(pressing, i, touches, findings);
}

void forget_touches(bool trusted, HandTouches& touches) {
  touches.trusted = trusted;
  for (Touches& of_object : touches.object) of_object.clear();
}

// For who moves it: dampers at the speed that the hand was told of are slack.
void keep_touches(const Touches& touches, double dt, const ObjectState& state, Touches& kept) {
  for (const Touch& touch : touches) slacken_damper(dt, state, kept.push_back(touch));
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

void feel_objects(const ObjectTick& tick, State& state, Scratch& scratch, HandForces& forces,
                  Findings& findings, std::uint32_t& flags) {
  const Model& model = tick.model;
  const double dt = 1 / model.settings.rate;
  if (tick.trusted) place_axes(tick.hand);
  if (scratch.touches) forget_touches(tick.trusted, *scratch.touches);
  for (std::size_t i = 0; i < model.apart.size(); ++i) {
    const ApartObject& object = model.apart[i];
    ObjectState& own = state.objects[i];
    const Pose felt_at = own.pose;
    Touches touches;
    if (tick.trusted && may_reach(object, own.pose, model.hand, tick.hand)) {
      const Reached reached{object, static_cast<std::uint8_t>(i + 1),
                            scratch.proxy ? &scratch.proxy->pushing : nullptr};
      Pressing pressing{tick, reached, dt, *scratch.apart, own, {}, {}, {}};
      touch_object(pressing, touches, findings, flags);
    } else {
      for (GripState& grip : own.grip) let_go(grip);
    }
    const double coordinate = own.coordinate;
    if (moves_by_itself(object.mechanism))
      move_on(model, object, state.objects[object.latch], dt, touches, own);
    else if (object.mechanism.mobility == Mobility::given)
      keep_touches(touches, dt, own, scratch.touches->object[i]);
    for (const Touch& touch : touches) forces.segment[touch.segment] += touch.wrench;
    scratch.object_output[i] = {felt_at, wrench_on_object(touches, felt_at.position), coordinate};
  }
  if (tick.trusted) sum_joint_torques(tick.hand, forces);
}

}  // namespace lumbrical
