// The engine's one verb: a device frame goes in, an actuator frame comes out.
//
//   Model model;    build_model(scene, execution, model)
//   State state;    what one tick leaves for the next
//   Scratch scratch = make_scratch(model);
//   ActuatorFrame out = tick(model, state, scratch, frame);
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "lumbrical/contact.h"
#include "lumbrical/device.h"
#include "lumbrical/model.h"
#include "lumbrical/search_memory.h"

namespace lumbrical {

/// Of one session, a left and a right one.
inline constexpr std::size_t kMostHands = 2;

/// What of the hand's forces survives from one tick to the next. No padding: hashed as it stands.
struct HandState {
  std::uint64_t tick = 0;      ///< number of the next tick: the engine's only clock
  double rise = 0;             ///< share of the fresh forces in the output, 0 .. 1
  double fall = 0;             ///< share of the held forces in the output, 0 .. 1
  std::uint64_t joints = 0;    ///< a bit for each joint of the last tick's hand; 0: there was none
  std::array<Vec3, 6> ends{};  ///< [m] W: where its fingertips were, and its wrist
  HandForces last;             ///< the last output
  HandForces held;             ///< the output when trust was lost
};

/// The hand as far as surfaces let it follow (Settings::proxy_stiffness). No padding: hashed as it stands.
struct ProxyState {
  std::array<Pose, kJointCount> joint;  ///< X_WJ
  double valid = 0;     ///< a whole number with a bit for each joint it knows a place of; 0: it starts anew
  double balanced = 0;  ///< share of what holds it back that the rest of the hand answers, 0 .. 1
  std::array<Vec3, kJointCount> tracked{};  ///< [m] W, where those joints of the tracked hand were
  /// [N] W, of what holds the cores: what each phalanx' base joint carries, and how much more than that its
  /// segments are made to feel, where it has hopped from one to another
  std::array<Vec3, kPhalanxCount> carried{}, late{};
};

/// Where segments were, and how fast they go. No padding: hashed as it stands.
struct MotionState {
  std::array<Pose, kSegmentCount> segment;  ///< X_WS of their base joints
  std::array<Twist, kSegmentCount> speed;   ///< of those, W, a mean over some milliseconds
  double valid = 0;                         ///< a whole number with a bit for each joint the last tick had
};

/// The little that survives from one tick to the next. Copy it to take a snapshot. `State state;` does for a
/// model without objects apart; with them, make_state.
struct State : HandState {
  std::vector<ObjectState> objects;   ///< of Model::apart, in their order
  std::optional<ProxyState> proxy;    ///< where the model has one
  std::optional<MotionState> motion;  ///< where pads are damped, or objects move by themselves
};

/// Before the first tick: objects stand where they start.
State make_state(const Model& model);

/// For a state from elsewhere: refuses one of more or fewer objects, with one where its mobility does not let
/// it be, with a proxy where there is none, shares of forces above 1, or forces that have no share. Forces
/// above Settings::max_force, left by other settings, are taken: a tick lets out no more than its own allow.
Status check_state(const Model& model, const State& state);

/// The stages of a tick, in order; a divergence between recording and replay names one of them.
enum class Stage : std::uint8_t { input, hand_pose, broadphase, narrowphase, contact_force, limits };
inline constexpr int kStageCount = 6;
std::string_view stage_name(Stage stage);

struct Primitives;    // a hand posed and cut into parts; primitive.h inside the engine
struct SampleMemory;  // the passes of the rungs of samples; sampled_forces.h inside the engine
struct ProxyMemory;   // what holds the proxy back; proxy_hand.h inside the engine
struct HandTouches;   // how it touches what is given; touches.h inside the engine
struct NearPairs;     // what earlier searches found near; near_pairs.h inside the engine

/// Told by a tick that a stage of it has ended (the stages of sampled hands take turns), for whoever measures
/// how long they take: the engine itself has no clock. It must touch nothing of the tick's, and not throw.
struct StageWatch {
  void (*ended)(void* self, Stage stage) = nullptr;
  void* self = nullptr;
};

/// Everything derived inside a tick. Sized once for a model (make_scratch), and of use for that and its
/// copies only; a tick allocates nothing. It is moved and not copied: two ticks on one memory would be two
/// threads on it some day.
struct Scratch {
  Scratch() = default;
  Scratch(Scratch&&) = default;
  Scratch& operator=(Scratch&&) = default;
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  std::uint64_t build = 0;  ///< Model::build of that model; 0: it is empty, and no tick takes it
                            ///< (kMemoryForeign)
  std::shared_ptr<Primitives> primitives;
  std::shared_ptr<NearPairs> near;  ///< spares searches while the hand moves little; never changes a result
  std::shared_ptr<SampleMemory> samples;
  std::vector<std::uint64_t>
      candidates;  ///< primitive << 32 | Contact::triangle, ascending; `candidate_count` of them
  std::vector<Contact> contacts;       ///< sorted by primitive, then triangle; `contact_count` of them
  std::vector<std::uint64_t> sorting;  ///< the other array of the candidates' sort
  std::vector<SearchMemory> searcher;  ///< one per thread
  std::vector<std::uint32_t> cells;    ///< of the grid, that may be met
  std::uint32_t candidate_count = 0;
  std::uint32_t contact_count = 0;
  std::uint32_t no_jacobian = 0;  ///< segments whose contacts were too many, or leave something to deeper
                                  ///< bodies, a bit each
  HandForces forces;              ///< of the last tick, before limits
  bool keep_near = true;          ///< use `near`; false: search afresh every tick
  std::shared_ptr<ProxyMemory> proxy;       ///< null: there is none
  std::vector<Scratch> layers;              ///< of Model::layers
  std::shared_ptr<Scratch> apart;           ///< for objects apart, one after the other; null: there is none
  std::vector<ObjectOutput> object_output;  ///< of Model::apart in the last tick, in their order
  std::shared_ptr<HandTouches> touches;     ///< for who moves given objects; null: there is none
  StageWatch watch;                         ///< nobody's, unless set
  bool hash_stages = true;                  ///< compute stage_hash (recording and replay need it)
  std::array<std::uint64_t, kStageCount> stage_hash{};  ///< of each stage's results in the last tick that was
                                                        ///< asked for them
};

Scratch make_scratch(const Model& model);

/// Computes one tick. A pure function of model, state and frame: no clock, input or output, allocation, lock
/// or exception; the same bits on every machine, instruction set, thread count and broadphase. Whatever can
/// go wrong is told in ActuatorFrame::flags; forces that can't be trusted fade to zero.
/// `given` tells where the objects are that are moved from outside (Mobility::given), in the order of
/// Model::apart; one that is left out stays where it was (kObjectMissing).
ActuatorFrame tick(const Model& model, State& state, Scratch& scratch, const DeviceFrame& frame,
                   std::span<const ObjectFrame> given = {});

/// The contact records behind the last tick on `scratch`: of every law and rung, also of those that need none
/// for their forces and leave them out of Scratch::contacts (sampled segments); those are then computed here,
/// by the exact rung, and stand in `scratch` until the next tick. Together they push as hard as the hand was,
/// to the segments' precision; those of no area but rounding's are left out. Takes as long as an exact tick,
/// and a millisecond more where several bodies of the hand touch the same triangles, of what is felt once.
/// Empty where that tick's frame could not be trusted, or where there are more pairs than
/// Settings::max_candidates.
std::span<const Contact> find_contacts(const Model& model, Scratch& scratch);

/// The same of one of Model::apart, in its frame O, which stood at ObjectOutput::pose; Contact::triangle
/// counts its own, Contact::depth is there. Until the next call.
std::span<const Contact> find_contacts(const Model& model, Scratch& scratch, std::size_t object);

/// The hand segment that a contact of the world is felt by in the last tick; the object is object_of(model,
/// triangle) (model.h).
int contact_segment(const Scratch& scratch, const Contact& contact);

/// The same of a contact that find_contacts has last found on one of Model::apart.
int contact_segment(const Scratch& scratch, const Contact& contact, std::size_t object);

/// A contact with what touches what.
struct NamedContact {
  std::uint32_t segment = 0;   ///< of the hand
  std::uint32_t object = 0;    ///< in all_objects (model.h): of the world first, then Model::apart
  std::uint32_t triangle = 0;  ///< of the object's own mesh
  Contact contact;             ///< all of it in W, of objects apart, too
};

/// All that find_contacts tells, of the world and then of each of Model::apart, in memory of its own. Not
/// inside a tick: it allocates.
std::vector<NamedContact> all_contacts(const Model& model, Scratch& scratch);

/// X_WJ of the joints as the last tick placed them; those of an earlier one where its frame could not be
/// trusted.
std::span<const Pose, kJointCount> placed_joints(const Scratch& scratch);

/// Hash of everything in the state, for recordings and tests.
std::uint64_t hash_state(const State& state);

}  // namespace lumbrical
