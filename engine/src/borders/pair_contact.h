// One pair alone, of a primitive that shares out nothing, as the narrowphase has it of many.
#pragma once

#include "borders/general_contact.h"

namespace lumbrical {

/// Contact of a round or flat primitive with the triangle `at` [m, W], by the lanes where they know the
/// way. Sets everything but the indices. False where they have no area in common.
bool collide(const Primitive& primitive, const ContactQuery& query, const Corners& at, Contact& contact);

}  // namespace lumbrical
