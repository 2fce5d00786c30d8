// Pairs (primitive, triangle) that go through the passes of the narrowphase together, each with a slot of its
// own: a list of pairs is a list of slots, and what is found of a pair goes where its slot says.
#pragma once

#include <span>

#include "base/fixed_list.h"
#include "exact/exact_kernels.h"
#include "lumbrical/contact.h"
#include "model/corners.h"
#include "model/primitive.h"

namespace lumbrical {

struct PairSlots {
  const Triangles& world;
  const Primitives& hand;
  const ExactKernels& kernels;
  std::span<Contact> contact;  ///< names the pair; an area of 0 marks that there is no contact

  [[nodiscard]] const Primitive& primitive(std::uint32_t slot) const {
    return hand.primitive[contact[slot].primitive];
  }
  [[nodiscard]] Corners corners(std::uint32_t slot) const {
    return corners_of(world, contact[slot].triangle);
  }
};

inline constexpr std::size_t kMostPairs = 2048;
using PairList = FixedList<std::uint32_t, kMostPairs>;

}  // namespace lumbrical
