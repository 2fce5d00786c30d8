#include "proxy/proxy_hand.h"

#include <algorithm>
#include <cmath>

#include "base/small_turn.h"
#include "base/wrench.h"
#include "proxy/hand_pull.h"
#include "stages/broadphase.h"
#include "stages/hand_pose.h"
#include "stages/joint_torques.h"

namespace lumbrical {
namespace {

// A tick's way is so many steps of a quarter of the thinnest segment's radius at most: 5 cm for a hand of
// usual size. What is left of it waits for the next tick.
constexpr int kMostSteps = 32;
constexpr double kLongestStep = 0.25;

// On dense meshes it ends after the step by which so many pairs of a core and a triangle have been asked:
// then a tick takes a few steps' time at most, wherever a hand jumps to.
constexpr std::size_t kMostPairs = 2000;

// [N] Of less than this it does not matter what answers it; and [s] how fast the wrist takes to what does.
constexpr double kLittlePush = 1, kBalanceTime = 0.05;
constexpr double kForgotten = 1e-6;  // a share of it that is as good as none

// [N], [m/s] A finger that pressed harder, and whose proxy moves faster than the hand by more, has slipped
// off what held it: so much force must neither end nor come in a tick.
constexpr double kPressed = 1, kSlips = 1;

// The share of an axis' distance from the nearest triangle that a step may take.
constexpr double kShareOfClearance = 0.5;

// Clearances are known as far as a core and its reach go, and have to be as far as they bound a step.
static_assert(kCoreShare + kLongestStep >= kLongestStep / kShareOfClearance);

// The joint that carries another one: the wrist those of the palm and the first of a finger.
constexpr std::array<std::uint8_t, kJointCount> kCarrier = [] {
  std::array<std::uint8_t, kJointCount> carrier{};
  for (auto& joint : carrier) joint = kWrist;
  for (std::size_t i = 0; i < kPhalanxCount; ++i) carrier[kPhalanxJoints[i].tip] = kPhalanxJoints[i].base;
  return carrier;
}();

// The phalanx whose base joint it is; -1: none's.
constexpr std::array<std::int8_t, kJointCount> kPhalanxAt = [] {
  std::array<std::int8_t, kJointCount> phalanx{};
  for (auto& of_joint : phalanx) of_joint = -1;
  for (std::size_t i = 0; i < kPhalanxCount; ++i)
    phalanx[kPhalanxJoints[i].base] = static_cast<std::int8_t>(i);
  return phalanx;
}();

// Where a joint's carrier is not known its carrier's carrier is taken.
std::size_t carrier_of(std::size_t joint, const Joints& joints) {
  std::size_t carrier = kCarrier[joint];
  while (carrier != kWrist && !joints.has(static_cast<int>(carrier))) carrier = kCarrier[carrier];
  return carrier;
}

Pose relative(std::size_t joint, const Joints& joints) {
  return inverse(joints.pose[carrier_of(joint, joints)]) * joints.pose[joint];
}

// Twice the tangent of half the angle, along the axis: what `quat_of` undoes.
Vec3 turn_between(Quat from, Quat to) {
  const Quat q = to * conjugate(from);
  const double w = max(0.05, std::fabs(q.w)), scale = q.w < 0 ? -2 / w : 2 / w;
  return scale * Vec3{q.x, q.y, q.z};
}
Quat quat_of(Vec3 turn) { return normalized(small_rotation(turn)); }

// The move that would bring the proxy to the hand.
HandMove way_to(const Joints& hand, const Joints& proxy) {
  HandMove move;
  const Pose &to = hand.pose[kWrist], &from = proxy.pose[kWrist];
  move.shift = to.position - from.position;
  move.turn = turn_between(from.orientation, to.orientation);
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    const std::size_t joint = kPhalanxJoints[i].base;
    if (!hand.has(static_cast<int>(joint))) continue;
    const Quat is = relative(joint, proxy).orientation, wanted = relative(joint, hand).orientation;
    move.bend[i] = rotate(conjugate(is), turn_between(is, wanted));
  }
  return move;
}

// A pose on another one. What a tick leaves is where the next one begins, and what rounding takes off a
// rotation's length would grow along the fingers from tick to tick, and stretch them.
Pose placed_on(const Pose& carrier, const Pose& pose) {
  const auto [position, orientation] = carrier * pose;
  return {position, normalized(orientation)};
}

// The proxy after `share` of a move. Bones become as long as the hand's.
Joints moved(const Joints& proxy, const HandMove& move, double share, const Joints& hand) {
  Joints result = proxy;
  Pose& wrist = result.pose[kWrist];
  wrist = {wrist.position + share * move.shift, normalized(quat_of(share * move.turn) * wrist.orientation)};
  for (std::size_t joint = 0; joint < kJointCount; ++joint) {
    if (joint == kWrist || !hand.has(static_cast<int>(joint))) continue;
    const Pose is = relative(joint, proxy), wanted = relative(joint, hand);
    Pose now{is.position + share * (wanted.position - is.position), is.orientation};
    now.orientation =
        now.orientation * quat_of(kPhalanxAt[joint] >= 0
                                      ? share * move.bend[static_cast<std::size_t>(kPhalanxAt[joint])]
                                      : share * rotate(conjugate(is.orientation),
                                                       turn_between(is.orientation, wanted.orientation)));
    result.pose[joint] = placed_on(result.pose[carrier_of(joint, hand)], now);
  }
  return result;
}

// [m] The most that a segment's axis moves by.
double distance_moved(const Hand& hand, std::size_t segment, const Joints& from, const Joints& to) {
  const auto way = [&](int joint) { return norm(to.position(joint) - from.position(joint)); };
  if (segment != kPalmSegment) {
    const auto [base, tip] = kPhalanxJoints[segment];
    return from.has(base) && from.has(tip) ? max(way(base), way(tip)) : 0;
  }
  double most = 0;
  for (const Vec3 corner : hand.palm.polygon) {
    const Vec3 place = corner - Vec3{0, hand.palm.height - 0.5 * hand.palm.thickness, 0};
    most = max(most, norm(transform(to.pose[kPalm], place) - transform(from.pose[kPalm], place)));
  }
  return from.has(kPalm) ? most : 0;
}

Joints known_to(const ProxyState& proxy) { return {proxy.joint, static_cast<std::uint32_t>(proxy.valid)}; }

// A hand, and joints that only another one has where that has them on what carries them.
Joints joined(const Joints& hand, const Joints& other) {
  Joints all = hand;
  all.valid |= other.valid;
  for (std::size_t joint = 0; joint < kJointCount; ++joint) {
    if (other.has(static_cast<int>(joint)) && !hand.has(static_cast<int>(joint)))
      all.pose[joint] = placed_on(all.pose[carrier_of(joint, other)], relative(joint, other));
  }
  return all;
}

/// How far each segment may go in a step.
using Allowance = std::array<double, kSegmentCount>;

// A finger's tiles tell only together how far its axes are from a triangle.
Allowance allowance_of(double longest, const CoreGaps& gaps) {
  Allowance allowed;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    const std::size_t first = i - i % 3, last = std::min<std::size_t>(first + 3, kSegmentCount);
    double clearance = 1e300;
    for (std::size_t k = first; k < last; ++k) clearance = min(clearance, gaps.clearance[k]);
    allowed[i] = min(longest, kShareOfClearance * clearance);
  }
  return allowed;
}

