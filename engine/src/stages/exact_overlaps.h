// What several bodies of a hand hold together, to be felt once (Settings::felt_once), of contacts that the
// exact rung has found: for every triangle that two bodies touch, what others are deeper in is taken off what
// a segment feels. Borders between bodies are curves of the eighth degree in a triangle's plane, so this is
// not in closed form: each triangle is halved both ways, in double precision, until quadratics tell all that
// is in the parts (section/quadratic_part.h).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/tick.h"
#include "model/primitive.h"

namespace lumbrical {

struct ExactOverlaps {
  std::vector<std::uint64_t> touched;           ///< triangle << 32 | segment, ascending
  std::array<Wrench, kSegmentCount> segment{};  ///< to be added, of a stiffness of 1: see SampledForces
  double error = 0;                             ///< [m^3] what they may be off together, by estimate
};

/// Of the last tick's contacts. `overlaps.touched` has room for a number per contact.
void take_off_overlaps(const Model& model, const Primitives& hand, std::span<const Contact> contacts,
                       ExactOverlaps& overlaps);

}  // namespace lumbrical
