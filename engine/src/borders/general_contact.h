// The general path, one pair at a time: every law, shape and border between tiles, and what is unclear
// to the lanes.
#pragma once

#include "exact/exact_kernels.h"
#include "lumbrical/contact.h"
#include "model/primitive.h"
#include "section/section.h"

namespace lumbrical {

/// What a pair's contact is computed for.
struct ContactQuery {
  double point_area = 1e-4;  ///< [m^2] Settings::point_area
  const Primitives* hand =
      nullptr;  ///< whose phalanges the paper's depth runs through; none: the primitive alone
  const ExactKernels& kernels = exact_kernels(Isa::scalar);
  bool depth = true;  ///< tell Contact::depth even where the law does without
};

/// Contact of a round or flat primitive, cut by its planes, with the triangle `at` [m, W]. Sets everything
/// but the indices. False where they have no area in common.
bool general_contact(const Primitive& primitive, const ContactQuery& query, const Corners& at,
                     Contact& contact);

/// Sets volume and centre by the laws that take them from the contact's depth, which is largest at `deepest`
/// [m, W], and from its area and centroid.
void press_by_depth(Law law, double point_area, Vec3 deepest, Contact& contact);

/// Contact of the primitive of a hand that contact.primitive names with the triangle `at` [m, W], whatever
/// it is and shares out with others; of a round or flat one without depth under the field law. An area of
/// zero marks that there is none.
void hand_contact(const Primitives& hand, const ExactKernels& kernels, double point_area, const Corners& at,
                  Contact& contact);

/// Contact::depth of such a contact of a round primitive under the field law.
double hand_depth(const Primitives& hand, const Primitive& primitive, const Corners& at);

}  // namespace lumbrical