/// Where a proxy gets to, and by how much of the move it wants.
struct Reached {
  double share = 1;
  Joints joints;
};

// As far as no segment is taken too far. Turns are not quite in proportion: so it is tried.
Reached reach_within(const Hand& hand, const Allowance& allowed, const HandMove& move, const Joints& tracked,
                     const Joints& proxy) {
  double share = 1;
  for (int attempt = 0; attempt < 8; ++attempt) {
    const Joints there = moved(proxy, move, share, tracked);
    double part = 1;
    for (std::size_t i = 0; i < kSegmentCount; ++i) {
      const double way = distance_moved(hand, i, proxy, there);
      if (way > allowed[i]) part = min(part, allowed[i] / way);
    }
    if (part == 1) return {share, there};
    share *= 0.95 * part;
  }
  return {0, moved(proxy, move, 0, tracked)};
}

// [m] That a proxy takes.
double longest_step(const Hand& hand) {
  double thinnest = hand.palm.polygon.empty() ? 1e300 : 0.5 * hand.palm.thickness;
  for (const auto& [base, tip] : kPhalanxJoints)
    thinnest = min(thinnest, min(hand.radius[base], hand.radius[tip]));
  return kLongestStep * thinnest;
}

// Has a finger that pressed slipped off something? The hand has come to `hand`, and its proxy to `proxy`.
// What holds a finger lets it no faster along than the hand goes. Which way it slips does not matter: what it
// finds next may be farther from the hand, if its springs are laxer there.
bool has_slipped(const HandForces& felt, const ProxyState& before, const Joints& hand, const Joints& proxy,
                 double rate) {
  const Joints known = known_to(before);
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    if (!(norm(felt.segment[i].force) > kPressed)) continue;
    for (const int joint : {kPhalanxJoints[i].base, kPhalanxJoints[i].tip}) {
      if (!known.has(joint) || !proxy.has(joint)) continue;
      const Vec3 was_tracked = before.tracked[static_cast<std::size_t>(joint)];
      const double way = norm(proxy.position(joint) - known.position(joint)),
                   way_of_hand = norm(hand.position(joint) - was_tracked);
      if (way > way_of_hand + kSlips / rate) return true;
    }
  }
  return false;
}

