#include "stages/contact_force.h"

#include <cmath>

#include "base/wrench.h"
#include "stages/joint_torques.h"

namespace lumbrical {

HandForces sum_forces(const Settings& settings, const Primitives& hand, std::span<const Contact> contacts,
                      const std::array<Wrench, kSegmentCount>& sampled) {
  HandForces forces;
  for (std::size_t i = 0; i < kSegmentCount; ++i) forces.segment[i] = settings.stiffness * sampled[i];
  for (const Contact& contact : contacts) {
    const std::size_t segment = hand.primitive[contact.primitive].segment;
    const Vec3 force = (settings.stiffness * contact.volume) * contact.normal;
    forces.segment[segment] += {force, cross(contact.centre - hand.base_joint[segment], force)};
  }
  sum_joint_torques(hand, forces);
  return forces;
}

double error_estimate(const Settings& settings, const SampledForces& sampled) {
  if (sampled.evaluations == 0) return 0;  // then every force is
  double estimate = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i)
    estimate += min(1, sampled.error_factor * settings.precision[i]) * norm(sampled.segment[i].force);
  return std::fabs(settings.stiffness) * estimate;
}

double force_error(const Settings& settings, std::span<const Contact> contacts) {
  double error = 0;
  for (const Contact& contact : contacts) error += contact.error;
  return std::fabs(settings.stiffness) * error;
}

}  // namespace lumbrical
