// The tick: one stage after the other, each a function of the data before it.
#include "lumbrical/tick.h"

#include <cassert>
#include <string>
#include <utility>

#include "base/floating_point.h"
#include "model/corners.h"
#include "model/felt_surface.h"
#include "objects/body_motion.h"
#include "objects/object_forces.h"
#include "objects/touches.h"
#include "proxy/proxy_hand.h"
#include "samples/sampled_forces.h"
#include "stages/broadphase.h"
#include "stages/feel_model.h"
#include "stages/force_limits.h"
#include "stages/hand_pose.h"
#include "stages/narrowphase.h"
#include "stages/pad_damping.h"
#include "tick/field_lists.h"

namespace lumbrical {
namespace {

constexpr std::uint32_t kUntrusted =
    kInputNotFinite | kInputImplausible | kInputLost | kCandidateOverflow | kObjectImplausible;

void hash_stages(const DeviceFrame& frame, std::span<const ObjectFrame> given, const ActuatorFrame& output,
                 Scratch& scratch) {
  const auto hash_of_stage = [&scratch](Stage stage) -> std::uint64_t& {
    return scratch.stage_hash[static_cast<std::size_t>(stage)];
  };
  hash_of_stage(Stage::input) = hash_input(frame, given);
  hash_of_stage(Stage::hand_pose) = hash_fields(*scratch.primitives);
  hash_of_stage(Stage::broadphase) =
      hash_rows(std::span<const std::uint64_t>(scratch.candidates.data(), scratch.candidate_count));
  Hasher narrowphase;
  narrowphase.value(hash_rows(std::span<const Contact>(scratch.contacts.data(), scratch.contact_count)));
  narrowphase.value(hash_fields(scratch.samples->forces));
  hash_of_stage(Stage::narrowphase) = narrowphase.digest();
  hash_of_stage(Stage::contact_force) = hash_fields(scratch.forces);
  hash_of_stage(Stage::limits) = hash_output(output, std::span<const ObjectOutput>(scratch.object_output));
}

// Forces pass over to what the hand feels with other joints, which would come, or go, with all their force,
// or at a place that it has jumped to, where its proxy begins anew.
bool take_place(const Joints& joints, double rate, State& state, std::uint32_t& flags) {
  const bool jumped = has_jumped(joints, rate, state);
  if (jumped) flags |= kHandJumped;
  if (jumped && state.proxy) *state.proxy = {};
  if (jumped) state.motion.reset();
  return std::exchange(state.joints, joints.valid) != joints.valid || jumped;
}

// What of a proxy goes elsewhere at once goes no way.
std::uint32_t follow(const Model& model, bool trusted, State& state, Scratch& scratch, bool& anew) {
  bool elsewhere = false;
  const std::uint32_t flags = follow_hand(model, trusted, state, scratch, *scratch.primitives, elsewhere);
  if (elsewhere) state.motion.reset();
  anew = anew || elsewhere;
  return flags;
}

// Of memory that is not the model's nothing is read: it ends anywhere.
ActuatorFrame feel_no_more(const Model& model, State& state, Scratch& scratch) {
  scratch.stage_hash = {};
  return fade_forces(model.settings, kMemoryForeign, state);
}

}  // namespace

std::string_view stage_name(Stage stage) {
  assert(static_cast<std::size_t>(stage) < kStageCount);
  constexpr std::array<std::string_view, kStageCount> names = {"input",       "hand_pose",     "broadphase",
                                                               "narrowphase", "contact_force", "limits"};
  return names[static_cast<std::size_t>(stage)];
}

Scratch make_scratch(const Model& model) {
  assert(model.build != 0 && "build_model first");
  Scratch scratch;
  scratch.build = model.build;
  make_room(model, scratch);
  scratch.object_output.resize(model.apart.size());
  if (model.settings.proxy_stiffness > 0) scratch.proxy = make_proxy_memory(model);
  for (const ApartObject& object : model.apart) {
    if (object.mechanism.mobility == Mobility::given && !scratch.touches) {
      scratch.touches = std::make_shared<HandTouches>();
      scratch.touches->object = std::vector<Touches>(model.apart.size());
    }
    if (!scratch.apart) {
      scratch.apart = std::make_shared<Scratch>();
      scratch.apart->keep_near = false;  // objects take turns: a list would be of another one's
    }
    make_room(*object.shape, *scratch.apart);
    if (object.felt) size_candidates(object.felt->part, *scratch.apart);
  }
  return scratch;
}

std::uint32_t input_flags(const DeviceFrame& frame) {
  std::uint32_t flags = check_input(frame);
  if ((frame.flags & kTrackingLost) != 0) flags |= kInputLost;
  if ((frame.flags & kExtrapolated) != 0) flags |= kInputExtrapolated;
  return flags;
}

bool is_trusted(std::uint32_t flags) { return (flags & kUntrusted) == 0; }

namespace {

// All stages, of a model's own memory. By itself so that its answer, which is long, is not copied.
ActuatorFrame feel_all(const Model& model, State& state, Scratch& scratch, const DeviceFrame& frame,
                       std::span<const ObjectFrame> given) {
  Primitives& hand = *scratch.primitives;
  forget_hand(hand);
  std::uint32_t flags = hand.flags = input_flags(frame);
  tell(scratch.watch, Stage::input);
  const bool placed = is_trusted(flags);
  if (placed) flags = hand.flags |= place_hand(model.hand, model.settings, frame, hand);
  if (!is_trusted(flags)) state.joints = 0;
  bool anew = is_trusted(flags) && take_place(hand.joints, model.settings.rate, state, flags);
  const bool apart = !model.apart.empty();
  if (apart) flags |= move_given(model, given, state, anew);
  if (!scratch.proxy) state.proxy.reset();
  if (scratch.proxy) flags |= follow(model, is_trusted(flags), state, scratch, anew);
  HandForces& forces = scratch.forces =
      placed ? feel(model, scratch, 0, flags) : feel_nothing(model, scratch);
  add_layers(model, scratch, 0, flags, forces);
  if (scratch.proxy) add_pushes(scratch.proxy->pushing, hand, forces);
  const SegmentSpeeds speeds = speeds_asked_for(model, is_trusted(flags), hand, state.motion);
  damp_pads(model.settings.pad, speeds, hand, forces);
  Findings findings = findings_of(model, scratch);
  if (apart) feel_objects({model, hand, speeds, is_trusted(flags)}, state, scratch, forces, findings, flags);
  if (scratch.proxy) {
    balance_pushes(scratch.proxy->pushing, forces, model.settings.rate, *state.proxy);
    hand_on(scratch.proxy->pushing, hand, model.settings.rate, anew, *state.proxy, forces);
  }
  tell(scratch.watch, Stage::contact_force);

  const Trust trust = !is_trusted(flags) ? Trust::none : anew ? Trust::anew : Trust::kept;
  ActuatorFrame output = limit_forces(model.settings, hand, forces, trust, flags, state);
  output.contact_count = findings.contact_count;
  output.evaluations = findings.evaluations;
  output.force_error = findings.force_error;
  output.error_estimate = findings.error_estimate;
  tell(scratch.watch, Stage::limits);

  if (scratch.hash_stages) hash_stages(frame, given, output, scratch);
  return output;
}

}  // namespace

ActuatorFrame tick(const Model& model, State& state, Scratch& scratch, const DeviceFrame& frame,
                   std::span<const ObjectFrame> given) {
  const bool own_scratch = is_made_for(model, scratch);
  const bool own_state = state.objects.size() == model.apart.size();
  assert(own_scratch && "make_scratch(model)");
  assert(own_state && "make_state(model)");
  const FloatingPointGuard guard;
  if (!own_scratch || !own_state) return feel_no_more(model, state, scratch);
  return feel_all(model, state, scratch, frame, given);
}

namespace {

// Contacts of the hand that is placed in `scratch`, by the exact rung.
void find_exact_contacts(const Model& model, Scratch& scratch) {
  const bool all_found = find_candidates(model, *scratch.primitives, scratch);
  if (!all_found) scratch.candidate_count = 0;
  find_all_contacts(model, scratch, all_found);
}

// Is this part of a triangle nothing but rounding's, where the segment only just misses it? It may lie beside
// the segment then, at any depth. Of half a million parts those had at most 2e-14 of this square.
bool is_rounding(const Model& model, const Primitives& hand, const Contact& contact) {
  constexpr double kNothing = 1e-12;
  const auto [a, b, c] = corners_of(model.triangles, contact.triangle);
  const Primitive& primitive = hand.primitive[contact.primitive];
  const double edge = max(norm(b - a), max(norm(c - b), norm(a - c)));
  const double extent = min(edge, max(primitive.radius1, primitive.radius2));
  return !(contact.area > kNothing * extent * extent);
}

// What the tick has found, as others are to see it.
std::span<const Contact> records(const Model& model, Scratch& scratch) {
  const FloatingPointGuard guard;
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < scratch.contact_count; ++i) {
    if (is_rounding(model, *scratch.primitives, scratch.contacts[i])) continue;
    Contact& contact = scratch.contacts[count++] = scratch.contacts[i];
    contact.depth = depth_of(model, *scratch.primitives, contact);
  }
  scratch.contact_count = count;
  return {scratch.contacts.data(), count};
}

// From an object's frame into W.
void place_contact(const Pose& X_WO, Contact& contact) {
  contact.centroid = transform(X_WO, contact.centroid);
  contact.centre = transform(X_WO, contact.centre);
  contact.normal = rotate(X_WO.orientation, contact.normal);
}

int segment_of(const Primitives& hand, const Contact& contact) {
  assert(contact.primitive < hand.count);
  return hand.primitive[contact.primitive].segment;
}

}  // namespace

