// What a rounded cone's field differs by from the parts the SIMD kernel integrates it in.
#pragma once

#include "lanes/field_kernels.h"
#include "lumbrical/contact.h"
#include "section/section.h"

namespace lumbrical {

/// The kernel parts a cone's plane at the lines x = const through the rim's joints (section.h). The field
/// changes its formula a little earlier, on conics cos(alpha) q = sin(alpha) rho through the same joints;
/// between conic and line, a sliver some sin(alpha) R wide, it is the other formula's. Adds the integral of
/// the difference to volume and centre of a contact computed so. False, and nothing is changed, where the
/// difference is not smooth enough: the pair is for `collide_section`.
bool add_slivers(const FieldKernels& kernels, const Section& section, Contact& contact);

}  // namespace lumbrical
