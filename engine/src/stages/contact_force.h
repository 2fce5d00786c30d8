// Contact force: every contact pushes with K_s times its volume along its triangle's normal; forces are
// summed per segment and their moments per joint (Eq. 4 and 5 of the paper), always in the order of the
// contacts.
#pragma once

#include <array>
#include <span>

#include "lumbrical/tick.h"
#include "model/primitive.h"
#include "samples/sampled_forces.h"

namespace lumbrical {

/// Forces and torques before limits. `volume` of each contact is the law's (see lumbrical::Law); so F = K_s
/// volume n for every law, and Eq. 3-4 with volume = A_C dl_max for the paper's.
/// What samples have found is in `sampled`, per segment about the joint at its base, of a stiffness of 1.
HandForces sum_forces(const Settings& settings, const Primitives& hand, std::span<const Contact> contacts,
                      const std::array<Wrench, kSegmentCount>& sampled);

/// [N] Bound of the error of all contacts' forces together: K_s times the sum of their `error`.
double force_error(const Settings& settings, std::span<const Contact> contacts);

/// [N] What all sampled segments together may be off, by experience: see Settings::precision.
double error_estimate(const Settings& settings, const SampledForces& sampled);

}  // namespace lumbrical