std::span<const Contact> find_contacts(const Model& model, Scratch& scratch) {
  assert(is_made_for(model, scratch) && "make_scratch(model)");
  if (!is_made_for(model, scratch)) return {};
  if (sampled_segments(model) != 0 && scratch.primitives->in_reach) {
    const FloatingPointGuard guard;
    tile_hand(model.settings, *scratch.primitives);
    find_exact_contacts(model, scratch);
  }
  return records(model, scratch);
}

std::span<const Contact> find_contacts(const Model& model, Scratch& scratch, std::size_t object) {
  assert(is_made_for(model, scratch) && "make_scratch(model)");
  assert(object < model.apart.size());
  if (!is_made_for(model, scratch) || object >= model.apart.size()) return {};
  const FloatingPointGuard guard;
  const Model& shape = *model.apart[object].shape;
  const Primitives& hand = *scratch.primitives;
  Scratch& own = *scratch.apart;
  Primitives& placed = *own.primitives;
  placed.count = 0;
  if (is_trusted(hand.flags))
    tile_hand_in(shape, hand.joints, inverse(scratch.object_output[object].pose), placed);
  find_exact_contacts(shape, own);
  return records(shape, own);
}

int contact_segment(const Scratch& scratch, const Contact& contact) {
  assert(scratch.primitives && "make_scratch(model)");
  return segment_of(*scratch.primitives, contact);
}