// A proxy has the joints that its hand has. What answers its pushes is told later (balance_pushes, hand_on).
ProxyState kept_of(const Joints& proxy, const Joints& hand, const ProxyState& before) {
  ProxyState kept = before;
  kept.joint = proxy.pose;
  kept.valid = static_cast<double>(proxy.valid);
  kept.tracked = {};
  for (std::size_t j = 0; j < kJointCount; ++j) {
    if (hand.has(static_cast<int>(j))) kept.tracked[j] = hand.pose[j].position;
  }
  return kept;
}

bool find_gaps(const Model& model, const State& state, const Joints& proxy, double reach, Scratch& scratch,
               CoreGaps& gaps) {
  GapMemory& memory = scratch.proxy->gaps;
  if (!add_gaps({model, {}, 0}, proxy, reach, scratch.proxy->search, memory, gaps)) return false;
  for (std::size_t i = 0; i < model.apart.size(); ++i) {
    const Surroundings object{*model.apart[i].shape, state.objects[i].pose, static_cast<std::uint8_t>(i + 1)};
    if (!add_gaps(object, proxy, reach, *scratch.apart, memory, gaps)) return false;
  }
  return true;
}

enum class Advance : std::uint8_t { done, crossed, overflow, overflow_at_once };

// Does a surface lie across an axis, or an axis in a solid? No step of the proxy's own brings one there.
bool is_crossed(const CoreGaps& gaps) {
  return !(*std::min_element(gaps.clearance.begin(), gaps.clearance.end()) > 0);
}

// Takes the proxy as far as it gets in a tick, and lists what holds it. Done, unless something has come to
// lie across an axis or there are too many candidates; at once: where it is already.
Advance advance(const Model& model, const State& state, const Joints& tracked, Scratch& scratch,
                Joints& proxy) {
  PushList& pushing = scratch.proxy->pushing;
  const double longest = longest_step(model.hand), stiffness = model.settings.proxy_stiffness;
  std::size_t pairs = 0;
  for (int step = 0; step < kMostSteps && pairs < kMostPairs; ++step) {
    CoreGaps gaps;
    if (!find_gaps(model, state, proxy, longest, scratch, gaps))
      return step == 0 ? Advance::overflow_at_once : Advance::overflow;
    if (is_crossed(gaps)) return Advance::crossed;
    pairs += gaps.pairs;
    HandMove wanted = way_to(tracked, proxy);
    const bool shortened = shorten(stiffness, wanted);
    const HandMove move = pull(proxy, wanted, stiffness, state.proxy->balanced, gaps.gap);
    const Reached reached = reach_within(model.hand, allowance_of(longest, gaps), move, tracked, proxy);
    list_pushes(model.hand, proxy, gaps.gap, pushing);
    const bool arrives = reached.share == 1 && !shortened && pushing.empty();
    proxy = arrives ? tracked : reached.joints;
    if (arrives || (reached.share == 1 && !pushing.empty())) break;
  }
  return Advance::done;
}

// Is every core outside all surfaces, as far as the first step will look? False where there are too many
// candidates. A hand that stays within something asks this in every tick: the first core that is not outside
// answers it.
bool is_free(const Model& model, const State& state, const Joints& hand, Scratch& scratch, bool& free) {
  CoreGaps gaps;
  gaps.asks_only_that = true;
  if (!find_gaps(model, state, hand, longest_step(model.hand), scratch, gaps)) return false;
  free = !gaps.closed;
  return true;
}

