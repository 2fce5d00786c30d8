// Narrowphase: from a pair (primitive, triangle) to a contact, or to nothing.
#pragma once

#include "lumbrical/tick.h"
#include "model/primitive.h"

namespace lumbrical {

/// Contacts of all candidates (primitive << 32 | triangle), in their order, those of round primitives under
/// the field law without their depth; contacts[i] may be written for every i. Returns how many there are.
std::uint32_t collide_pairs(const Model& model, const Primitives& hand,
                            std::span<const std::uint64_t> candidates, std::span<Contact> contacts);

/// Contact::depth of a contact that was found without.
double depth_of(const Model& model, const Primitives& hand, const Contact& contact);

}  // namespace lumbrical
