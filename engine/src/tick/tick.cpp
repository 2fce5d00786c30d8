// The tick: one stage after the other, each a function of the data before it.
#include "lumbrical/tick.h"

#include <cstring>

#include "base/floating_point.h"
#include "base/former_hash.h"
#include "base/hash.h"
#include "stages/broadphase.h"
#include "stages/contact_force.h"
#include "stages/force_limits.h"
#include "stages/hand_pose.h"
#include "stages/narrowphase.h"

namespace lumbrical {
namespace {

constexpr std::uint32_t kUntrusted = kInputNotFinite | kInputImplausible | kInputLost | kCandidateOverflow;

// The numbers of a posed hand in a row, since they lie about in structs that hold others too: a hash takes
// rows several words at a time.
class NumberRow {
 public:
  /// Any struct or array of 8-byte numbers.
  template <class T>
  void add(const T& numbers) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(std::uint64_t) == 0);
    std::memcpy(word_.data() + count_, &numbers, sizeof(T));
    count_ += sizeof(T) / sizeof(std::uint64_t);
  }
  [[nodiscard]] std::span<const std::uint64_t> words() const { return {word_.data(), count_}; }

 private:
  static constexpr std::size_t kPrimitiveWords = 8 + 2 * 6, kSegmentWords = 6;
  std::array<std::uint64_t, 2 + Primitives::kMaxCount * kPrimitiveWords + kSegmentCount * kSegmentWords>
      word_;
  std::size_t count_ = 0;
};

template <class Hasher>
std::uint64_t hash_of(const DeviceFrame& frame) {
  const auto& [position, orientation] = frame.base;
  Hasher hasher;
  for (const double number :
       {position.x, position.y, position.z, orientation.w, orientation.x, orientation.y, orientation.z}) {
    hasher.value(number);
  }
  hasher.value(frame.kind);
  hasher.value(frame.flags);
  hasher.value(frame.valid);
  hasher.array(frame.joint);
  hasher.array(frame.angle);
  return hasher.digest();
}

template <class Hasher>
std::uint64_t hash_of(const Primitives& hand, std::uint32_t flags) {
  NumberRow row;
  row.add(std::uint64_t{flags});
  row.add(static_cast<std::uint64_t>(hand.count));
  for (int i = 0; i < hand.count; ++i) {
    const Primitive& primitive = hand.primitive[static_cast<std::size_t>(i)];
    row.add(primitive.end1);
    row.add(primitive.end2);
    row.add(primitive.radius1);
    row.add(primitive.radius2);
    for (std::size_t k = 0; k < primitive.cut_count; ++k) {
      row.add(primitive.cut[k].normal);
      row.add(primitive.cut[k].point);
    }
  }
  if (hand.out_of_reach) {  // not shaped: whole phalanges and palm are all there is
    for (std::size_t i = 0; i < kPhalanxCount; ++i) {
      const Primitive& capsule = hand.capsule[i];
      row.add(std::uint64_t{hand.present[i]});
      if (!hand.present[i]) continue;
      row.add(capsule.end1);
      row.add(capsule.end2);
      row.add(capsule.radius1);
      row.add(capsule.radius2);
    }
    row.add(std::uint64_t{hand.joints.has(kPalm)});
    if (hand.joints.has(kPalm)) row.add(hand.joints.pose[kPalm]);
  }
  row.add(hand.base_joint);
  row.add(hand.flexion_axis);
  Hasher hasher;
  hasher.words(row.words());
  return hasher.digest();
}

// Plain arrays of 8-byte numbers, without padding.
template <class Hasher, class T>
std::uint64_t hash_plain(const T& data) {
  static_assert(sizeof(T) % sizeof(double) == 0 && std::is_trivially_copyable_v<T>);
  Hasher hasher;
  hasher.bytes(&data, sizeof(T));
  return hasher.digest();
}

template <class Hasher, class T>
std::uint64_t hash_items(std::span<const T> items) {
  Hasher hasher;
  hasher.array(items);
  return hasher.digest();
}

/// What the stages of one tick have found.
struct Findings {
  const DeviceFrame& frame;
  const Primitives& hand;
  std::uint32_t flags = 0;
  std::span<const std::uint64_t> candidates;
  std::span<const Contact> contacts;
  const HandForces& forces;
  const ActuatorFrame& output;
};