// A joint that tracking has lost holds the proxy as before, but its segment feels nothing.
void silence_untracked(const Primitives& hand, PushList& pushing) {
  for (Gap& gap : pushing) {
    const bool is_felt = gap.segment == kPalmSegment ? hand.joints.has(kPalm) : hand.present[gap.segment];
    if (!is_felt) gap.push = gap.stiffness = 0;
  }
}

}  // namespace

std::shared_ptr<ProxyMemory> make_proxy_memory(const Model& model) {
  auto memory = std::make_shared<ProxyMemory>();
  memory->search.primitives = std::make_shared<Primitives>();
  size_candidates(model, memory->search);
  size_gap_memory(model, memory->gaps);
  for (const ApartObject& object : model.apart) size_gap_memory(*object.shape, memory->gaps);
  return memory;
}

std::uint32_t follow_hand(const Model& model, bool trusted, State& state, Scratch& scratch, Primitives& hand,
                          bool& anew) {
  scratch.proxy->pushing.clear();
  if (!state.proxy) state.proxy.emplace();
  ProxyState& kept = *state.proxy;
  Joints& joints = hand.joints;
  if (!trusted || !joints.has(kWrist)) {
    kept = {};
    return 0;
  }
  if (kept.valid == 0) {
    bool free = false;
    if (!is_free(model, state, joints, scratch, free)) return kCandidateOverflow;
    if (free) kept = kept_of(joints, joints, {});
    return 0;
  }
  // What tracking has lost is where the proxy has it, and what it has found is new to the proxy.
  Joints known = known_to(kept), all = joined(joints, known), proxy = joined(known, all);
  Advance advanced = advance(model, state, all, scratch, proxy);
  if (advanced == Advance::crossed && (known.valid & ~joints.valid) != 0) {
    // It may be just what tracking has lost that is crossed: the rest goes on alone.
    known.valid &= joints.valid;
    all = joints;
    proxy = joined(known, all);
    advanced = advance(model, state, all, scratch, proxy);
  }
  if (advanced == Advance::overflow || advanced == Advance::overflow_at_once) {
    scratch.proxy->pushing.clear();
    if (advanced == Advance::overflow_at_once) kept = {};  // the next tick would ask the same
    return kCandidateOverflow;
  }
  if (advanced == Advance::crossed) {  // on which side it is no one can say
    scratch.proxy->pushing.clear();
    kept = {};
    anew = true;
    return 0;
  }
  if (has_slipped(state.last, kept, all, proxy, model.settings.rate)) anew = true;
  if (proxy.pose == all.pose) {  // nothing is in the way: what tracking has lost may be forgotten
    kept = kept_of(joints, joints, kept);
    return 0;
  }
  kept = kept_of(proxy, all, kept);
  proxy.valid = joints.valid;
  place_hand(model.hand, model.settings, proxy, {}, hand);
  silence_untracked(hand, scratch.proxy->pushing);
  return 0;
}

void add_pushes(const PushList& pushing, Primitives& hand, HandForces& forces) {
  if (pushing.empty()) return;
  place_axes(hand);
  for (std::size_t i = 0; i < kSegmentCount; ++i) forces.segment[i] += push_on(pushing, 0, hand, i).wrench;
  sum_joint_torques(hand, forces);
}

void balance_pushes(const PushList& pushing, const HandForces& forces, double rate, ProxyState& kept) {
  Vec3 pushes, on_palm;
  for (const Gap& gap : pushing) (gap.segment == kPalmSegment ? on_palm : pushes) += gap.push * gap.normal;
  // The harder the palm's own core is pushed the more it is the wrist that gives way; not all at once, or the
  // two would take turns.
  const Vec3 field = forces.segment[kPalmSegment].force - on_palm;
  const double size = norm(pushes), answered = -dot(field, pushes);
  const double target = size > 0 ? clamp(answered / (size * (size + norm(on_palm) + kLittlePush)), 0, 1) : 0;
  kept.balanced += min(1, 1 / (rate * kBalanceTime)) * (target - kept.balanced);
  if (kept.balanced < kForgotten)
    kept.balanced = 0;  // else what begins anew, with 0, would differ for half a minute
}

CorePush push_on(const PushList& pushing, std::uint8_t object, const Primitives& hand, std::size_t segment) {
  CorePush sum;
  for (const Gap& gap : pushing) {
    if (gap.object != object || gap.segment != segment) continue;
    const Vec3 force = gap.push * gap.normal;
    sum.wrench += {force, cross(gap.point - hand.base_joint[segment], force)};
    sum.stiffness += gap.stiffness;
  }
  return sum;
}

}  // namespace lumbrical