int contact_segment(const Scratch& scratch, const Contact& contact, [[maybe_unused]] std::size_t object) {
  assert(scratch.apart && object < scratch.object_output.size() && "find_contacts(model, scratch, object)");
  return segment_of(*scratch.apart->primitives, contact);
}

std::vector<NamedContact> all_contacts(const Model& model, Scratch& scratch) {
  std::vector<NamedContact> result;
  for (const Contact& contact : find_contacts(model, scratch)) {
    const std::size_t object = object_of(model, contact.triangle);
    result.push_back({static_cast<std::uint32_t>(contact_segment(scratch, contact)),
                      static_cast<std::uint32_t>(object),
                      contact.triangle - model.objects[object].first_triangle, contact});
  }
  const FloatingPointGuard guard;
  for (std::size_t i = 0; i < model.apart.size(); ++i) {
    for (const Contact& contact : find_contacts(model, scratch, i)) {
      const auto segment = static_cast<std::uint32_t>(contact_segment(scratch, contact, i));
      const auto object = static_cast<std::uint32_t>(model.objects.size() + i);
      result.push_back({segment, object, contact.triangle, contact});
      place_contact(scratch.object_output[i].pose, result.back().contact);
    }
  }
  return result;
}

std::span<const Pose, kJointCount> placed_joints(const Scratch& scratch) {
  static constexpr std::array<Pose, kJointCount> kNowhere{};
  assert(scratch.primitives && "make_scratch(model)");
  return scratch.primitives ? std::span<const Pose, kJointCount>(scratch.primitives->joints.pose) : kNowhere;
}

namespace {

bool pushes(const HandForces& forces) {
  bool any = false;
  walk(forces, [&any](const FieldName&, double number) { any = any || number != 0; });
  return any;
}

}  // namespace

State make_state(const Model& model) {
  State state;
  for (const ApartObject& object : model.apart) state.objects.emplace_back().pose = object.start;
  return state;
}

Status check_state(const Model& model, const State& state) {
  if (state.objects.size() != model.apart.size())
    return Status::error("the state is of a model with " + std::to_string(state.objects.size()) +
                         " objects that move or rub, not " + std::to_string(model.apart.size()));
  for (std::size_t i = 0; i < model.apart.size(); ++i) {
    const ApartObject& object = model.apart[i];
    if (!may_be_at(object.mechanism, object.start, state.objects[i]))
      return Status::error("the state is of another model: object \"" + object.name +
                           "\" can't be where it has it");
  }
  if (state.proxy && model.settings.proxy_stiffness == 0)
    return Status::error("the state is of a model with a proxy, and this one has none");
  if (!(state.rise + state.fall <= 1 + 1e-9))
    return Status::error("the state's shares of forces are more than all of them; no tick leaves such a one");
  if (!(state.fall > 0) && (pushes(state.held) || (!(state.rise > 0) && pushes(state.last))))
    return Status::error(
        "the state has forces and no share of them, so they would be gone at once; take one that a tick has "
        "left");
  return {};
}

std::uint64_t hash_state(const State& state) {
  const std::uint64_t hand = hash_fields(static_cast<const HandState&>(state));
  const std::uint64_t all = with_objects(hand, std::span<const ObjectState>(state.objects));
  const std::uint64_t held = state.proxy ? with_objects(all, std::span(&*state.proxy, 1)) : all;
  return state.motion ? with_objects(held, std::span(&*state.motion, 1)) : held;
}

}  // namespace lumbrical