template <class Hasher>
void hash_stages(const Findings& found, std::array<std::uint64_t, kStageCount>& stage_hash) {
  const auto hash_of_stage = [&stage_hash](Stage stage) -> std::uint64_t& {
    return stage_hash[static_cast<std::size_t>(stage)];
  };
  hash_of_stage(Stage::input) = hash_of<Hasher>(found.frame);
  hash_of_stage(Stage::hand_pose) = hash_of<Hasher>(found.hand, found.flags);
  hash_of_stage(Stage::broadphase) = hash_items<Hasher>(found.candidates);
  hash_of_stage(Stage::narrowphase) = hash_items<Hasher>(found.contacts);
  hash_of_stage(Stage::contact_force) = hash_plain<Hasher>(found.forces);
  hash_of_stage(Stage::limits) = hash_plain<Hasher>(found.output);
}

static_assert(sizeof(Contact) == 2 * sizeof(std::uint32_t) + 13 * sizeof(double));
static_assert(sizeof(HandForces) == 10 * kSegmentCount * sizeof(double));
static_assert(sizeof(ActuatorFrame) == sizeof(HandForces) + 3 * sizeof(double));
static_assert(sizeof(State) == 3 * sizeof(double) + 2 * sizeof(HandForces));

}  // namespace

std::string_view stage_name(Stage stage) {
  constexpr std::array<std::string_view, kStageCount> names = {"input",       "hand_pose",     "broadphase",
                                                               "narrowphase", "contact_force", "limits"};
  return names[static_cast<std::size_t>(stage)];
}

Scratch make_scratch(const Model& model) {
  Scratch scratch;
  scratch.primitives = std::make_shared<Primitives>();
  size_candidates(model, scratch);
  scratch.contacts.resize(scratch.candidates.size());
  return scratch;
}

ActuatorFrame tick(const Model& model, State& state, Scratch& scratch, const DeviceFrame& frame) {
  const FloatingPointGuard guard;
  Primitives& hand = *scratch.primitives;
  hand.count = 0;
  hand.out_of_reach = false;
  // What this frame does not tell must not be left from another: a tick, hashes included, is a function of
  // model, state and frame.
  hand.base_joint = hand.flexion_axis = {};
  scratch.candidate_count = scratch.contact_count = 0;

  std::uint32_t flags = check_input(frame);
  if ((frame.flags & kTrackingLost) != 0) flags |= kInputLost;
  if ((frame.flags & kExtrapolated) != 0) flags |= kInputExtrapolated;
  if ((flags & kUntrusted) == 0) {
    flags |= place_hand(model.hand, model.settings, frame, hand);
    // A hand far from everything needs no shape; but recordings of old formats tell of it all the same.
    const bool shaped = scratch.hash_stages && scratch.hash_kind == HashKind::former;
    hand.out_of_reach = !shaped && !may_meet(model.hand, hand, model.extent);
    if (!hand.out_of_reach) {
      tile_hand(model.hand, model.settings, hand);
      if (!find_candidates(model, hand, scratch)) flags |= kCandidateOverflow;
    }
  }
  const std::span<const std::uint64_t> candidates(scratch.candidates.data(), scratch.candidate_count);
  scratch.contact_count = find_contacts(model, hand, candidates, scratch.contacts);
  const std::span<const Contact> contacts(scratch.contacts.data(), scratch.contact_count);
  const HandForces forces = sum_forces(model.settings, hand, contacts);
  ActuatorFrame output = limit_forces(model.settings, forces, (flags & kUntrusted) == 0, flags, state);
  output.contact_count = scratch.contact_count;
  output.force_error = force_error(model.settings, contacts);

  if (scratch.hash_stages) {
    const Findings found{frame, hand, flags, candidates, contacts, forces, output};
    if (scratch.hash_kind == HashKind::current) {
      hash_stages<Hasher>(found, scratch.stage_hash);
    } else {
      hash_stages<FormerHasher>(found, scratch.stage_hash);
    }
  }
  return output;
}

double contact_depth(const Model& model, const Scratch& scratch, const Contact& contact) {
  const FloatingPointGuard guard;
  return depth_of(model, *scratch.primitives, contact);
}

std::uint64_t hash_state(const State& state, HashKind kind) {
  return kind == HashKind::current ? hash_plain<Hasher>(state) : hash_plain<FormerHasher>(state);
}

}  // namespace lumbrical
