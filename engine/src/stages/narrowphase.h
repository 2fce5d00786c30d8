// Narrowphase: from a pair (primitive, triangle) to a contact, or to nothing.
#pragma once

#include "borders/general_contact.h"
#include "lumbrical/tick.h"

namespace lumbrical {

/// Contact of a round or flat primitive with the triangle `at` [m, W], by the lanes where they know the
/// way. Sets everything but the indices. `boundary` is working memory. False where they have no area in
/// common.
bool collide(const Primitive& primitive, const ContactQuery& query, const Corners& at, Boundary& boundary,
             Contact& contact);

/// Contacts of all candidates (primitive << 32 | triangle), in their order, those of round primitives under
/// the field law without their depth; contacts[i] may be written for every i. Returns how many there are.
std::uint32_t find_contacts(const Model& model, const Primitives& hand,
                            std::span<const std::uint64_t> candidates, std::span<Contact> contacts);

/// Contact::depth of a contact that was found without.
double depth_of(const Model& model, const Primitives& hand, const Contact& contact);

}  // namespace lumbrical
