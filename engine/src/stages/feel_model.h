// What a hand feels of one model: all the stages between a placed hand and its forces before limits.
#pragma once

#include "lumbrical/tick.h"
#include "model/primitive.h"

namespace lumbrical {

inline void tell(const StageWatch& watch, Stage stage) {
  if (watch.ended != nullptr) watch.ended(watch.self, stage);
}

/// Whether it is that of this model or of a copy.
bool is_made_for(const Model& model, const Scratch& scratch);

/// Makes room in `scratch` for a model's ticks, beside what it has room for already.
void make_room(const Model& model, Scratch& scratch);

/// What a frame does not tell must not be left from another: a tick, hashes included, is a function of model,
/// state and frame. Even no force times an old axis has that axis' sign. Before a hand is placed.
void forget_hand(Primitives& hand);

/// Those that feel once what several bodies hold, whichever rung lists their contacts.
std::uint32_t segments_felt_once(const Model& model);

/// Forces of the hand placed in the model's frame in `scratch`, and what was found on the way, but for its
/// pads' layers. `spent` evaluations of Settings::effort are gone. Adds TickFlag bits to `flags`; without
/// forces where there are more pairs than there is room for.
HandForces feel(const Model& model, Scratch& scratch, std::uint64_t spent, std::uint32_t& flags);

/// Adds what the pads' layers feel; after `feel`, or `feel_nothing`, and as that was told.
void add_layers(const Model& model, Scratch& scratch, std::uint64_t spent, std::uint32_t& flags,
                HandForces& forces);

/// The force on the palm if the hand, which `scratch` has felt layers and all, were moved by `by` [m] in the
/// model's frame: so by small ways it is as right as forces are. Leaves the hand there, and adds its
/// evaluations to `evaluations`, those of the tick so far, and TickFlag bits to `flags`.
Vec3 palm_force_moved(const Model& model, Vec3 by, Scratch& scratch, std::uint64_t& evaluations,
                      std::uint32_t& flags);

/// The same of a hand that can't be placed: nothing, but everything that is hashed is in place.
HandForces feel_nothing(const Model& model, Scratch& scratch);

/// What was found on the way to the forces.
struct Findings {
  std::uint32_t contact_count = 0;  ///< layers find the same ones again, and are not counted
  std::uint64_t evaluations = 0;
  double error_estimate = 0, force_error = 0;  ///< [N]
};
void operator+=(Findings& to, const Findings& more);

/// Of the last time `model` was felt on `scratch`, layers included.
Findings findings_of(const Model& model, const Scratch& scratch);

/// Contacts of the candidates in `scratch`; where these are not `all_found`, no Jacobian is known.
void find_all_contacts(const Model& model, Scratch& scratch, bool all_found);

}  // namespace lumbrical
