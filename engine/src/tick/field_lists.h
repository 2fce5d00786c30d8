// The numbers of what goes into a tick, comes out and is made on the way, under their names: a struct's new
// field takes one line here (see fields.h), and is then hashed, traced, named, compared and exported.
#pragma once

#include <cstddef>
#include <span>

#include "lumbrical/contact.h"
#include "lumbrical/device.h"
#include "lumbrical/math.h"
#include "lumbrical/tick.h"
#include "model/primitive.h"
#include "samples/sampled_forces.h"
#include "tick/fields.h"

namespace lumbrical {

// ---- Vectors and poses
// --------------------------------------------------------------------------------------------

constexpr void list_fields(Is<Vec3> auto& vector, auto&& field) {
  field("x", "", vector.x);
  field("y", "", vector.y);
  field("z", "", vector.z);
}
constexpr void list_fields(Is<Quat> auto& rotation, auto&& field) {
  field("w", "", rotation.w);
  field("x", "", rotation.x);
  field("y", "", rotation.y);
  field("z", "", rotation.z);
}
constexpr void list_fields(Is<Pose> auto& pose, auto&& field) {
  field("position", "m", pose.position);
  field("orientation", "", pose.orientation);
}
constexpr void list_fields(Is<Wrench> auto& wrench, auto&& field) {
  field("force", "N", wrench.force);
  field("torque", "N m", wrench.torque);
}

// ---- Into a tick and out of it, and what stays
// --------------------------------------------------------------------

constexpr void list_fields(Is<JointPose> auto& joint, auto&& field) {
  field("position", "m", joint.position);
  field("orientation", "", joint.orientation);
}
constexpr void list_fields(Is<DeviceFrame> auto& frame, auto&& field) {
  field("base", "", frame.base);
  field("kind", "", frame.kind);
  field("flags", "", frame.flags);
  field("valid", "", frame.valid);
  field("joint", "", frame.joint);
  field("angle", "rad", frame.angle);
}

constexpr void list_forces(auto& forces, auto&& field) {
  field("segment", "", forces.segment);
  field("joint_torque", "N m", forces.joint_torque);
  field("flexion_torque", "N m", forces.flexion_torque);
}
constexpr void list_fields(Is<HandForces> auto& forces, auto&& field) { list_forces(forces, field); }
constexpr void list_fields(Is<ActuatorFrame> auto& frame, auto&& field) {
  field("tick", "", frame.tick);
  field("flags", "", frame.flags);
  field("contact_count", "", frame.contact_count);
  field("evaluations", "", frame.evaluations);
  field("error_estimate", "N", frame.error_estimate);
  field("force_error", "N", frame.force_error);
  list_forces(frame, field);
}

constexpr void list_fields(Is<HandState> auto& state, auto&& field) {
  field("tick", "", state.tick);
  field("rise", "", state.rise);
  field("fall", "", state.fall);
  field("joints", "", state.joints);
  field("ends", "m", state.ends);
  field("last", "", state.last);
  field("held", "", state.held);
}

constexpr void list_fields(Is<ProxyState> auto& proxy, auto&& field) {
  field("joint", "", proxy.joint);
  field("valid", "", proxy.valid);
  field("balanced", "", proxy.balanced);
  field("tracked", "m", proxy.tracked);
  field("carried", "N", proxy.carried);
  field("late", "N", proxy.late);
}

constexpr void list_fields(Is<Twist> auto& twist, auto&& field) {
  field("velocity", "m/s", twist.velocity);
  field("angular_velocity", "rad/s", twist.angular_velocity);
}
constexpr void list_fields(Is<MotionState> auto& motion, auto&& field) {
  field("segment", "", motion.segment);
  field("speed", "", motion.speed);
  field("valid", "", motion.valid);
}

constexpr void list_fields(Is<GripState> auto& grip, auto&& field) {
  field("segment", "", grip.segment);
  field("shear", "m", grip.shear);
  field("twist", "rad", grip.twist);
  field("slip", "m/s", grip.slip);
  field("holds", "", grip.holds);
}
constexpr void list_fields(Is<SupportState> auto& support, auto&& field) {
  field("shear", "m", support.shear);
  field("holds", "", support.holds);
}
constexpr void list_fields(Is<ObjectState> auto& object, auto&& field) {
  field("pose", "", object.pose);
  field("velocity", "m/s", object.velocity);
  field("angular_velocity", "rad/s", object.angular_velocity);
  field("coordinate", "", object.coordinate);
  field("told", "", object.told);
  field("grip", "", object.grip);
  field("support", "", object.support);
}
constexpr void list_fields(Is<ObjectFrame> auto& object, auto&& field) { field("pose", "", object.pose); }
constexpr void list_fields(Is<ObjectOutput> auto& object, auto&& field) {
  field("pose", "", object.pose);
  field("wrench", "", object.wrench);
  field("coordinate", "", object.coordinate);
}

constexpr void list_fields(Is<PadLayer> auto& layer, auto&& field) {
  field("from", "", layer.from);
  field("stiffness", "", layer.stiffness);
}
constexpr void list_fields(Is<Pad> auto& pad, auto&& field) {
  field("layer", "", pad.layer);
  field("damping", "s/m", pad.damping);
}
constexpr void list_fields(Is<Settings> auto& settings, auto&& field) {
  field("law", "", settings.law);
  field("stiffness", "N/m^3", settings.stiffness);
  field("rate", "Hz", settings.rate);
  field("point_area", "m^2", settings.point_area);
  field("precision", "", settings.precision);
  field("max_force", "N", settings.max_force);
  field("fade_time", "s", settings.fade_time);
  field("proxy_stiffness", "N/m", settings.proxy_stiffness);
  field("felt_once", "", settings.felt_once);
  field("pad", "", settings.pad);
  field("effort", "", settings.effort);
  field("max_candidates", "", settings.max_candidates);
}

// ---- Made on the way
// ----------------------------------------------------------------------------------------------

/// The unit of what tells whose a struct's numbers are; traces name it beside them.
inline constexpr const char* kOwner = "owner";

constexpr void list_fields(Is<Contact> auto& contact, auto&& field) {
  field("primitive", kOwner, contact.primitive);
  field("triangle", kOwner, contact.triangle);
  field("depth", "m", contact.depth);
  field("area", "m^2", contact.area);
  field("volume", "m^3", contact.volume);
  field("error", "m^3", contact.error);
  field("centroid", "m", contact.centroid);
  field("centre", "m", contact.centre);
  field("normal", "", contact.normal);
}

constexpr void list_fields(Is<SampledForces> auto& sampled, auto&& field) {
  field("patch_count", "", sampled.patch_count);
  field("contact_count", "", sampled.contact_count);
  field("evaluations", "", sampled.evaluations);
  field("level", "", sampled.fineness.level);
  field("error_factor", "", sampled.error_factor);
  field("integral", "", sampled.segment);
}

constexpr void list_fields(Is<HalfSpace> auto& half_space, auto&& field) {
  field("normal", "", half_space.normal);
  field("point", "m", half_space.point);
  field("offset", "m", half_space.offset);
}
constexpr void list_fields(Is<Primitive> auto& primitive, auto&& field) {
  field("shape", "", primitive.shape);
  field("segment", "", primitive.segment);
  field("phalanx", "", primitive.phalanx);
  field("law", "", primitive.law);
  field("end1", "m", primitive.end1);
  field("end2", "m", primitive.end2);
  field("radius1", "m", primitive.radius1);
  field("radius2", "m", primitive.radius2);
  field("cut_count", "", primitive.cut_count);
  field("cut", "", std::span(primitive.cut).first(primitive.cut_count));
  field("overhang", "m", primitive.overhang);
}
constexpr void list_fields(Is<SweptPolygon> auto& palm, auto&& field) {
  field("corner_count", "", palm.corner_count);
  if (palm.corner_count == 0) return;
  const std::size_t count = palm.corner_count;
  field("corner", "m", std::span(palm.corner).first(count));
  field("outward", "", std::span(palm.outward).first(count));
  field("normal", "", palm.normal);
  field("radius", "m", palm.radius);
}
constexpr void list_fields(Is<JointBorder> auto& border, auto&& field) {
  field("shared", "", border.shared);
  if (!border.shared) return;
  field("near", "", border.near);
  field("centre", "m", border.centre);
  field("normal", "", border.normal);
  field("reach", "m", border.reach);
  field("slab", "m", border.slab);
  field("x", "", border.x);
  field("y", "", border.y);
  field("side", "", border.side);
}
constexpr void list_fields(Is<Joints> auto& joints, auto&& field) {
  field("valid", "", joints.valid);
  field("pose", "", joints.pose);
}

/// Of a hand far from everything the joints are all there is, and of one that is felt by samples they stand
/// for the primitives that nobody has asked for; of one that could not be placed there is nothing.
constexpr void list_fields(Is<Primitives> auto& hand, auto&& field) {
  field("flags", "", hand.flags);
  field("out_of_reach", "", hand.out_of_reach);
  field("count", "", hand.count);
  if (hand.count == 0 && (hand.in_reach || hand.out_of_reach)) field("joints", "", hand.joints);
  if (!hand.in_reach) return;
  if (hand.count > 0) {
    field("primitive", "", std::span(hand.primitive).first(hand.count));
    field("border", "", hand.border);
    field("folded", "", hand.folded);
  }
  field("palm", "", hand.palm);
  field("base_joint", "m", hand.base_joint);
  field("flexion_axis", "", hand.flexion_axis);
}

/// Hashes of what goes into a tick and of what comes out, objects included: Stage::input and Stage::limits.
inline std::uint64_t with_objects(std::uint64_t hash, auto rows) {
  if (rows.empty()) return hash;
  Hasher hasher;
  hasher.value(hash);
  hasher.value(hash_rows(rows));
  return hasher.digest();
}
inline std::uint64_t hash_input(const DeviceFrame& frame, std::span<const ObjectFrame> given) {
  return with_objects(hash_fields(frame), given);
}
inline std::uint64_t hash_output(const ActuatorFrame& output, std::span<const ObjectOutput> objects) {
  return with_objects(hash_fields(output), objects);
}

// A field that is not listed fails here, where the struct has no padding or always the same.
static_assert(kIsRow<Contact> && kIsRow<HandForces> && kIsRow<ActuatorFrame>);
static_assert(kIsRow<HandState> && kIsRow<ProxyState> && kIsRow<MotionState> && kIsRow<ObjectState> &&
              kIsRow<ObjectOutput> && kIsRow<ObjectFrame>);
static_assert(kIsRow<JointPose> && kIsRow<HalfSpace> && kIsRow<Pose>);
static_assert(listed_bytes<DeviceFrame>() + 7 == sizeof(DeviceFrame));
static_assert(listed_bytes<Settings>() + 7 == sizeof(Settings));

}  // namespace lumbrical
