// The proxy: the hand as far as surfaces let it follow. It is what feels.
//
// Each tick it goes from where it was towards the tracked hand, in steps shorter than half the distance from
// any axis to the nearest triangle: so no axis ever passes a surface, however fast the hand and however thin
// the surface, and none needs to be asked on which side it is. Where no core is in the way it is the tracked
// hand, to the bit.
#pragma once

#include "lumbrical/tick.h"
#include "model/primitive.h"
#include "proxy/core_gaps.h"
#include "proxy/core_pushes.h"

namespace lumbrical {

struct ProxyMemory {
  Scratch search;
  PushList pushing;  ///< in the last tick
  GapMemory gaps;
};
std::shared_ptr<ProxyMemory> make_proxy_memory(const Model& model);

/// Moves the proxy towards the tracked hand in `hand`, which is then the proxy, and lists in `scratch` the
/// gaps that push. At first, and after a tick without `trusted`, there is none until the tracked hand's cores
/// are outside all surfaces: before that no one can say from where they came. A hand without a wrist has
/// none. Joints that tracking loses while something holds the proxy stay as they were on what carries them.
/// Where something has come to lie across a core's axis, or one is inside a solid, the proxy is forgotten,
/// and `anew` set: forces are of another hand then. Returns TickFlag bits.
std::uint32_t follow_hand(const Model& model, bool trusted, State& state, Scratch& scratch, Primitives& hand,
                          bool& anew);

/// Adds what the world's surfaces push the cores with.
void add_pushes(const PushList& pushing, Primitives& hand, HandForces& forces);

/// Of the pushes on fingers, how much the palm's field answers, once `forces` has all of it: what fingers
/// squeeze against the palm moves no wrist, though it is the palm's field that holds it there.
void balance_pushes(const PushList& pushing, const HandForces& forces, double rate, ProxyState& kept);

/// What the surfaces of one object push a segment's core with.
struct CorePush {
  Wrench wrench;         ///< [N], [N m] about the segment's base joint, W
  double stiffness = 0;  ///< [N/m] at most
};
CorePush push_on(const PushList& pushing, std::uint8_t object, const Primitives& hand, std::size_t segment);

}  // namespace lumbrical
