#include "stages/contact_force.h"

namespace lumbrical {
namespace {

// A contact loads the joint of its own segment, every joint between that and the palm, and the wrist.
void add_to_joints(std::size_t segment, Vec3 force, Vec3 at, const Primitives& hand, HandForces& forces) {
  const std::size_t first = segment == kPalmSegment ? kPalmSegment : segment - segment % 3;
  for (std::size_t joint = first; joint <= segment; ++joint) {
    forces.joint_torque[joint] += cross(at - hand.base_joint[joint], force);
  }
  if (segment != kPalmSegment) {
    forces.joint_torque[kPalmSegment] += cross(at - hand.base_joint[kPalmSegment], force);
  }
}

}  // namespace

HandForces sum_forces(const Settings& settings, const Primitives& hand, std::span<const Contact> contacts) {
  HandForces forces;
  for (const Contact& contact : contacts) {
    const std::size_t segment = hand.primitive[contact.primitive].segment;
    const Vec3 force = (settings.stiffness * contact.volume) * contact.normal;
    forces.segment[segment].force += force;
    forces.segment[segment].torque += cross(contact.centre - hand.base_joint[segment], force);
    add_to_joints(segment, force, contact.centre, hand, forces);
  }
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    forces.flexion_torque[i] = dot(forces.joint_torque[i], hand.flexion_axis[i]);
  }
  return forces;
}

double force_error(const Settings& settings, std::span<const Contact> contacts) {
  double error = 0;
  for (const Contact& contact : contacts) error += contact.error;
  return settings.stiffness * error;
}

}  // namespace lumbrical
