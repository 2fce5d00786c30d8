// What several bodies of a hand hold together, to be felt once (Settings::felt_once), of contacts that the
// exact rung has found: for every triangle that two bodies touch, what others are deeper in is taken off what
// a segment feels. Borders between bodies are curves of the eighth degree in a triangle's plane, so this is
// not in closed form: each triangle is halved both ways, in double precision, until quadratics tell all that
// is in the parts (section/quadratic_part.h).
#pragma once

#include <cstdint>
#include <span>

#include "lumbrical/tick.h"

namespace lumbrical {

/// Takes it off volume and centre of the contacts found, sorted by primitive, of those `segments` whose bit
/// is set; by how much that may be off, by estimate, is added to their errors. Area, depth and centroid stay
/// those of all that a primitive touches. `room` has a number per contact. Returns the segments that leave
/// something to others.
std::uint32_t take_off_overlaps(const Model& model, const Primitives& hand, std::uint32_t segments,
                                std::span<Contact> found, std::span<std::uint64_t> room);

}  // namespace lumbrical
